"""First heights at the walls of layouts: by how much they are wrong, also at the ends of connections.

    python benchmarks/layouts_walls.py

Prints a row for each layout: per cent by which the first heights at nodes that move are wrong, the median and the
largest, and the largest at nodes that end a connection.
"""

from __future__ import annotations

import numpy as np

import gridgen_sym as gg

#: Layouts with their numbers of cells, and the first height at all their walls.
LAYOUTS = (
    ("pipe", {"across": 12, "outwards": 12}, 0.01),
    ("tee", {"across": 12}, 0.02),
    ("wye", {"across": 12}, 0.02),
    ("step", {"across": 12}, 0.02),
)


def errors(layout: gg.MultiBlock, first: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the relative errors at all nodes beside a wall that move, and those at nodes on connections."""
    every, ends = [], []
    for part in layout.boundaries["wall"]:
        grid, outer = layout.blocks[part.block], layout.outer[part.block]
        at = part.indices(grid.shape)
        step = {"bottom": (0, 1), "top": (0, -1), "left": (1, 0), "right": (-1, 0)}[part.side]
        off = at[0] + step[0], at[1] + step[1]
        height = np.hypot(*(grid.planes[:, *off] - grid.planes[:, *at]))
        moves = outer[off] == 0
        along = np.arange(part.count)
        last = (along == 0) | (along == part.count - 1)
        error = np.abs(height / first - 1)
        every.append(error[moves])
        ends.append(error[moves & last])
    return np.concatenate(every), np.concatenate(ends)


def main() -> None:
    """Solve, measure and print."""
    print("| layout | median | largest | at ends of connections |\n| --- | --- | --- | --- |")
    for name, cells, first in LAYOUTS:
        found = gg.optimize(gg.layout(name, **cells), "winslow", walls={"wall": gg.Wall(first=first)})
        every, ends = (100 * one for one in errors(found.grid, first))
        print(f"| `{name}` | {np.median(every):.3f} | {every.max():.2f} | {ends.max():.2f} |")


if __name__ == "__main__":
    main()
