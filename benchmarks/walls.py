"""Grids with walls from boundaries of NASA's grids: heights, angles, folds, and cost in kernel passes.

    OMP_NUM_THREADS=1 python benchmarks/walls.py [FOLDER] [--refine 1 2 4 8 16]

The boundary nodes and the first heights at eta = 0 are those of the file; the start is transfinite interpolation. A
refined boundary has its nodes on cubic splines through those of the file, and heights divided accordingly. The unit of
cost is one energy + gradient pass of winslow on the same grid. FOLDER holds the files of NASA's Turbulence Modeling
Resource (see benchmarks/data/README.md); those that are not there are left out.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from measure import fastest
from solver_cost import unit_of

import gridgen_sym as gg

DATA = Path(__file__).parent / "data"


@dataclass(frozen=True, slots=True)
class Case:
    """A file, its wall (nodes of eta = 0) without the two nodes beside each end, and the degrees off normal allowed."""

    name: str
    first: int
    last: int
    off_normal: float


CASES = (
    Case("n0012_113-33", 26, 86, 1.2),
    Case("n4412_225-65", 50, 174, 0.7),
    Case("bump_3levelsdown_177x81", 2, 174, 0.05),
    Case("flatplate_clust2_3levelsdown_69x49", 2, 66, 0.01),
)


def nodes_of(path: Path) -> np.ndarray:
    """Return the nodes (ni, nj, 2) of a 2-D PLOT3D file with one block."""
    numbers = np.array(path.read_text().split(), dtype=float)
    ni, nj = numbers[1:3].astype(int)
    x, y = numbers[3:].reshape(2, nj, ni).transpose(0, 2, 1)
    return np.stack([x, y], axis=-1)


def refined(values: np.ndarray, times: int) -> np.ndarray:
    """Return values (n, ...) along a line at so many times as many cells, by a cubic spline."""
    from scipy.interpolate import CubicSpline

    count = len(values)
    places = np.linspace(0, count - 1, (count - 1) * times + 1)
    return values if times == 1 else CubicSpline(np.arange(count), values, axis=0)(places)


def start_of(nodes: np.ndarray, times: int) -> tuple[gg.Grid, np.ndarray]:
    """Return the transfinite start and the first heights (ni,)."""
    first = np.hypot(*(nodes[:, 1] - nodes[:, 0]).T)
    sides = (refined(side, times) for side in (nodes[:, 0], nodes[:, -1], nodes[0], nodes[-1]))
    return gg.transfinite(*sides), np.exp(refined(np.log(first), times)) / times


def measure(case: Case, nodes: np.ndarray, times: int) -> str:
    """Solve one case, and return its line of the table."""
    start, first = start_of(nodes, times)
    kept: list[gg.Result] = []

    def solve() -> None:
        kept[:] = [gg.optimize(start, "winslow", walls={"bottom": gg.Wall(first)}, progress=False)]

    solve()  # Compiles what must be compiled.
    clock, unit = fastest(solve, runs=3, seconds=0.0), unit_of(start, "winslow")
    grid = kept[0].grid
    up, along = grid.xy[1:-1, 1] - grid.xy[1:-1, 0], grid.xy[2:, 0] - grid.xy[:-2, 0]
    height = np.hypot(*up.T)
    off = np.degrees(np.arcsin(np.abs((up * along).sum(axis=1)) / (height * np.hypot(*along.T))))
    at = slice(case.first * times - 1, case.last * times)
    wrong = np.abs(height / first[1:-1] - 1)[at]
    ni, nj = grid.shape
    return (
        f"| `{case.name}` x {times} | {ni} x {nj} | {kept[0].quality.folded_cells} | "
        f"{100 * np.percentile(wrong, 99):.2f} % | {np.percentile(off[at], 95):.3f} | {clock.cpu:.2f} | "
        f"{clock.cpu / unit.cpu:.0f} |"
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", type=Path, default=DATA)
    parser.add_argument("--refine", nargs="+", type=int, default=[1, 2, 4, 8])
    given = parser.parse_args()
    print("| grid | nodes | folded | height error, 99 % | degrees off normal, 95 % | s | passes |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for case in CASES:
        path = given.folder / f"{case.name}.p2dfmt"
        for times in given.refine if path.exists() else ():
            print(measure(case, nodes_of(path), times), flush=True)


if __name__ == "__main__":
    main()
