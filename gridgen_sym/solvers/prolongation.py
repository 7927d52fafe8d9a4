"""From one grid to another of the same boundary with more or fewer nodes.

What is carried to a finer grid is the displacement from transfinite interpolation, which is smooth where the boundary
is not, by cubic interpolation: then one or two Newton steps on the finer grid suffice. Where the outline has kinks of
the size of a cell, transfinite interpolation carries them across the whole domain, and the start may be folded there.
Then the nodes themselves are carried, linearly, which folds nothing where every cell is halved, and only what the finer
boundary adds is spread into the domain, by Laplace's equation: it is small, oscillates, and dies out after a few cells.
"""

from __future__ import annotations

import numpy as np

from ..grids import transfinite
from ..runtime import HESSIAN_PLANES, Array
from .linear import hessian_solver
from .untangle import Folds

#: Relative residual to which Laplace's equation is solved: a start needs no more.
_LAPLACE = 1e-2


def coarse_start(coordinates: Array, shape: tuple[int, int]) -> Array:
    """Return the transfinite interpolation (2, ni, nj) of a grid's boundary, resampled to `shape`."""
    return from_boundary(resample(coordinates, shape, linear=True))


def finer_start(coarse: Array, fine_boundary: Array, backend: str) -> Array:
    """Return the start on a finer grid: of the ways to make one, the first that is valid, or the least folded.

    Args:
        coarse: (2, ni, nj), solved on a coarser grid.
        fine_boundary: (2, ni, nj) of the finer grid, of which the boundary is used.
        backend: of the linear solver.
    """
    interpolated = from_boundary(fine_boundary)
    start = _displaced(coarse, interpolated)
    least = Folds.of(start)
    if not least.cells:
        return start
    for other in (_spread(coarse, interpolated, backend), interpolated):
        folds = Folds.of(other)
        if folds < least:
            start, least = other, folds
    return start


def _displaced(coarse: Array, interpolated: Array) -> Array:
    """Return a transfinite grid plus the displacement of the coarse grid from its own."""
    start = interpolated.copy()
    displacement = resample(coarse - from_boundary(coarse), start.shape[1:], linear=False)
    start[:, 1:-1, 1:-1] += displacement[:, 1:-1, 1:-1]
    return start


def _spread(coarse: Array, fine_boundary: Array, backend: str) -> Array:
    """Return the coarse nodes, interpolated linearly, plus the harmonic extension of the boundary's difference."""
    start = resample(coarse, fine_boundary.shape[1:], linear=True)
    difference = fine_boundary - start
    difference[:, 1:-1, 1:-1] = 0.0
    inner = np.zeros_like(difference)
    inner[:, 1:-1, 1:-1] = (
        difference[:, :-2, 1:-1] + difference[:, 2:, 1:-1] + difference[:, 1:-1, :-2] + difference[:, 1:-1, 2:]
    )
    start += difference + _solve_laplace(inner, backend)
    for edge in (np.s_[:, 0], np.s_[:, -1], np.s_[:, :, 0], np.s_[:, :, -1]):
        start[edge] = fine_boundary[edge]  # Bit by bit.
    return start


def _solve_laplace(right: Array, backend: str) -> Array:
    """Solve Laplace's equation in the logical square on the 5-point stencil, zero at the boundary."""
    fixed = np.ones(right.shape[1:], dtype=np.uint8)
    fixed[1:-1, 1:-1] = 0
    planes = np.zeros((HESSIAN_PLANES, *fixed.shape))
    planes[[0, 2]] = 4.0
    planes[[3, 6, 7, 10]] = -1.0
    solver = hessian_solver(fixed, backend)
    return solver.solve(right, _LAPLACE).vector if solver.set_operator(planes) else np.zeros_like(right)


def from_boundary(coordinates: Array) -> Array:
    """Return the transfinite interpolation of the boundary of (2, ni, nj) coordinates."""
    sides = coordinates[:, :, 0], coordinates[:, :, -1], coordinates[:, 0], coordinates[:, -1]
    bottom, top, left, right = (side.T for side in sides)
    return transfinite(bottom, top, left, right).planes.copy()


def resample(field: Array, shape: tuple[int, ...], *, linear: bool) -> Array:
    """Interpolate a field (2, ni, nj), uniform in the logical square, to another number of nodes."""
    for axis, count in ((1, shape[0]), (2, shape[1])):
        if field.shape[axis] != count:
            field = _resample_axis(field, axis, count, linear=linear or field.shape[axis] < 4)
    return field


def _resample_axis(field: Array, axis: int, count: int, *, linear: bool) -> Array:
    """Interpolate along one axis: Lagrange's polynomial through the 2 or 4 nearest nodes."""
    given = field.shape[axis]
    place = np.linspace(0.0, given - 1.0, count)
    points = 2 if linear else 4
    first = np.clip(np.floor(place).astype(int) - (points // 2 - 1), 0, given - points)
    local = place - first
    moved = np.moveaxis(field, axis, -1)
    result = np.zeros((*moved.shape[:-1], count))
    for k in range(points):
        others = [m for m in range(points) if m != k]
        factor = np.prod([(local - m) / (k - m) for m in others], axis=0)
        result += factor * moved[..., first + k]
    return np.ascontiguousarray(np.moveaxis(result, -1, axis))
