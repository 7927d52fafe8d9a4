"""Minimize over the few nodes whose gradient stands out, before Newton's method moves all nodes at once.

Where a finer grid sees bays of the boundary that coarser ones did not know, its start is folded, or only just valid,
in a few places. There Newton's method raises the smallest Jacobian by no more than a factor 1.5 a step, which is what
it does on 1/J, and each step costs as much as the whole grid. In those places alone, node by node and then window by
window, the same steps cost a hundredth of that. (Nonlinear elimination: Lanzkron, Rose and Wilkes 1996; Cai and Li
2011.)
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ...arrays import Array
from ..iterate import Iterate
from ..local import sweep
from ..run.deadline import Deadline
from ..run.step_control import jacobian_floor
from ..subdomains import subdomains

#: Nodes stand out whose gradient's square is so many times the mean: in the sweeps, and for a window.
_SWEPT, _CUT_OUT = 1.0, 30.0
#: If they, with their neighbors, are more than this part of all nodes, none stands out.
_MOST = 0.1
#: Sweeps go on while each lowers the gradient's norm by this factor at least.
_WORTH_WHILE = 0.8
#: Windows hold so many layers of nodes round those that stand out. They help if they hold this part of the squares.
_LAYERS, _HELD = 6, 0.9
#: A grid with fewer nodes is a window itself.
_SMALLEST = 4096


def steep_subdomains(iterate: Iterate) -> list[tuple[slice, slice]]:
    """Return small subdomains, as slices of nodes, that hold nearly all of the gradient; none where there are none."""
    problem, coordinates = iterate.problem, iterate.coordinates
    # What a weight, or which corners are counted, depends on the whole grid.
    if problem.weight is not None or problem.interior_only or coordinates[0].size < _SMALLEST:
        return []
    squares = _squares(iterate.gradient)
    standing = _standing_out(squares, _CUT_OUT)
    parts = [] if standing is None else list(subdomains(standing, _LAYERS))
    held = sum(float(squares[part].sum()) for part in parts)
    return parts if held >= _HELD * float(squares.sum()) else []


def sweep_standing_out(iterate: Iterate, deadline: Deadline, *, until_valid: bool = False) -> None:
    """Sweep over the nodes that stand out, in place, as long as that pays, or up to the first valid grid."""
    last, reach = np.inf, 1e3 * float(np.ptp(iterate.coordinates))
    while iterate.norm < _WORTH_WHILE * last and not (until_valid and iterate.smallest > 0):
        deadline.check()
        standing = _standing_out(_squares(iterate.gradient), _SWEPT)
        if standing is None:
            break
        held = np.asarray(~standing | (iterate.problem.fixed != 0), dtype=np.uint8)
        floor = jacobian_floor(iterate.smallest) if iterate.smallest > 0 else -1.0
        sweep(iterate.problem, iterate.coordinates, held, floor=floor, reach=reach)
        last = iterate.norm
        iterate.evaluate()


def _squares(gradient: Array) -> Array:
    """Return the square of the gradient's length at every node."""
    return np.asarray(np.einsum("cij,cij->ij", gradient, gradient))


def _standing_out(squares: Array, factor: float) -> npt.NDArray[np.bool_] | None:
    """Return where squares stand out, and the neighbors of these nodes; None if there are none, or too many."""
    nodes = np.asarray(squares > factor * squares.mean())
    nodes[1:] |= nodes[:-1]
    nodes[:-1] |= nodes[1:]
    nodes[:, 1:] |= nodes[:, :-1]
    nodes[:, :-1] |= nodes[:, 1:]
    return nodes if 0 < np.count_nonzero(nodes) < _MOST * nodes.size else None
