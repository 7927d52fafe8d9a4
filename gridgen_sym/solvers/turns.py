"""Choose which nodes hold the sharp turns of sliding sides, before a functional is minimized."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..boundary.slide_curve import SlideCurve
from ..errors import GridgenError
from ..grids import Grid
from .harmonic import move_sides
from .minimization import NESTED, Run
from .newton.minimize import minimize
from .problem import Problem
from .sliding.side import side_index
from .sliding.turns import Lines, TurnedSide, on_side, turned_sides, with_turns

#: How well the problem of the rounded sides is solved, and that of the sides with their turns: both give a start.
_TOLERANCE, _STEPS = 1e-3, 100
#: Lines of the grid on which nodes slide along rounded sides.
_LINES = 65

_SAID = " Sharp turns of sliding sides are held by other nodes than at the start."


def choose_turns(
    run: Run, curves: Mapping[str, SlideCurve], make: Callable[[Grid, Mapping[str, SlideCurve]], Problem]
) -> None:
    """Take a start whose nodes hold the sharp turns where the functional wants them, if one is found that is better.

    Args:
        run: of a functional with a barrier; without one, or without sharp turns between the corners, nothing is done.
        curves: of the sliding sides.
        make: binds the functional to a grid and the curves of its sides.
    """
    ni, nj = run.start.shape
    lines = _lines(ni), _lines(nj)
    sides = turned_sides(run.start, curves, lines)
    if not sides or not run.problem.kernels.barrier or run.problem.fixed[1:-1, 1:-1].any():
        return
    free = _minimized(run, make, _on_rounded(run.start, lines, sides), _rounded(curves, sides))
    if free is None or all(side.stays(on_side(name, free.coordinates)) for name, side in sides.items()):
        return
    placed = with_turns(run.start, free.coordinates, lines, sides)
    held = None if placed is None else _minimized(run, make, placed, curves)
    if held is None:
        return
    energy, smallest = run.problem.energy(run.coordinates)
    if smallest > 0 and not held.problem.energy(held.coordinates)[0] < energy:
        return
    if not smallest > 0:
        run.untangled_by = held.untangled_by or free.untangled_by or NESTED
    run.problem, run.coordinates, run.reference, run.remark = held.problem, held.coordinates, held.reference, _SAID


def _rounded(curves: Mapping[str, SlideCurve], sides: Mapping[str, TurnedSide]) -> dict[str, SlideCurve]:
    return {name: sides[name].rounded if name in sides else curve for name, curve in curves.items()}


def _lines(nodes: int) -> npt.NDArray[np.intp]:
    """Return some lines of so many, also the first and the last: turns are found on a coarse grid."""
    return np.rint(np.linspace(0, nodes - 1, min(nodes, _LINES))).astype(np.intp)


def _on_rounded(start: Grid, lines: Lines, sides: Mapping[str, TurnedSide]) -> Array:
    """Return the lines of the start (2, mi, mj) with the sides that have turns on their rounded curves."""
    coarse = start.planes[:, lines[0][:, None], lines[1]]
    boundary = coarse.copy()
    for name, side in sides.items():
        boundary[:, *side_index(name, coarse.shape[1:])] = side.rounded.point(side.places).T
    return move_sides(coarse, boundary)


def _minimized(
    run: Run,
    make: Callable[[Grid, Mapping[str, SlideCurve]], Problem],
    start: Array,
    curves: Mapping[str, SlideCurve],
) -> Run | None:
    """Return a run that has roughly minimized the functional with other sides; None where no valid grid was found."""
    grid = Grid.from_planes(*start)
    try:
        problem = make(grid, curves)
    except GridgenError:  # Such as a field that has no value where the rounded sides are.
        return None
    on_curves = start.copy()
    problem.retract(on_curves)
    on_curves = move_sides(start, on_curves)
    inner = Run(problem, run.make, run.functional, run.parameters, on_curves, run.report, grid)
    inner.start_from_coarse_grids()
    if not inner.make_valid():
        return None
    run.report.begin("choose nodes at turns", grid.shape)
    minimize(problem, inner.coordinates, run.report, tolerance=_TOLERANCE, max_iterations=_STEPS, keep_valid=True)
    inner.reference = run.report.history[0].gradient_norm
    return inner
