"""What blocks cost: `optimize` with winslow on one block, and on the same block cut into 2 to 64.

    python benchmarks/blocks.py [--apart] [--nodes N ...] [--cuts KxL ...]

Prints the tables of docs/explanations/blocks.md: processor seconds of both in one run, their ratio, the time per node
over that of the first row with as many blocks, and the largest difference of the two grids over the extent. With
`--apart` blocks are not put together first, as where they cannot be.
"""

from __future__ import annotations

import argparse
import os
import time
from functools import partial

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

import gridgen_sym as gg
from gridgen_sym.solvers.layout.optimize import optimize_layout

REPEATS = 3
#: Both are solved so well that they must be one grid.
TOLERANCE = 1e-9


def cut(grid: gg.Grid, columns: int, rows: int) -> gg.MultiBlock:
    """Return a grid as columns x rows blocks of about the same size."""
    sizes = zip(grid.shape, (columns, rows), strict=True)
    lines = [np.linspace(0, count - 1, parts + 1).round().astype(int) for count, parts in sizes]
    return gg.MultiBlock(
        [
            gg.Grid.from_planes(*grid.planes[:, i0 : i1 + 1, j0 : j1 + 1])
            for i0, i1 in zip(lines[0][:-1], lines[0][1:], strict=True)
            for j0, j1 in zip(lines[1][:-1], lines[1][1:], strict=True)
        ]
    )


def difference(found: gg.MultiBlock, whole: gg.Grid, columns: int, rows: int) -> float:
    """Return the largest distance of a node of the blocks from that of the whole, over the extent."""
    expected = cut(whole, columns, rows)
    apart = [np.abs(one.planes - other.planes).max() for one, other in zip(found.blocks, expected.blocks, strict=True)]
    return float(max(apart) / np.ptp(whole.planes))


def measure(start: gg.Grid | gg.MultiBlock, *, apart: bool) -> tuple[float, gg.Result | gg.LayoutResult]:
    """Return the least processor seconds of some runs, and the result; with `apart`, blocks are not put together."""
    solve = partial(optimize_layout, merges=False) if apart and isinstance(start, gg.MultiBlock) else gg.optimize
    seconds = []
    for _ in range(REPEATS):
        begin = time.process_time()
        result = solve(start, "winslow", tolerance=TOLERANCE, progress=False)
        seconds.append(time.process_time() - begin)
    assert result.converged
    assert result.quality.valid
    return min(seconds), result


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--apart", action="store_true", help="do not put blocks together")
    parser.add_argument("--nodes", nargs="*", type=int, default=[65, 129, 257, 513, 1025])
    parser.add_argument("--cuts", nargs="*", default=["1x2", "2x2", "4x4", "8x8"])
    given = parser.parse_args()
    print("| nodes | blocks | one block, s | blocks, s | ratio | time per node | difference |\n|" + " --- |" * 7)
    first: dict[str, float] = {}
    for nodes in given.nodes:
        start = gg.domain("wavy", nodes, nodes)
        whole, result = measure(start, apart=given.apart)
        for name in given.cuts:
            columns, rows = map(int, name.split("x"))
            seconds, found = measure(cut(start, columns, rows), apart=given.apart)
            per_node = seconds / nodes**2
            growth = per_node / first.setdefault(name, per_node)
            apart = difference(found.grid, result.grid, columns, rows)
            row = f"{columns * rows} | {whole:.3f} | {seconds:.3f} | {seconds / whole:.2f} | {growth:.2f} | {apart:.1e}"
            print(f"| {nodes}² | {row} |", flush=True)


if __name__ == "__main__":
    main()
