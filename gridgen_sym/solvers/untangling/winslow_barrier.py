"""A functional whose own barrier is too weak: follow the barrier of Winslow's functional instead."""

from __future__ import annotations

from dataclasses import dataclass

from ...functionals.registry import functional
from .search import Search

#: Its barrier g11 + g22 over J grows like 1/J, and its minimizers are harmonic maps.
_FUNCTIONAL = "winslow"


@dataclass(frozen=True, slots=True)
class WinslowBarrier:
    """The local strategies with Winslow's functional, for a functional that is another one."""

    name: str = "regularized barrier of winslow"

    def run(self, search: Search) -> None:
        """Untangle from the start, and from the best grid if that is another one."""
        winslow = functional(_FUNCTIONAL)
        if search.functional == winslow:
            return
        for start in (search.start, search.best.coordinates):
            coordinates = start.copy()
            try:
                search.untangle_part(search.problem, coordinates, winslow)
            finally:
                search.best.offer(coordinates)
            if search.done:
                return
