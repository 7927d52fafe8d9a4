"""Searches for a proof that untangling is in vain, as entries of the list of strategies."""

from __future__ import annotations

from dataclasses import dataclass

from ...certificates import certificates, sliver_certificate
from ...grids import Grid
from .search import Search


@dataclass(frozen=True, slots=True)
class QuickProofs:
    """Look for the proofs that need no search."""

    name: str = "quick proofs"

    def run(self, search: Search) -> None:
        """End the search if the boundary has no valid grid."""
        found = certificates(Grid.from_planes(*search.best.coordinates))
        if any(proof.impossible for proof in found):
            search.certificates = found


@dataclass(frozen=True, slots=True)
class ProofSearch:
    """Search for a proof that no valid grid has this boundary.

    Attributes:
        budget: rules that one attempt may use.
    """

    budget: int
    name: str = "search for a proof"

    def run(self, search: Search) -> None:
        """Search; a proof that was known before stays if none is found."""
        search.progress.display("searching for a proof that there is no valid grid")
        grid = Grid.from_planes(*search.best.coordinates)
        found = certificates(grid, search=True, budget=self.budget, check=search.progress.deadline.check)
        search.certificates = found or search.certificates or ()


@dataclass(frozen=True, slots=True)
class SliverSearch:
    """Search for the proof that every valid grid has a nearly folded or small cell, unless that is proved.

    Attributes:
        budget: rules that one attempt may use.
    """

    budget: int
    name: str = "search for the proof of a sliver"

    def run(self, search: Search) -> None:
        """Search, where nothing is proved yet."""
        if search.certificates:
            return
        search.progress.display("searching for a proof that every valid grid has a nearly folded or small cell")
        grid = Grid.from_planes(*search.best.coordinates)
        sliver = sliver_certificate(grid, budget=self.budget, check=search.progress.deadline.check)
        search.certificates = (sliver,) if sliver else ()
