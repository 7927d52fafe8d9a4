"""Follow a regularized barrier at all nodes in stretched coordinates, in which its minima are other grids."""

from __future__ import annotations

from dataclasses import dataclass

from ...functionals.registry import functional
from .affine_maps import stretched_maps
from .regularization import FAST, Pace, follow, global_newton
from .search import Search


@dataclass(frozen=True, slots=True)
class StretchedCoordinates:
    """Newton's method on all nodes in coordinates that are stretched in several directions.

    Attributes:
        most_nodes: grids with more nodes are left to other strategies.
        functional: name of the functional whose barrier is followed; None for that of the search.
        pace: how fast epsilon falls.
    """

    most_nodes: int
    functional: str | None = None
    pace: Pace = FAST
    name: str = "regularized barrier in stretched coordinates"

    def run(self, search: Search) -> None:
        """Follow the minima from the start in each coordinate system until the grid is valid."""
        if search.problem.fixed.size > self.most_nodes:
            return
        lower = global_newton(search.problem, search.progress)
        chosen = None if self.functional is None else functional(self.functional)
        for frame in stretched_maps(search.start):
            follow(search, frame, lower, chosen, self.pace)
            if search.done:
                return
