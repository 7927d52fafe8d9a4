"""Follow the regularized barrier at all nodes, by Newton's method."""

from __future__ import annotations

from dataclasses import dataclass

from .affine_maps import balanced_maps
from .regularization import follow, global_newton
from .search import Search


@dataclass(frozen=True, slots=True)
class AllNodes:
    """Newton's method on all nodes, and for a thin boundary again in coordinates with equal extents."""

    name: str = "regularized barrier at all nodes"

    def run(self, search: Search) -> None:
        """Follow the minima from the start in each coordinate system until the grid is valid."""
        lower = global_newton(search.problem, search.progress)
        for frame in balanced_maps(search.start):
            follow(search, frame, lower)
            if search.done:
                break
