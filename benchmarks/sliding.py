"""What sliding sides cost: `optimize` with winslow, with boundary nodes that stay and with all that slide.

    OMP_NUM_THREADS=1 python benchmarks/sliding.py [--nodes N ...]

Prints the table of docs/reference/walls.md: processor seconds of both in one run, their ratio, and the Newton steps on
the finest grid. Both minimize from transfinite interpolation, on coarse grids first. With more threads on a busy
machine the time that they wait counts, too.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator

import numpy as np

import gridgen_sym as gg

DOMAINS = "quarter_annulus", "chevron", "swan", "wavy"
REPEATS = 3


def trapezoid(nodes: int) -> gg.Grid:
    """Return the start of the trapezoid whose conformal module is known."""
    corners = np.array([[0.0, 0], [1, 0], [1, 2], [0, 1]])
    t = np.linspace(0, 1, nodes)[:, None]
    ends = {"bottom": (0, 1), "top": (3, 2), "left": (0, 3), "right": (1, 2)}
    return gg.transfinite(**{side: corners[a] + t * (corners[b] - corners[a]) for side, (a, b) in ends.items()})


def starts(nodes: int) -> Iterator[tuple[str, gg.Grid]]:
    """Yield the names of the cases and their starts."""
    yield "trapezoid", trapezoid(nodes)
    for name in DOMAINS:
        yield name.replace("_", " "), gg.domain(name, nodes, nodes)


def measure(start: gg.Grid, slide: str | None) -> tuple[float, str]:
    """Return the least processor seconds of some runs, and the steps on the finest grid; a failed run is marked."""
    seconds = []
    for _ in range(REPEATS):
        begin = time.process_time()
        result = gg.optimize(start, "winslow", slide=slide, progress=False)
        seconds.append(time.process_time() - begin)
    return min(seconds), f"{result.iterations}{'' if result.converged and result.quality.valid else ' *'}"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nodes", nargs="*", type=int, default=[257, 513])
    given = parser.parse_args()
    print("| | nodes | fixed, s | sliding, s | ratio | Newton steps, fixed | sliding |\n|" + " --- |" * 7)
    for nodes in given.nodes:
        for name, start in starts(nodes):
            (fixed, steps), (slides, more) = measure(start, None), measure(start, "all")
            row = f"{fixed:.3f} | {slides:.3f} | {slides / fixed:.2f} | {steps} | {more}"
            print(f"| {name} | {nodes}² | {row} |", flush=True)


if __name__ == "__main__":
    main()
