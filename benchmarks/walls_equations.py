"""Walls both ways: as a target of winslow, and as control functions of its equations.

    OMP_NUM_THREADS=1 python benchmarks/walls_equations.py [FOLDER] [--refine 1 2 4]

Prints the tables of docs/explanations/walls_through_equations.md. The first has the cases of walls.py (the boundary
nodes and first heights of NASA's grids, see there) and classical domains whose first cells are thick. The second has
the formulas of Steger and Sorenson, word for word, on a channel with a bump. Heights and angles are those of the
wall's inner nodes; of C-grids those on the airfoil without the two beside the trailing edge, of classical domains those
without five beside each corner.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from measure import fastest
from solver_cost import unit_of
from walls import CASES, DATA, nodes_of, start_of

import gridgen_sym as gg
from gridgen_sym.boundary.laws import geometric

DOMAINS = ("wavy", "horseshoe_map", "chevron", "swan", "zee")
#: First heights, and decays per line, for which the formulas of Steger and Sorenson are tried.
FIRST, DECAYS = (2e-2, 5e-3, 1e-3, 1e-4), (0.1, 0.3, 0.7)


def by_target(start: gg.Grid, first: np.ndarray) -> gg.Result:
    """Minimize winslow with the walls as a target."""
    return gg.optimize(start, "winslow", walls={"bottom": gg.Wall(first)}, progress=False)


def by_equations(start: gg.Grid, first: np.ndarray) -> gg.Result:
    """Solve Winslow's equations with control functions from the walls."""
    walls = {"bottom": gg.Wall(first)}
    return gg.solve_euler_lagrange(start, "winslow", control="hilgenstock-white", walls=walls, progress=False)


WAYS: dict[str, Callable[[gg.Grid, np.ndarray], gg.Result]] = {"target": by_target, "equations": by_equations}


def at_wall(grid: gg.Grid, first: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return at the inner nodes of the bottom the errors of heights, as parts of them, and the degrees off normal."""
    up, along = grid.xy[1:-1, 1] - grid.xy[1:-1, 0], grid.xy[2:, 0] - grid.xy[:-2, 0]
    height = np.hypot(*up.T)
    sine = np.abs((up * along).sum(axis=1)) / (height * np.hypot(*along.T))
    return np.abs(height / first[1:-1] - 1), np.degrees(np.arcsin(np.minimum(sine, 1)))


def spaced(grid: gg.Grid, first: float) -> gg.Grid:
    """Return the transfinite grid of a domain whose left and right begin with a cell of this length."""
    xy, sides = grid.xy, []
    for side in (xy[0], xy[-1]):
        arc = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(side, axis=0).T))))
        places = arc[-1] * geometric(first / arc[-1], len(side) - 1)[0]
        sides.append(np.stack([np.interp(places, arc, component) for component in side.T], axis=-1))
    return gg.transfinite(xy[:, 0], xy[:, -1], *sides)


def cases(folder: Path, refine: list[int]) -> Iterator[tuple[str, gg.Grid, np.ndarray, slice]]:
    """Return names, starts, first heights, and which inner nodes of the wall count."""
    for case in CASES:
        path = folder / f"{case.name}.p2dfmt"
        for times in refine if path.exists() else ():
            name = f"`{case.name}`" + (f" x {times}" if times > 1 else "")
            yield name, *start_of(nodes_of(path), times), slice(case.first * times - 1, case.last * times)
    for name in DOMAINS:
        plain = gg.domain(name, 33, 33)
        first = 0.2 * float(np.median(np.hypot(*(plain.xy[:, 1] - plain.xy[:, 0]).T)))
        yield name, spaced(plain, first), np.full(33, first), slice(5, -5)


def measure(start: gg.Grid, first: np.ndarray, at: slice, way: str) -> str:
    """Solve one case one way, and return the columns of the table."""
    kept: list[gg.Result] = []

    def solve() -> None:
        kept[:] = [WAYS[way](start, first)]

    solve()  # Compiles what must be compiled.
    clock, unit = fastest(solve, runs=3, seconds=0.0), unit_of(start, "winslow")
    wrong, off = (values[at] for values in at_wall(kept[0].grid, first))
    quality, xy = kept[0].quality, kept[0].grid.xy[1:-1]
    growth = np.hypot(*(xy[:, 2] - xy[:, 1]).T) / np.hypot(*(xy[:, 1] - xy[:, 0]).T)
    return (
        f"{way} | {kept[0].status.name.lower()} | {quality.folded_cells} | {100 * np.percentile(wrong, 99):.2f} % | "
        f"{np.percentile(off, 95):.2f} | {off.max():.2f} | {np.median(growth[at]):.2f} | "
        f"{quality.min_scaled_jacobian:.2f} | "
        f"{quality.non_orthogonality.mean:.1f} | {clock.cpu:.2f} | {clock.cpu / unit.cpu:.0f} |"
    )


def channel(first: float) -> gg.Grid:
    """Return a channel of 3 x 1 with a bump, 41 x 25 nodes, whose ends begin with a cell of this height."""
    s, up = np.linspace(0, 1, 41), geometric(first, 24)[0]
    bottom = np.stack([3 * s, 0.15 * np.exp(-40 * (s - 0.5) ** 2)], axis=-1)
    left, right = (np.stack([np.full(25, x), y + up * (1 - y)], axis=-1) for x, y in (bottom[0], bottom[-1]))
    return gg.transfinite(bottom, np.stack([3 * s, np.ones(41)], axis=-1), left, right)


def steger_sorenson(grid: gg.Grid, first: float, decay: float, updates: int = 100) -> tuple[float, float]:
    """Return the largest errors of heights and angles after updates by the formulas of Steger and Sorenson (1979).

    P = p(xi) exp(-decay j), Q = q(xi) exp(-decay j) at line j; p and q are what the equations ask for at the wall,
    with r_eta as asked for and r_etaeta = (-7 r_0 + 8 r_1 - r_2)/(2 h²) - 3 r_eta/h; 5 % of the change is taken, and
    no more than 0.1 per cell.
    """
    (ni, nj), grid = grid.shape, gg.solve_euler_lagrange(grid, "winslow", progress=False).grid
    h, k = 1 / (ni - 1), 1 / (nj - 1)
    p, q, inward = np.zeros(ni), np.zeros(ni), np.exp(-decay * np.arange(nj))
    for _ in range(updates):
        wall, one, two = (grid.planes[:, :, j] for j in range(3))
        r_xi, r_xixi = (wall[:, 2:] - wall[:, :-2]) / (2 * h), np.diff(wall, 2, axis=1) / h**2
        r_eta = first / k * np.stack([-r_xi[1], r_xi[0]]) / np.hypot(*r_xi)
        r_etaeta = (-7 * wall + 8 * one - two)[:, 1:-1] / (2 * k**2) - 3 * r_eta / k
        g11, g22 = (r_xi * r_xi).sum(axis=0), (r_eta * r_eta).sum(axis=0)
        p_asked = -(r_xi * r_xixi).sum(axis=0) / g11 - (r_xi * r_etaeta).sum(axis=0) / g22
        q_asked = -(r_eta * r_etaeta).sum(axis=0) / g22 - (r_eta * r_xixi).sum(axis=0) / g11
        p[1:-1] += np.clip(0.05 * (p_asked - p[1:-1]), -0.1 / h, 0.1 / h)
        q[1:-1] += np.clip(0.05 * (q_asked - q[1:-1]), -0.1 / k, 0.1 / k)
        control = p[:, None] * inward, q[:, None] * inward
        result = gg.solve_euler_lagrange(grid, "winslow", control=control, progress=False)
        if not result.converged:
            return np.nan, np.nan
        grid = result.grid
    wrong, off = at_wall(grid, np.full(ni, first))
    return float(wrong.max()), float(off.max())


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", type=Path, default=DATA)
    parser.add_argument("--refine", nargs="+", type=int, default=[1])
    given = parser.parse_args()
    print("| grid | walls become | ended as | folded | height error, 99 % | degrees off normal, 95 % | max | ", end="")
    print("growth, median | scaled Jacobian, min | degrees off 90, mean | s | passes |\n|" + " --- |" * 12)
    for name, start, first, at in cases(given.folder, given.refine):
        for way in WAYS:
            print(f"| {name} | {measure(start, first, at, way)}", flush=True)
    print("\n| first height | " + " | ".join(f"decay {decay}" for decay in DECAYS) + " | `hilgenstock-white` |")
    print("|" + " --- |" * (len(DECAYS) + 2))
    for height in FIRST:
        found = [steger_sorenson(channel(height), height, decay) for decay in DECAYS]
        wrong, off = at_wall(by_equations(channel(height), np.full(41, height)).grid, np.full(41, height))
        found.append((float(wrong.max()), float(off.max())))
        cells = (f"{100 * error:.3g} %, {degrees:.2g}°" if error == error else "fails" for error, degrees in found)
        print(f"| {height:g} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
