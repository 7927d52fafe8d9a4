"""Nonlinear elimination: relax the few nodes with an outstanding gradient before the global Newton step.

A finer grid resolves bays of the boundary that coarser ones do not. There its start is folded or only just valid, and
Newton's method raises the smallest Jacobian by no more than a factor 1.5 a step, as it does on 1/J, while each step
costs as much as the whole grid. On those nodes alone, one by one and then in subdomains, the same steps cost a
hundredth of that. (Nonlinear elimination: Lanzkron, Rose and Wilkes 1996; Cai and Li 2011.)
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ...arrays import Array
from ..iterate import Iterate
from ..local import sweep
from ..problem import Problem
from ..run.deadline import Deadline
from ..run.step_control import jacobian_floor
from ..subdomains import subdomains

#: A gradient is outstanding if its square is so many times the mean: in the sweeps, and for a subdomain.
_SWEPT, _CUT_OUT = 1.0, 30.0
#: If such nodes and their neighbors are more than this fraction of all nodes, none counts as outstanding.
_MOST = 0.1
#: Sweeps go on while each lowers the gradient's norm by this factor at least.
_WORTH_WHILE = 0.8
#: Layers of nodes around outstanding ones in a subdomain; the fraction of the squares that subdomains must hold.
_LAYERS, _HELD = 6, 0.9
#: A grid with fewer nodes is its own subdomain.
_SMALLEST = 4096


def steep_subdomains(iterate: Iterate, problem: Problem) -> list[tuple[slice, slice]]:
    """Return small subdomains, as slices of nodes, that hold nearly all of the gradient; none where there are none."""
    coordinates = iterate.coordinates
    # Values beside the metric, and the set of corners that count, depend on the whole grid.
    if problem.inputs is not None or problem.interior_only or coordinates[0].size < _SMALLEST:
        return []
    squares = _squares(iterate.gradient)
    standing = _standing_out(squares, _CUT_OUT)
    parts = [] if standing is None else list(subdomains(standing, _LAYERS))
    held = sum(float(squares[part].sum()) for part in parts)
    return parts if held >= _HELD * float(squares.sum()) else []


def sweep_standing_out(iterate: Iterate, problem: Problem, deadline: Deadline, *, until_valid: bool = False) -> None:
    """Sweep over outstanding nodes, in place, while that is efficient, or up to the first valid grid."""
    last, reach = np.inf, 1e3 * float(np.ptp(iterate.coordinates))
    while iterate.norm < _WORTH_WHILE * last and not (until_valid and iterate.smallest > 0):
        deadline.check()
        standing = _standing_out(_squares(iterate.gradient), _SWEPT)
        if standing is None:
            break
        held = np.asarray(~standing | (problem.fixed != 0), dtype=np.uint8)
        floor = jacobian_floor(iterate.smallest) if iterate.smallest > 0 else -1.0
        sweep(problem, iterate.coordinates, held, floor=floor, reach=reach)
        last = iterate.norm
        iterate.evaluate()


def _squares(gradient: Array) -> Array:
    """Return the square of the gradient's length at every node."""
    return np.asarray(np.einsum("cij,cij->ij", gradient, gradient))


def _standing_out(squares: Array, factor: float) -> npt.NDArray[np.bool_] | None:
    """Return the nodes with outstanding squares and their neighbors; None if there are none, or too many."""
    nodes = np.asarray(squares > factor * squares.mean())
    nodes[1:] |= nodes[:-1]
    nodes[:-1] |= nodes[1:]
    nodes[:, 1:] |= nodes[:, :-1]
    nodes[:, :-1] |= nodes[:, 1:]
    return nodes if 0 < np.count_nonzero(nodes) < _MOST * nodes.size else None
