"""What all untangling strategies share: the protocol, the state of a search, and the loop over a list of strategies."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Protocol

from ...arrays import Array
from ...certificates import Certificate
from ...functionals.definition import Functional
from ..folds import Folds
from ..problem import Problem
from ..run.progress import Progress


class Strategy(Protocol):
    """One way from a folded grid to a valid one, or to a proof that there is none."""

    @property
    def name(self) -> str:
        """Return the name that a result reports if this strategy made the grid valid."""

    def run(self, search: Search) -> None:
        """Offer every grid that may be better to `search.best`; honor the deadline of `search.progress`."""


@dataclass(slots=True)
class BestSoFar:
    """The least folded grid so far.

    Attributes:
        problem: counts the folds.
        coordinates: (2, ni, nj).
        folds: of these coordinates.
    """

    problem: Problem
    coordinates: Array
    folds: Folds = field(init=False)

    def __post_init__(self) -> None:
        """Count the folds of the start."""
        self.folds = self.problem.folds(self.coordinates)

    def offer(self, coordinates: Array) -> None:
        """Take a copy of a grid that is less folded."""
        folds = self.problem.folds(coordinates)
        if folds < self.folds:
            self.coordinates, self.folds = coordinates.copy(), folds


@dataclass(slots=True)
class Search:
    """The state of one search for a valid grid with given boundary nodes.

    Attributes:
        problem: on the grid.
        functional: whose regularized barrier is followed.
        parameters: of the functional.
        progress: records every step, and holds the deadline.
        start: (2, ni, nj), not changed.
        local: strategies for a subdomain or a coarse grid, which are searches of their own.
        best: the least folded grid so far.
        certificates: proofs that no valid grid has this boundary, or none without a sliver; None before any search.
        untangled_by: the strategy that made the grid valid; empty before.
    """

    problem: Problem
    functional: Functional
    parameters: Mapping[str, float] | None
    progress: Progress
    start: Array
    local: tuple[Strategy, ...]
    best: BestSoFar = field(init=False)
    certificates: tuple[Certificate, ...] | None = None
    untangled_by: str = ""

    def __post_init__(self) -> None:
        """Begin with the start as the best grid."""
        self.best = BestSoFar(self.problem, self.start)

    @property
    def done(self) -> bool:
        """Whether no cell is left that moving free nodes may repair, or it is proved that none can be mended."""
        if any(proof.impossible for proof in self.certificates or ()):
            return True
        return not self.problem.folds(self.best.coordinates, mendable=True).cells

    @property
    def valid(self) -> bool:
        """Whether every corner's Jacobian is positive in the best grid."""
        return self.best.folds.cells == 0

    def run(self, strategies: Iterable[Strategy]) -> None:
        """Try strategies in turn until the search is done."""
        for strategy in strategies:
            if self.done:
                break
            strategy.run(self)
            if self.valid:
                self.untangled_by = strategy.name

    def untangle_part(
        self,
        problem: Problem,
        coordinates: Array,
        functional: Functional | None = None,
    ) -> bool:
        """Untangle a subdomain or a coarse grid by the local strategies, in place; return whether it is valid.

        Args:
            problem: on the part.
            coordinates: (2, ni, nj); the least folded grid is left there, whatever ends the search.
            functional: whose barrier is followed instead of the search's own, with its default parameters.
        """
        parameters = self.parameters if functional is None else None
        part = Search(problem, functional or self.functional, parameters, self.progress, coordinates.copy(), self.local)
        return part.run_into(coordinates, self.local)

    def run_into(self, coordinates: Array, strategies: Iterable[Strategy]) -> bool:
        """Try strategies in turn and leave the best grid in `coordinates`, whatever ends it; return whether valid."""
        try:
            self.run(strategies)
        finally:
            coordinates[...] = self.best.coordinates
        return self.valid
