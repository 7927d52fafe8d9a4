"""Valid grids with fewer lines between the same boundary nodes, refined.

A coarse grid keeps some of the boundary nodes. Where it is valid, its cells are convex, so that cells divided
bilinearly are valid, too. The boundary of the divided grid is the coarse polygon. Its nodes then move to where they
belong, in steps that keep every cell valid. So a valid coarse grid is not lost on the way to the fine one. Sharp turns
of the boundary are kept on the coarse grid: then its polygon differs little.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ...arrays import Array
from ...certificates import certificates
from ...functionals.registry import functional
from ...grids import Grid, transfinite
from ...runtime import kernels
from ..newton.minimize import minimize
from ..problem import Problem
from .boundary_continuation import move_boundary
from .search import Search

Lines = npt.NDArray[np.intp]

#: A coarse grid has so many cells along each direction at least.
_FEWEST_CELLS = 3
#: A boundary node is sharp if the boundary turns there by so much (in radians).
_SHARP = np.radians(15.0)
#: How well a coarse grid is relaxed before it is refined: factor by which the gradient must fall, and Newton steps.
_TOLERANCE, _STEPS = 1e-2, 30
#: The functional of all coarse grids: its barrier is strong.
_FUNCTIONAL = "winslow"


@dataclass(frozen=True, slots=True)
class CoarseGrids:
    """Untangle coarse grids of several shapes, and refine those that become valid.

    Attributes:
        strides: of the lines that a coarse grid keeps along i and j, one pair for each shape, in the order of trial.
        fewest_nodes: grids with fewer nodes are left to other strategies.
    """

    strides: tuple[tuple[int, int], ...]
    fewest_nodes: int = 0
    name: str = "refined coarse grids"

    def run(self, search: Search) -> None:
        """Try one shape after the other, unless inner nodes are fixed or it is clear that no valid grid exists."""
        if search.problem.fixed.size < self.fewest_nodes:
            return
        if search.problem.fixed[1:-1, 1:-1].any() or certificates(Grid.from_planes(*search.start)):
            return
        fine = _winslow(search.problem, search.start.shape[1:])
        for strides in self.strides:
            refined = _refined(search, fine, search.best.coordinates, strides)
            if refined is not None:
                search.best.offer(refined)
            if search.done:
                return


def _refined(search: Search, fine: Problem, boundary: Array, strides: tuple[int, int]) -> Array | None:
    """Return a valid grid with the sides of `boundary` from a coarse one, or None."""
    lines = kept_lines(boundary, strides)
    coarse = None if lines is None else _valid_coarse_grid(search, boundary, lines)
    if lines is None or coarse is None:
        return None
    coordinates = divided(coarse, lines)
    if fine.folds(coordinates).cells or not move_boundary(fine, coordinates, boundary, search.progress):
        return None
    return coordinates


def _valid_coarse_grid(search: Search, boundary: Array, lines: tuple[Lines, Lines]) -> Array | None:
    """Return a relaxed valid grid on some lines, or None: from the transfinite grid, or from a still coarser grid."""
    ring = boundary[:, lines[0]][:, :, lines[1]]
    xy = ring.transpose(1, 2, 0)
    coordinates = transfinite(xy[:, 0], xy[:, -1], xy[0], xy[-1]).planes.copy()
    problem = _winslow(search.problem, coordinates.shape[1:])
    if problem.folds(coordinates).cells and not search.untangle_part(problem, coordinates, functional(_FUNCTIONAL)):
        if problem.folds(coordinates).cells > problem.folds(coordinates, mendable=True).cells:
            return None  # Three boundary nodes make a corner that no grid can mend.
        refined = _refined(search, problem, coordinates, (2, 2))
        if refined is None:
            return None
        coordinates = refined
    minimize(problem, coordinates, search.progress, tolerance=_TOLERANCE, max_iterations=_STEPS, keep_valid=True)
    return coordinates


def kept_lines(boundary: Array, strides: tuple[int, int]) -> tuple[Lines, Lines] | None:
    """Return the indices of the lines that a coarse grid keeps in each direction, or None if these are too few.

    Of the lines that are nearest to each multiple of the stride, the one is kept that ends at the sharpest turn.

    Args:
        boundary: (2, ni, nj), of which the sides are used.
        strides: along i and j.
    """
    sides = (boundary[:, :, 0], boundary[:, :, -1]), (boundary[:, 0], boundary[:, -1])
    lines = tuple(_kept(pair, stride) for pair, stride in zip(sides, strides, strict=True))
    if min(len(kept) for kept in lines) <= _FEWEST_CELLS:
        return None
    return lines[0], lines[1]


def _kept(sides: tuple[Array, Array], stride: int) -> Lines:
    """Return the indices of the lines that are kept between two opposite sides (2, n)."""
    count = sides[0].shape[1]
    cells = max((count - 1) // stride, 1)
    at = np.linspace(0, count - 1, cells + 1)
    kept = np.rint(at).astype(np.intp)
    if stride == 1:
        return kept
    turn = np.maximum(_turns(sides[0]), _turns(sides[1]))
    for k in range(1, cells):
        low, high = np.floor((at[k - 1] + at[k]) / 2).astype(int) + 1, int((at[k] + at[k + 1]) // 2) + 1
        near = turn[low:high]
        if near.max(initial=0.0) > _SHARP:
            kept[k] = low + int(near.argmax())
    return kept


def _turns(side: Array) -> Array:
    """Return by how much a side (2, n) turns at its nodes, in radians and without sign; zero at its ends."""
    along = np.diff(side)
    cross = along[0, :-1] * along[1, 1:] - along[1, :-1] * along[0, 1:]
    turn = np.arctan2(np.abs(cross), (along[:, :-1] * along[:, 1:]).sum(axis=0))
    return np.concatenate(([0.0], turn, [0.0]))


def divided(coarse: Array, lines: tuple[Lines, Lines]) -> Array:
    """Return the grid whose lines with the given indices are those of a coarse grid, and that is bilinear between."""
    result = coarse
    for axis, kept in enumerate(lines, start=1):
        result = _interpolated(result, kept, axis)
    return np.ascontiguousarray(result)


def _interpolated(field: Array, kept: Lines, axis: int) -> Array:
    """Interpolate linearly along an axis, whose nodes have the indices `kept`, to all indices."""
    at = np.arange(kept[-1] + 1)
    cell = np.clip(np.searchsorted(kept, at, side="right") - 1, 0, len(kept) - 2)
    share = (at - kept[cell]) / (kept[cell + 1] - kept[cell])
    share = share.reshape([-1 if k == axis else 1 for k in range(field.ndim)])
    low, high = np.take(field, cell, axis=axis), np.take(field, cell + 1, axis=axis)
    return np.asarray(np.where(share == 0, low, (1 - share) * low + share * high))


def _winslow(problem: Problem, shape: tuple[int, ...]) -> Problem:
    """Return the problem of the coarse grids on a shape, with the backend of another problem."""
    fixed = np.zeros(shape, dtype=np.uint8)
    fixed[[0, -1]], fixed[:, [0, -1]] = 1, 1
    return Problem(kernels(functional(_FUNCTIONAL), "plain", None, problem.kernels.backend), fixed, None)
