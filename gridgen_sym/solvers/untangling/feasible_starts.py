"""Maximize the smallest Jacobian from feasible starts: nodes in the middle of where valid grids have them.

A subdomain around a fold is a grid with sides of its own. Constraint propagation gives the feasible region of each
node, for valid grids and for those whose corner Jacobians exceed a fraction of the expected ones. The larger that
fraction, the smaller the regions, until no such grid is left. So the largest feasible fraction is tried first: from the
middle of these regions a few linear programs lead to a valid grid, however uneven it must be. Where regions are large
and say little, the transfinite grid is a better start, and is tried last.

An affine map neither folds nor unfolds a cell, but it changes how far a program may move a node in each direction. So
the programs also run in coordinates in which the boundary's extents are equal, and in stretched ones.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ...arrays import Array
from ...certificates.branching import Conflict, feasible_regions
from ...grids import Grid, transfinite
from ..run.deadline import Deadline
from ..subdomains import restrict
from .affine_maps import stretched_maps
from .search import BestSoFar, Search
from .smallest_jacobian import MOST_NODES, FoldedRegion, surroundings

#: Nodes up to so many cells from a fold are moved, at first and then.
_LAYERS = (3, 9)
#: Feasible regions are those of grids whose corner Jacobians exceed such a fraction of the expected ones.
_FRACTIONS = (0.1, 0.01, 1e-3, 1e-4, 1e-6)


@dataclass(frozen=True, slots=True)
class FeasibleStarts:
    """Maximize the smallest Jacobian in each subdomain around a fold of the best grid, from feasible starts.

    Attributes:
        budget: rules that the propagation of constraints may use for one start.
    """

    budget: int
    name: str = "largest smallest Jacobian from feasible starts"

    def run(self, search: Search) -> None:
        """Work on every subdomain, in every coordinate system, until it is valid; keep what reduces the folds.

        Where it is proved that every valid grid has a sliver, nothing is tried: mostly there is no valid grid then.
        """
        if not search.certificates:
            self._search(search)

    def _search(self, search: Search) -> None:
        tried = set()
        for layers in _LAYERS:
            for free in surroundings(search.best.coordinates, search.problem.fixed, layers):
                ends = tuple((int(where.min()) - 1, int(where.max()) + 2) for where in np.nonzero(free))
                if ends not in tried and free.sum() <= MOST_NODES:
                    tried.add(ends)
                    self._untangle(search, (slice(*ends[0]), slice(*ends[1])))

    def _untangle(self, search: Search, window: tuple[slice, slice]) -> None:
        """Untangle the nodes of one rectangle."""
        part, coordinates = restrict(search.problem, search.best.coordinates, window)
        best, free = BestSoFar(part, coordinates), part.fixed == 0
        try:
            for start in feasible_starts(coordinates, free, search.progress.deadline, self.budget):
                for frame in stretched_maps(start):
                    mapped = frame.apply(start)
                    try:
                        FoldedRegion(mapped, free).maximize(search.progress)
                    finally:  # Ctrl-C may come in the midst of a step.
                        best.offer(frame.invert(mapped, coordinates, part.fixed))
                    if not part.folds(best.coordinates, mendable=True).cells:
                        return
        finally:
            whole = search.best.coordinates.copy()
            whole[:, *window] = best.coordinates
            search.best.offer(whole)


def feasible_starts(window: Array, free: npt.NDArray[np.bool_], deadline: Deadline, budget: int) -> Iterator[Array]:
    """Return a rectangle's nodes with every free one in the middle of its feasible region, and the transfinite grid.

    There are none if its sides admit no grid whose corner Jacobians exceed the least fraction.
    """
    for fraction in _FRACTIONS:
        regions = feasible_regions(
            Grid.from_planes(*window), budget=budget, jacobian_fraction=fraction, check=deadline.check
        )
        if not isinstance(regions, Conflict):
            start = window.copy()
            for node, parts in regions.items():
                if free[node]:
                    start[:, *node] = parts[0].mean(axis=0)
            yield start
    if isinstance(regions, Conflict):  # At the least fraction, too.
        return
    xy = window.transpose(1, 2, 0)
    yield np.where(free, transfinite(xy[:, 0], xy[:, -1], xy[0], xy[-1]).planes, window)
