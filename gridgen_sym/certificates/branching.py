"""Branch and bound: the search for a proof by constraint propagation on parts of feasible regions.

The feasible region of a node is bisected. If propagation shows that one half is infeasible, the other half is the
region. If that leads no further for any node, the search branches on one: both halves are followed up, each by itself,
and every leaf of the tree must be infeasible.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from ..arrays import Array
from ..grids.grid import Grid
from .clipping import bisect
from .constraint_network import BudgetExceeded, ConstraintNetwork
from .feasible_region import FeasibleRegion, Regions
from .integer_polygons import Polygon, doubled_area
from .node_constraints import Node

#: Constraints that one attempt may apply, at about 50 microseconds each: at first, and where nothing else helps.
DEFAULT_BUDGET, LARGE_BUDGET = 10_000, 100_000
#: So many nodes, those with the largest regions, are bisected to see what that excludes. Areas do not depend on a
#: direction, so a thin band is like any other.
_MOST_BISECTED = 15


@dataclass(frozen=True, slots=True)
class Conflict:
    """Cells that cannot all be valid in a grid whose other cells are valid, wherever the inner nodes are.

    Attributes:
        cells: each by its first node (i, j).
        cost: how many constraints were applied to prove it.
        jacobian_fraction: what is impossible is that all corner Jacobians of the cells exceed this fraction of the
            expected ones; at 0, that all cells are valid.
        branched: whether visibility and branching were used.
    """

    cells: tuple[Node, ...]
    cost: int
    jacobian_fraction: float
    branched: bool


def feasible_regions(
    grid: Grid,
    cells: Iterable[Node] | None = None,
    budget: int = DEFAULT_BUDGET,
    *,
    jacobian_fraction: float = 0.0,
    branch: bool = True,
    check: Callable[[], object] | None = None,
) -> dict[Node, tuple[Array, ...]] | Conflict:
    """Return where each inner node of some cells lies in every valid grid with the same boundary nodes, or a conflict.

    With a `jacobian_fraction`, in every valid grid whose corner Jacobians exceed it: the larger it is, the smaller are
    the regions. All decisions are made in integer arithmetic, on the exact coordinates of the boundary nodes.

    Args:
        grid: any grid with the boundary nodes; its inner nodes do not matter.
        cells: each by its first node (i, j); None for all cells. Only their constraints are used.
        budget: how many constraints may be applied, at about 50 microseconds each.
        jacobian_fraction: the fraction of `expected_jacobians` that the corner Jacobians exceed.
        branch: False to use the constraints of corners only, without branching: this is quick, and proves less.
        check: called often; what it raises ends the work.

    Returns:
        For each inner node of the cells convex polygons (n, 2), counter-clockwise, the largest first: one of them
        contains the node, up to the rounding of the polygons. Or the cells that conflict.
    """
    ni, nj = grid.shape
    every = [(i, j) for i in range(ni - 1) for j in range(nj - 1)]
    network = ConstraintNetwork(
        grid,
        every if cells is None else cells,
        budget,
        jacobian_fraction=jacobian_fraction,
        visibility=branch,
        check=check,
    )
    regions = network.start.copy()
    conflict = _conflict_in(network, regions, branch)
    return conflict or {
        node: tuple(map(network.coordinates.to_floats, sorted(regions[node].parts, key=doubled_area, reverse=True)))
        for node in network.free
    }


def prove_conflict(
    grid: Grid,
    cells: Iterable[Node],
    budget: int,
    *,
    jacobian_fraction: float,
    branch: bool,
    check: Callable[[], object] | None,
) -> Conflict | None:
    """Return a conflict among some cells, or None if none is found; arguments as for `feasible_regions`."""
    network = ConstraintNetwork(
        grid, cells, budget, jacobian_fraction=jacobian_fraction, visibility=branch, check=check
    )
    return _conflict_in(network, network.start.copy(), branch)


def _conflict_in(network: ConstraintNetwork, regions: Regions, branch: bool) -> Conflict | None:
    """Reduce regions, in place, within the budget of a new network; return a conflict if one is found."""
    budget = network.budget
    try:
        why = search_conflict(network, regions, branch)
    except BudgetExceeded:
        return None
    if why is None:
        return None
    return Conflict(network.cells_of(why), budget - network.budget, network.jacobian_fraction, branch)


def search_conflict(network: ConstraintNetwork, regions: Regions, branch: bool) -> int | None:
    """Reduce regions in place; return cells, as bits, that conflict, or None if no conflict is found.

    Raises:
        BudgetExceeded: `regions` are valid then, if not as small as they could be.
    """
    why = network.propagate(regions)
    if why is None and branch:
        why = network.clip_to_inside(regions)
    if why is None and branch:
        why = _search_tree(network, regions)
    return why


def _search_tree(network: ConstraintNetwork, regions: Regions) -> int | None:
    """Return cells, as bits, that conflict, or None as soon as some branch cannot be divided any more.

    Raises:
        BudgetExceeded: `regions` hold what is known in all branches.
    """
    branches, why = [regions], 0
    while branches:
        outcome = _branch(network, branches.pop())
        if outcome is None:
            return None
        if isinstance(outcome, int):
            why |= outcome
        else:
            branches += outcome
    return why


def _branch(network: ConstraintNetwork, regions: Regions) -> int | list[Regions] | None:
    """Bisect regions, in place, as long as one half is infeasible; then return both branches of one node.

    Returns:
        The cells, as bits, of a conflict; or two branches, one of which holds; or None if no bisection helps.
    """
    moments = _second_moments(network.hull)
    reduced = True
    while reduced:
        reduced, best, most = False, None, 0.0
        for node in sorted(network.free, key=lambda node: -regions[node].area)[:_MOST_BISECTED]:
            branches: list[Regions] = []
            infeasible = 0
            for half in _halves(regions[node], moments):
                branch = regions.copy()
                branch[node] = FeasibleRegion.of(half, regions[node].reasons | infeasible)
                why = network.propagate(branch, node)
                if why is None:
                    branches.append(branch)
                else:
                    infeasible |= why
            if not branches:
                return infeasible
            if len(branches) == 1:
                _adopt(regions, branches[0], infeasible)
                reduced = True
            elif (gain := min(_gain(regions, branch) for branch in branches)) > most:
                best, most = branches, gain
    return best


def _adopt(regions: Regions, branch: Regions, why: int) -> None:
    """Take over the only feasible branch; its reasons are its own and those that exclude the other branch."""
    for node, region in branch.items():
        if region is not regions[node]:
            regions[node] = region._replace(reasons=region.reasons | why)


def _gain(regions: Regions, branch: Regions) -> float:
    """Return how much smaller the regions are in a branch, as a sum of logarithms of areas."""
    pairs = ((regions[node].area, region.area) for node, region in branch.items() if region is not regions[node])
    return sum(math.log(max(whole, 1)) - math.log(max(part, 1)) for whole, part in pairs)


def _halves(region: FeasibleRegion, moments: Array) -> tuple[tuple[Polygon, ...], tuple[Polygon, ...]]:
    """Return some parts of a region and the others; of a single part, its halves."""
    dx, dy = along = _bisecting_direction(region.hull, moments)
    if len(region.parts) == 1:
        first, second = bisect(region.hull, along)
        return (first,), (second,)
    parts = sorted(region.parts, key=lambda part: Fraction(sum(dx * y - dy * x for x, y in part), len(part)))
    count, area = 1, doubled_area(parts[0])
    while count < len(parts) - 1 and 2 * area < region.area:
        area += doubled_area(parts[count])
        count += 1
    return tuple(parts[:count]), tuple(parts[count:])


def _bisecting_direction(polygon: Polygon, moments: Array) -> tuple[int, int]:
    """Return the direction across the longest extent of a polygon, in the metric of second moments (2, 2).

    Any direction is right; this one makes halves that are not thin.
    """
    # Of a very thin hull, rounding may make the moments singular.
    unit = np.linalg.cholesky(moments + 1e-14 * np.trace(moments) * np.eye(2))
    seen = np.linalg.solve(unit, np.linalg.solve(unit, _second_moments(polygon)).T)
    normal = np.linalg.solve(unit.T, np.linalg.eigh(seen)[1][:, 1])
    size = float(np.abs(normal).max())
    return round(-normal[1] / size * 2.0**30), round(normal[0] / size * 2.0**30)


def _second_moments(polygon: Polygon) -> Array:
    """Return the second moments (2, 2) of a polygon's corners about their mean, up to a factor."""
    x0, y0 = polygon[0]
    size = max(max(abs(x - x0), abs(y - y0)) for x, y in polygon) or 1
    points = np.array([((x - x0) / size, (y - y0) / size) for x, y in polygon])
    return np.asarray(np.cov(points.T))
