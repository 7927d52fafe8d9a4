"""Folds in small regions: untangle subdomains around them, each as a grid of its own with fixed sides."""

from __future__ import annotations

from dataclasses import dataclass

from ..subdomains import folded_nodes, restrict, subdomains
from .search import Search

#: Layers of nodes around folds that belong to a subdomain, at first and then.
_LAYERS = 6, 12


@dataclass(frozen=True, slots=True)
class FoldedSubdomains:
    """Untangle small subdomains of the best grid, with more layers of nodes where few did not help."""

    name: str = "regularized barrier in subdomains"

    def run(self, search: Search) -> None:
        """Untangle every subdomain around folds of the best grid."""
        for layers in _LAYERS:
            for window in subdomains(folded_nodes(search.best.coordinates, search.problem.held), layers):
                part, coordinates = restrict(search.problem, search.best.coordinates, window)
                try:
                    search.untangle_part(part, coordinates)
                finally:
                    whole = search.best.coordinates.copy()
                    whole[:, *window] = coordinates
                    search.best.offer(whole)
