"""The search for a proof that no valid grid exists: contract the places of nodes, and then tell cases apart.

A node's place is cut in two halves. If no valid grid has the node in one of them, which contraction shows, the other
half is its place. If that leads no further for any node, both halves of one are followed up, each by itself: a tree
of cases, whose every leaf must be a contradiction.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from ..arrays import Array
from ..grids.grid import Grid
from .cuts import halves
from .lattice import Polygon, doubled_area
from .neck import Node
from .network import Network, OutOfWork
from .places import Place, Places

#: Rules that may be used in one attempt to find a proof: for a first look, and where nothing else helps.
LITTLE_WORK, WORK = 10_000, 100_000
#: Of so many nodes, those with the largest places, these are cut in halves to see what that tells. Area knows no
#: direction, so that a thin band is like any other.
_TRIED = 15


@dataclass(frozen=True, slots=True)
class Conflict:
    """Cells that cannot all be valid in a grid whose other cells are valid, wherever the inner nodes are.

    Attributes:
        cells: each by its first node (i, j).
        work: how many rules were used to prove it.
        share: what cannot be is that their corner Jacobians all exceed this part of what is expected of them: at 0,
            that all are valid.
        cases: whether cases had to be told apart.
    """

    cells: tuple[Node, ...]
    work: int
    share: float
    cases: bool


def contracted_places(
    grid: Grid,
    cells: Iterable[Node] | None = None,
    work: int = LITTLE_WORK,
    *,
    share: float = 0.0,
    cases: bool = True,
    check: Callable[[], object] | None = None,
) -> dict[Node, tuple[Array, ...]] | Conflict:
    """Return where each inner node of some cells lies in every valid grid with the same boundary nodes, or a proof.

    With a share, in every grid whose corner Jacobians exceed it: its nodes have less choice, the more so the larger.

    Args:
        grid: any grid with the boundary nodes; its inner nodes do not matter.
        cells: each by its first node (i, j); all cells if None. Only what these say is used.
        work: how many rules may be used.
        share: corner Jacobians exceed this part of what the boundary's spacing lets expect (`expected_jacobians`).
        cases: False to look at corners only, and to tell no cases apart: this is quick, and proves less.
        check: called again and again; what it raises ends the work.

    Returns:
        For each inner node of the cells convex polygons (n, 2), counter-clockwise, the largest first: one of them
        contains it, if perhaps not everywhere. Or the cells that conflict.
    """
    ni, nj = grid.shape
    every = [(i, j) for i in range(ni - 1) for j in range(nj - 1)]
    network = Network(grid, every if cells is None else cells, work, share=share, sight=cases, check=check)
    places = network.start.copy()
    try:
        why = network.contract(places)
        if why is None and cases:
            why = network.divide(places)
        if why is None and cases:
            why = _contradiction(network, places)
    except OutOfWork:
        why = None
    if why is not None:
        return Conflict(network.named(why), work - network.work, share, cases)
    return {
        node: tuple(map(network.lattice.coordinates, sorted(places[node].parts, key=doubled_area, reverse=True)))
        for node in network.free
    }


def _contradiction(network: Network, places: Places) -> int | None:
    """Return cells, as bits, that cannot all be valid, or None where no case can be told apart any more.

    Raises:
        OutOfWork: `places` hold what is known in all cases.
    """
    cases, why = [places], 0
    while cases:
        outcome = _tell_apart(network, cases.pop())
        if outcome is None:
            return None
        if isinstance(outcome, int):
            why |= outcome
        else:
            cases += outcome
    return why


def _tell_apart(network: Network, places: Places) -> int | list[Places] | None:
    """Cut the places of nodes in halves as long as one half is impossible, in place; then return both cases of one.

    Returns:
        The cells, as bits, of a contradiction; or two cases of which one is true; or None if nothing can be cut.
    """
    frame = _moments(network.hull)
    learned = True
    while learned:
        learned, best, most = False, None, 0.0
        for node in sorted(network.free, key=lambda node: -places[node].area)[:_TRIED]:
            cases: list[Places] = []
            impossible = 0
            for half in _halves(places[node], frame):
                case = places.copy()
                case[node] = Place.of(half, places[node].cells | impossible)
                why = network.contract(case, node)
                if why is None:
                    cases.append(case)
                else:
                    impossible |= why
            if not cases:
                return impossible
            if len(cases) == 1:
                _learn(places, cases[0], impossible)
                learned = True
            elif (told := min(_told(places, case) for case in cases)) > most:
                best, most = cases, told
    return best


def _learn(places: Places, case: Places, why: int) -> None:
    """Take what holds in the only possible case, for the reasons that there are and those that exclude the other."""
    for node, place in case.items():
        if place is not places[node]:
            places[node] = place._replace(cells=place.cells | why)


def _told(places: Places, case: Places) -> float:
    """Return how much smaller the places are in a case, as a sum of logarithms of areas."""
    pairs = ((places[node].area, place.area) for node, place in case.items() if place is not places[node])
    return sum(math.log(max(whole, 1)) - math.log(max(part, 1)) for whole, part in pairs)


def _halves(place: Place, frame: Array) -> tuple[tuple[Polygon, ...], tuple[Polygon, ...]]:
    """Return some parts of a place and the others; of a single part, its halves."""
    dx, dy = along = _across(place.hull, frame)
    if len(place.parts) == 1:
        first, second = halves(place.hull, along)
        return (first,), (second,)
    parts = sorted(place.parts, key=lambda part: Fraction(sum(dx * y - dy * x for x, y in part), len(part)))
    count, area = 1, doubled_area(parts[0])
    while count < len(parts) - 1 and 2 * area < place.area:
        area += doubled_area(parts[count])
        count += 1
    return tuple(parts[:count]), tuple(parts[count:])


def _across(region: Polygon, frame: Array) -> tuple[int, int]:
    """Return the direction across the longest extent of a region, lengths being measured by second moments `frame`."""
    # Of a very thin hull, rounding may make them singular.
    unit = np.linalg.cholesky(frame + 1e-14 * np.trace(frame) * np.eye(2))
    seen = np.linalg.solve(unit, np.linalg.solve(unit, _moments(region)).T)
    normal = np.linalg.solve(unit.T, np.linalg.eigh(seen)[1][:, 1])
    size = float(np.abs(normal).max())
    return round(-normal[1] / size * 2.0**30), round(normal[0] / size * 2.0**30)


def _moments(region: Polygon) -> Array:
    """Return the second moments (2, 2) of a polygon's corners round their middle, up to a factor."""
    x0, y0 = region[0]
    size = max(max(abs(x - x0), abs(y - y0)) for x, y in region) or 1
    points = np.array([((x - x0) / size, (y - y0) / size) for x, y in region])
    return np.asarray(np.cov(points.T))
