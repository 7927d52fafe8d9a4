"""The state of a solver's run on several blocks."""

from __future__ import annotations

from dataclasses import dataclass

from ...arrays import Array
from ...certificates import certificates
from ...topology import MultiBlock
from ...topology.quality import quality
from ..harmonic import move_sides
from ..run.progress import Progress
from ..run.status import Outcome, Status
from .problem import LayoutProblem
from .result import LayoutResult

#: What made a folded start valid.
NESTED, REGULARIZED = "nested iteration", "regularized barrier at all nodes"


def begin_run(layout: MultiBlock, problem: LayoutProblem, report: Progress) -> LayoutRun:
    """Return a run that begins at a layout's own nodes, with the sliding ones on their curves; inner nodes follow."""
    start = problem.exchange.join([block.planes for block in layout.blocks])
    if problem.slide is not None:
        boundary = start.copy()
        problem.retract(boundary)
        views = problem.exchange.views(start), problem.exchange.views(boundary)
        start = problem.exchange.join([move_sides(own, moved) for own, moved in zip(*views, strict=True)])
    return LayoutRun(layout, problem, start, report)


@dataclass(slots=True)
class LayoutRun:
    """The state of a run on several blocks: the best coordinates so far, and how they were reached.

    Attributes:
        layout: that was given.
        problem: on it.
        coordinates: of all blocks, as `Exchange` joins them.
        report: receives every step.
        untangled_by: the name of what made a folded start valid; empty otherwise.
        reference: norm of the gradient at the start that was given, from which it must fall; None where that start was
            folded.
    """

    layout: MultiBlock
    problem: LayoutProblem
    coordinates: Array
    report: Progress
    untangled_by: str = ""
    reference: float | None = None

    @property
    def present(self) -> MultiBlock:
        """The layout with the nodes where they are now."""
        return self.layout.moved(self.problem.exchange.views(self.coordinates))

    def impossible(self) -> Outcome | None:
        """Return how a folded run ends if a quick proof shows that no valid grid has its outer boundary; else None."""
        if self.problem.slide is not None or not certificates(self.present):
            return None
        return Outcome(Status.IMPOSSIBLE, "untangling was not tried; this is the start.")

    def result(self, outcome: Outcome) -> LayoutResult:
        """Return the result, which reports folded cells."""
        self.problem.refresh(self.coordinates)
        self.problem.follow(self.coordinates)
        grid = self.present
        valid, status, message = not self.problem.folds(self.coordinates).cells, outcome.status, outcome.message
        if self.untangled_by:
            message = f"The grid was folded at the start and was untangled first ({self.untangled_by}): {message}"
        proofs = {} if valid or self.problem.slide is not None else certificates(grid)
        if not valid:
            if not status.stop_reason:
                status = Status.IMPOSSIBLE if proofs else Status.FOLDED
            message = f"{message} {quality(grid).describe_folds()}"
            message += "".join(f"\nBlock {name}: {one}" for name, found in proofs.items() for one in found)
        if self.problem.slide is not None:
            message += self.problem.slide.caution(self.coordinates)
        return LayoutResult(
            grid=grid,
            converged=outcome.converged and (valid or not self.problem.kernels.barrier),
            status=status,
            message=message.strip(),
            iterations=max(len(self.report.history) - 1, 0),
            energy=self.problem.energy(self.coordinates)[0],
            history=tuple(self.report.history),
            untangled_by=self.untangled_by,
            certificates=proofs,
        )

    def take(self, start: Array, *, folded: bool) -> None:
        """Take another start, if it is less folded, or of lower energy; `folded` tells whether the own start was."""
        problem = self.problem
        problem.refresh(start)
        energy, smallest = problem.energy(start)
        problem.refresh(self.coordinates)
        before, least, gradient = problem.energy_gradient(self.coordinates)
        if least > 0 or not problem.kernels.barrier:
            self.reference = problem.norm(gradient)
        if folded or not min(smallest, least) > 0:
            better = problem.folds(start) < problem.folds(self.coordinates)
        else:
            better = energy < before
        problem.follow(start if better else self.coordinates)
        if better:
            self.coordinates = start
            self.untangled_by = NESTED if folded and smallest > 0 else ""
        problem.refresh(self.coordinates)
