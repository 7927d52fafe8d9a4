"""Untangle with boundary nodes that stay, although they might slide: where that succeeds, least is changed."""

from __future__ import annotations

from dataclasses import dataclass, replace

from .search import Search


@dataclass(frozen=True, slots=True)
class FixedBoundary:
    """Follow the regularized barrier with the boundary nodes where they are."""

    name: str = "regularized barrier"

    def run(self, search: Search) -> None:
        """Untangle the best grid by the local strategies."""
        coordinates = search.best.coordinates.copy()
        try:
            search.untangle_part(replace(search.problem, slide=None), coordinates)
        finally:
            search.best.offer(coordinates)
