"""What the tests of the solvers share: grids, the paper's sums written out by hand, differences, and measures."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

import gridgen_sym as gg

METHODS = ("newton", "local")
BARRIER = ("winslow", "modified_liao", "area_winslow")
BACKENDS = ("c", "numpy")

#: The paper's corner energies from the two edge vectors' metric, by hand: nothing here comes from the package.
CORNER_ENERGIES = {
    "area": lambda g11, g22, g12, J: J**2,
    "length": lambda g11, g22, g12, J: g11 + g22,
    "orthogonality": lambda g11, g22, g12, J: g12**2,
    "combined": lambda g11, g22, g12, J: 0.4 * J**2 + 0.2 * (g11 + g22) + 0.4 * g12**2,
    "knupp": lambda g11, g22, g12, J: (J**2 + g12**2) / 2,
    "winslow": lambda g11, g22, g12, J: (g11 + g22) / J,
    "liao": lambda g11, g22, g12, J: g11**2 + g22**2 + 2 * g12**2,
    "modified_liao": lambda g11, g22, g12, J: ((g11 + g22) / J) ** 2,
    "area_winslow": lambda g11, g22, g12, J: J**2 / 2 + 0.02 * (g11 + g22) / J,
}


def literal_energy(grid: gg.Grid, name: str, *, interior_only: bool) -> float:
    """Return the paper's double sum, over nodes k and over the cells round k, corner by corner."""
    xy = grid.xy
    ni, nj = grid.shape
    total = 0.0
    for i in range(ni):
        for j in range(nj):
            if interior_only and not (0 < i < ni - 1 and 0 < j < nj - 1):
                continue
            for di in (-1, 1):
                for dj in (-1, 1):
                    if 0 <= i + di < ni and 0 <= j + dj < nj:
                        # Differences run along increasing xi and eta, so that J > 0 on a valid grid.
                        g1, g2 = di * (xy[i + di, j] - xy[i, j]), dj * (xy[i, j + dj] - xy[i, j])
                        J = g1[0] * g2[1] - g2[0] * g1[1]
                        total += CORNER_ENERGIES[name](g1 @ g1, g2 @ g2, g1 @ g2, J)
    return total


def mild_grid(ni: int = 9, nj: int = 8, disorder: float = 0.15) -> gg.Grid:
    """Return a disordered start in a gently bulging square, on which every functional has a valid minimum."""
    s, t = np.linspace(0, 1, ni), np.linspace(0, 1, nj)
    bottom = np.stack((s, -0.05 * np.sin(np.pi * s)), axis=-1)
    top = np.stack((s, 1 + 0.08 * np.sin(np.pi * s)), axis=-1)
    left = np.stack((-0.04 * np.sin(np.pi * t), t), axis=-1)
    right = np.stack((1 + 0.06 * np.sin(np.pi * t), t), axis=-1)
    return disordered(gg.transfinite(bottom, top, left, right), disorder)


def disordered(grid: gg.Grid, size: float, seed: int = 0) -> gg.Grid:
    """Return a valid grid with random moves of the inner nodes, of up to `size` of a mean cell's side.

    The moves are halved until the grid is valid.
    """
    assert gg.quality(grid).valid
    side = np.sqrt(gg.quality(grid).mean_jacobian)
    moves = np.zeros((*grid.shape, 2))
    moves[1:-1, 1:-1] = np.random.default_rng(seed).uniform(-1, 1, size=moves[1:-1, 1:-1].shape) * size * side
    while not gg.quality(gg.Grid(grid.xy + moves)).valid:
        moves /= 2
    return gg.Grid(grid.xy + moves)


def hopeless_grid(nodes: int = 9) -> gg.Grid:
    """Return a start in a square of which no grid is valid: at one corner the fixed boundary turns the wrong way."""
    xy = gg.domain("square", nodes, nodes).xy
    xy[1, 0], xy[0, 1] = (0.02, 0.3), (0.3, 0.02)
    return gg.transfinite(xy[:, 0], xy[:, -1], xy[0], xy[-1])


def edges(field: np.ndarray) -> np.ndarray:
    """Return what a field (ni, nj, ...) is at the boundary nodes."""
    return np.concatenate((field[0], field[-1], field[:, 0], field[:, -1]))


def farthest(one: gg.Grid, other: gg.Grid) -> float:
    """Return the largest distance between equal nodes of two grids, over the size of the second."""
    size = max(np.ptp(other.x), np.ptp(other.y))
    return float(np.hypot(*(one.planes - other.planes)).max() / size)


def gradient_norm(grid: gg.Grid, name: str, **options: object) -> float:
    return float(np.linalg.norm(gg.gradient(grid, name, **options)))


def largest_rise(result: gg.Result) -> float:
    """Return the largest rise of the energy from one entry of the history to the next, over the energy."""
    energies = [step.energy for step in result.history]
    return max(((after - before) / abs(before) for before, after in pairwise(energies)), default=0.0)


def assert_consistent(result: gg.Result, name: str, **options: object) -> None:
    """Check what a result says of itself against its grid."""
    assert result.iterations == len(result.history) - 1
    assert result.energy == pytest.approx(gg.energy(result.grid, name, **options), rel=1e-13, abs=1e-300)
    assert np.isfinite(result.grid.planes).all()
    assert result.message.endswith((".", ":")) or "\n" in result.message
    assert str(result).startswith("converged" if result.converged else "NOT converged")
    assert f"{result.iterations} iterations" in str(result)


def energy_differences(grid: gg.Grid, name: str, step: float, **options: object) -> np.ndarray:
    """Return the gradient by central differences of `gg.energy`, one coordinate at a time; zero at the boundary."""
    slopes = np.zeros((*grid.shape, 2))
    for index in inner_coordinates(grid):
        ahead, behind = (gg.energy(moved(grid, index, sign * step), name, **options) for sign in (1, -1))
        slopes[index] = (ahead - behind) / (2 * step)
    return slopes


def gradient_differences(grid: gg.Grid, name: str, step: float, **options: object) -> np.ndarray:
    """Return the dense Hessian by differences of `gg.gradient`: unknown 2 k + c, k-th inner node, component c."""
    columns = []
    for index in inner_coordinates(grid):
        ahead, behind = (gg.gradient(moved(grid, index, sign * step), name, **options) for sign in (1, -1))
        columns.append(((ahead - behind) / (2 * step))[1:-1, 1:-1].ravel())
    return np.array(columns).T


def inner_coordinates(grid: gg.Grid) -> list[tuple[int, int, int]]:
    ni, nj = grid.shape
    return [(i, j, c) for i in range(1, ni - 1) for j in range(1, nj - 1) for c in (0, 1)]


def moved(grid: gg.Grid, index: tuple[int, int, int], step: float) -> gg.Grid:
    xy = grid.xy
    xy[index] += step
    return gg.Grid(xy)


def relative(value: np.ndarray, expected: np.ndarray) -> float:
    return float(np.abs(value - expected).max() / np.abs(expected).max())
