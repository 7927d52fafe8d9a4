"""Follow the barrier of another functional, where the functional's own is too weak or leads to a fold that stays."""

from __future__ import annotations

from dataclasses import dataclass

from ...functionals.registry import functional
from .search import Search


@dataclass(frozen=True, slots=True)
class OtherBarriers:
    """The local strategies with the barriers of other functionals, in turn.

    Attributes:
        functionals: their names; that of the search itself is left out.
        most_nodes: grids with more nodes are left to other strategies; None for any grid.
    """

    functionals: tuple[str, ...]
    most_nodes: int | None = None
    name: str = "regularized barrier of another functional"

    def run(self, search: Search) -> None:
        """Untangle from the start with each functional until the grid is valid."""
        if self.most_nodes is not None and search.problem.fixed.size > self.most_nodes:
            return
        for other in map(functional, self.functionals):
            if other == search.functional:
                continue
            coordinates = search.start.copy()
            try:
                search.untangle_part(search.problem, coordinates, other)
            finally:
                search.best.offer(coordinates)
            if search.done:
                return
