"""Prolongation: from one grid to another of the same boundary with more or fewer nodes.

What is interpolated to a finer grid is the displacement from transfinite interpolation, which is smooth where the
boundary is not, by cubic polynomials: then one or two Newton steps on the finer grid suffice. Where the outline has
kinks of the size of a cell, transfinite interpolation carries them across the whole domain, and the start may be folded
there. Then the nodes themselves are interpolated, linearly, which folds nothing where every cell is halved. Only what
the finer boundary adds is extended into the domain, by Laplace's equation: it is small, oscillates, and decays in a few
cells.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from ...arrays import Array
from ...grids import transfinite
from ..folds import Folds
from ..harmonic import move_sides
from ..problem import Problem
from ..sliding.prolongation import shrink_corners

#: A grid with less than this part of its cells folded is nearly valid.
_FEW = 0.02
#: Rows of nodes that are worked on at once.
_BLOCK = 32


def coarse_start(coordinates: Array, shape: tuple[int, int]) -> Array:
    """Return the transfinite interpolation (2, ni, nj) of a grid's boundary, resampled to `shape`."""
    sides = coordinates[:, :, 0], coordinates[:, :, -1], coordinates[:, 0], coordinates[:, -1]
    counts = shape[0], shape[0], shape[1], shape[1]
    along = (_resample_lines(side, count, linear=True) for side, count in zip(sides, counts, strict=True))
    return transfinite(*(side.T for side in along)).planes.copy()


def finer_start(problem: Problem, coarse: Array, fine_boundary: Array) -> Array:
    """Return the start on a finer grid: the first of several prolongations that is valid, or the least folded one.

    Args:
        problem: on the finer grid; counts the folds.
        coarse: (2, ni, nj), solved on a coarser grid.
        fine_boundary: (2, ni, nj) of the finer grid, of which the boundary is used.
    """
    interpolated = from_boundary(fine_boundary)
    start = _displaced(coarse, interpolated)
    least = problem.folds(start)
    if least.cells:
        start, least = _less_folded(problem, start, least, _spread(coarse, interpolated))
    if least.cells > _FEW * start[0].size:
        start, least = _less_folded(problem, start, least, interpolated.copy())
    return start


def slid_start(problem: Problem, coarse: Array, fine_boundary: Array) -> Array:
    """Return the start on a finer grid whose boundary nodes are spaced as those that slid on the coarse one.

    They crowd at some corners and leave others, which makes the transfinite grid useless, and with it displacements
    from it: the nodes themselves are interpolated, by cubic polynomials.

    Args:
        problem: on the finer grid; counts the folds.
        coarse: (2, ni, nj), solved on a coarser grid.
        fine_boundary: (2, ni, nj) of the finer grid, of which the boundary is used.
    """
    start = resample(coarse, fine_boundary.shape[1:], linear=False)
    shrink_corners(start, coarse)
    start = move_sides(start, fine_boundary)
    folds = problem.folds(start)
    if not folds.cells:
        return start
    return _less_folded(problem, start, folds, finer_start(problem, coarse, fine_boundary))[0]


def _less_folded(problem: Problem, start: Array, least: Folds, other: Array) -> tuple[Array, Folds]:
    """Return the less folded of two grids, of which the folds of one are known, and its folds."""
    folds = problem.folds(other)
    return (other, folds) if folds < least else (start, least)


def _displaced(coarse: Array, interpolated: Array) -> Array:
    """Return a transfinite grid plus the displacement of the coarse grid from its own."""
    start = coarse - from_boundary(coarse)  # Zero at the boundary, and so is what is interpolated from it.
    start = resample(start, interpolated.shape[1:], linear=False)
    start += interpolated
    return start


def _spread(coarse: Array, fine_boundary: Array) -> Array:
    """Return the coarse nodes, interpolated linearly, plus the harmonic extension of the boundary's difference."""
    return move_sides(resample(coarse, fine_boundary.shape[1:], linear=True), fine_boundary)


def from_boundary(coordinates: Array) -> Array:
    """Return the transfinite interpolation, read-only, of the boundary of (2, ni, nj) coordinates."""
    sides = coordinates[:, :, 0], coordinates[:, :, -1], coordinates[:, 0], coordinates[:, -1]
    return transfinite(*(side.T for side in sides)).planes


def is_transfinite(coordinates: Array) -> bool:
    """Whether nodes (2, ni, nj) are those of the transfinite interpolation of their boundary, to rounding."""
    return bool(np.abs(coordinates - from_boundary(coordinates)).max() <= 1e-9 * np.ptp(coordinates))


def resample(field: Array, shape: tuple[int, ...], *, linear: bool) -> Array:
    """Interpolate a field (2, ni, nj), uniform in the logical square, to another number of nodes."""
    rows, columns = (np.linspace(0.0, given - 1.0, count) for given, count in zip(field.shape[1:], shape, strict=True))
    return interpolate(field, rows, columns, linear=linear)


def interpolate(field: Array, rows: Array, columns: Array, *, linear: bool) -> Array:
    """Interpolate a field (2, ni, nj) at these places among its own rows and columns, from 0 to ni-1 and nj-1."""
    found = field
    if len(columns) != field.shape[2]:
        found = _interpolate_lines(found, columns, linear=linear)
    return _interpolate_rows(found, rows, linear=linear) if len(rows) != field.shape[1] else found


def _resample_lines(field: Array, count: int, *, linear: bool) -> Array:
    """Interpolate along the last axis."""
    if field.shape[-1] == count:
        return field
    return _interpolate_lines(field, np.linspace(0.0, field.shape[-1] - 1.0, count), linear=linear)


def _interpolate_lines(field: Array, places: Array, *, linear: bool) -> Array:
    first, factors = _lagrange(field.shape[-1], places, linear=linear)
    rows = field.reshape(-1, field.shape[-1])
    result = np.zeros((len(rows), len(places)))
    for block in _blocks(len(rows)):
        for k, factor in enumerate(factors):
            result[block] += factor * rows[block, first + k]
    return result.reshape(*field.shape[:-1], len(places))


def _interpolate_rows(field: Array, places: Array, *, linear: bool) -> Array:
    """Interpolate a field (2, ni, nj) along the axis of i."""
    first, factors = _lagrange(field.shape[1], places, linear=linear)
    result = np.zeros((2, len(places), field.shape[2]))
    for block in _blocks(len(places)):
        for k, factor in enumerate(factors):
            result[:, block] += factor[block, None] * field[:, first[block] + k]
    return result


def _lagrange(given: int, place: Array, *, linear: bool) -> tuple[npt.NDArray[np.intp], Array]:
    """Return the first of the 2 or 4 nodes from which each new one is interpolated, and the factors of all."""
    return _factors(given, place.tobytes(), 2 if linear or given < 4 else 4)


@lru_cache(maxsize=64)
def _factors(given: int, places: bytes, points: int) -> tuple[npt.NDArray[np.intp], Array]:
    """Blocks of a layout often have the same sizes."""
    place = np.frombuffer(places)
    first = np.clip(np.floor(place).astype(np.intp) - (points // 2 - 1), 0, given - points)
    local, nodes = place - first, range(points)
    return first, np.array([np.prod([(local - m) / (k - m) for m in nodes if m != k], axis=0) for k in nodes])


def _blocks(count: int) -> Iterator[slice]:
    """Yield groups of rows whose intermediate results stay in the processor's cache."""
    return (slice(begin, begin + _BLOCK) for begin in range(0, count, _BLOCK))
