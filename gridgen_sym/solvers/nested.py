"""Nested iteration: the same boundary on coarser grids, and the way from a coarse solution to a finer start.

What is carried from grid to grid is the displacement from transfinite interpolation, which is smooth where the
boundary is not. The interpolation is cubic along each direction: then one or two Newton steps on the finer grid
suffice.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from ..functionals.definition import Functional
from ..grids import Grid, transfinite
from ..runtime import Array
from .newton import minimize
from .problem import Problem
from .progress import Progress
from .untangle import unfold

#: A direction with this many cells is not halved further.
_FEWEST_CELLS = 8
#: How well a coarse problem is solved: its solution is only a start for the next.
_TOLERANCE, _STEPS = 1e-4, 30


def worth_nesting(problem: Problem, coordinates: Array) -> bool:
    """Return whether coarse grids can give a better start than the one that was given.

    They know the boundary only: a valid grid with an inside of its own, fixed inner nodes or one weight per
    node are things that they would lose.
    """
    inner_fixed = bool(problem.fixed[1:-1, 1:-1].any())
    weight_per_node = problem.weight is not None and problem.weight.per_node
    if problem.kernels.backend != "c" or inner_fixed or weight_per_node or len(coarse_shapes(problem.fixed.shape)) == 1:
        return False
    difference = np.abs(coordinates - from_boundary(coordinates)).max()
    return bool(difference <= 1e-9 * np.ptp(coordinates) or not problem.energy(coordinates)[1] > 0)


def nested_start(
    make: Callable[[Grid], Problem],
    functional: Functional,
    coordinates: Array,
    parameters: Mapping[str, float] | None,
    report: Progress,
) -> Array | None:
    """Solve on coarse grids of the same boundary and return the start (2, ni, nj) that they give, or None.

    Args:
        make: binds the functional and its weight to a grid.
        functional: what is minimised.
        coordinates: (2, ni, nj), of which the boundary is used.
        parameters: of the functional.
        report: is told of every step.
    """
    solved: Array | None = None
    for shape in coarse_shapes(coordinates.shape[1:])[:-1]:
        start = coarse_start(coordinates, shape)
        if solved is not None:
            start = finer_start(solved, start)
        problem = make(Grid.from_planes(start[0], start[1]))
        if problem.kernels.barrier and not problem.energy(start)[1] > 0:
            report.begin("untangle", shape)
            # A boundary may have no valid grid with this few nodes, and yet have one with more.
            if not unfold(problem, functional, start, parameters, report):
                solved = None
                continue
            problem.refresh(start)
        report.begin("minimize", shape)
        minimize(problem, start, report, tolerance=_TOLERANCE, max_iterations=_STEPS, keep_valid=True)
        solved = start
    return None if solved is None else finer_start(solved, coordinates)


def coarse_shapes(shape: tuple[int, ...]) -> list[tuple[int, int]]:
    """Return the shapes of the grids of nested iteration, the coarsest first, ending with `shape`."""
    shapes = [(shape[0], shape[1])]
    while max(shapes[0]) - 1 > _FEWEST_CELLS:
        ni, nj = ((count if count - 1 <= _FEWEST_CELLS else count // 2 + 1) for count in shapes[0])
        shapes.insert(0, (ni, nj))
    return shapes


def coarse_start(coordinates: Array, shape: tuple[int, int]) -> Array:
    """Return the transfinite interpolation (2, ni, nj) of a grid's boundary, resampled to `shape`."""
    return from_boundary(resample(coordinates, shape, linear=True))


def finer_start(coarse: Array, fine_boundary: Array) -> Array:
    """Return the start on a finer grid: transfinite interpolation of its boundary plus the coarse displacement."""
    start = from_boundary(fine_boundary)
    displacement = resample(coarse - from_boundary(coarse), fine_boundary.shape[1:], linear=False)
    start[:, 1:-1, 1:-1] += displacement[:, 1:-1, 1:-1]
    return start


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
