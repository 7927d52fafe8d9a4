"""The state of one solver's run: the present grid, and what must be reported on how it was reached."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..boundary.predicates import area_sign
from ..boundary.sides import Sides
from ..boundary.wall import NO_WALLS, Wall, asked_heights
from ..certificates import Certificate, certificates
from ..errors import UnusableValueError
from ..fields.wall_growth import wall_remarks
from ..functionals.definition import Functional
from ..grids import Change, Grid, Measures, corner_jacobians, folded_corners, quality
from ..grids.grid import boundary_indices
from .differentiability import missing_derivative, missing_value
from .multilevel.nested import Nested, worth_nesting
from .problem import Problem
from .run.progress import Progress
from .run.result import Result
from .run.status import Outcome, Status
from .untangling.strategies import SLIDING_STRATEGIES, STRATEGIES, begin_search


@dataclass(slots=True)
class Run:
    """One run of a solver that minimizes; every method leaves `coordinates` as the best grid so far.

    Attributes:
        problem: on the grid itself.
        make: binds the same functional, weight, fields and target to another grid.
        functional: what is minimized.
        parameters: of the functional.
        coordinates: (2, ni, nj).
        report: receives every step.
        start: the grid that was given.
        walls: what was asked of the four sides.
        reference: norm of the gradient at the start that was given, from which it must fall; None where that
            start was on the wrong side of the barrier.
        said: what to report before the solver's own message; None for how a folded start became valid.
        untangled_by: the name of what made a folded start valid; empty otherwise.
        proofs: that no valid grid has this boundary, or none without a sliver, where untangling could not find one;
            None as long as nothing was searched.
        explained: whether the solver's message says what is folded, and why.
        remark: what else to say of the result, with a leading blank.
    """

    problem: Problem
    make: Callable[[Grid], Problem]
    functional: Functional
    parameters: Mapping[str, float] | None
    coordinates: Array
    report: Progress
    start: Grid
    walls: Sides[Wall | None] = NO_WALLS
    reference: float | None = None
    said: str | None = None
    untangled_by: str = ""
    proofs: tuple[Certificate, ...] | None = None
    explained: bool = False
    remark: str = ""

    def renew(self, problem: Problem) -> None:
        """Take another problem on the same grid, with gradients measured as before."""
        problem.measure_as(self.problem)
        self.problem, self.reference = problem, None
        problem.refresh(self.coordinates)

    @property
    def to_untangle(self) -> bool:
        """Whether the functional has a barrier, and the grid is on its wrong side."""
        return self.problem.kernels.barrier and not self.problem.energy(self.coordinates)[1] > 0

    def start_from_coarse_grids(self) -> None:
        """Take the start from coarser grids of the same boundary, if they represent the problem and it is better.

        After an interruption the finest completed grid gives the start.
        """
        if self._encloses_nothing or not worth_nesting(self.problem, self.coordinates):
            return
        nested = Nested(self.make, self.functional, self.parameters, self.report, self.problem.slide)
        try:
            nested.solve(self.coordinates)
        finally:
            self.take(nested.finer(self.problem, self.coordinates))

    def take(self, start: Array) -> None:
        """Take another start, if it is better: less folded, or else of lower energy."""
        self.problem.follow(self.coordinates)
        energy, smallest, gradient = self.problem.energy_gradient(self.coordinates)
        barrier = self.problem.kernels.barrier
        if smallest > 0 or not barrier:
            self.reference = self.problem.norm(gradient)
        if not self.problem.exists_at(start):
            return
        self.problem.refresh(start)
        new_energy, new_smallest = self.problem.energy(start)
        if new_smallest > 0 and smallest > 0:
            better = new_energy < energy
        elif barrier or max(new_smallest, smallest) > 0:
            # On the wrong side of a barrier the energy is meaningless.
            better = self.problem.folds(start) < self.problem.folds(self.coordinates)
        else:
            better = new_energy < energy
        if better:
            self.untangled_by = NESTED if barrier and new_smallest > 0 and not smallest > 0 else ""
            self.coordinates = start
            self.problem.follow(start)
        else:
            self.problem.refresh(self.coordinates)

    def make_valid(self) -> bool:
        """Untangle, where the functional has a barrier and the grid is folded; return whether that was possible."""
        if not self.to_untangle:
            return True
        if self._encloses_nothing:
            return False
        self.report.begin("untangle", self.problem.fixed.shape)
        search = begin_search(self.problem, self.functional, self.coordinates, self.parameters, self.report)
        slides = self.problem.slide is not None
        try:
            search.run_into(self.coordinates, SLIDING_STRATEGIES if slides else STRATEGIES)
        finally:
            self.proofs, self.untangled_by = search.certificates, search.untangled_by
        self.problem.refresh(self.coordinates)
        # A grid that stays folded may be on the right side of the barrier where not all corners are summed.
        return search.valid or not self.to_untangle

    @property
    def _encloses_nothing(self) -> bool:
        """Whether the boundary's area is not positive, as where it runs clockwise: no grid is better than another."""
        ring = boundary_indices(*self.problem.fixed.shape)
        return self.to_untangle and area_sign(self.coordinates[:, ring[:, 0], ring[:, 1]].T) <= 0

    def could_not_unfold(self) -> Outcome:
        """Return how a run ends whose grid stayed folded."""
        told = "this is the start."
        if not self._encloses_nothing:
            told = f"untangling with {self.functional.name} made no more progress; this is the least folded grid found."
        self.explained = True
        if self.proofs is None:
            self.proofs = self._quick_proofs()
        proofs = _proofs_text(self.proofs)
        if self.problem.slide is not None:
            proofs = _SLIDES
        elif not any(proof.impossible for proof in self.proofs):
            proofs = f"{_NO_PROOF} {proofs}".strip()
        folds = quality(Grid.from_planes(*self.coordinates)).describe_folds()
        return Outcome(Status.FOLDED, f"{told} {folds}\n{proofs}")

    def _quick_proofs(self) -> tuple[Certificate, ...]:
        """Return proofs for the present boundary; none where its nodes slide, and others may admit a valid grid."""
        return certificates(Grid.from_planes(*self.coordinates)) if self.problem.slide is None else ()

    def explained_by_derivatives(self, outcome: Outcome) -> Outcome:
        """Return how a run has ended, with the term of the density whose derivative does not exist, if that is why."""
        if outcome.converged or self._has_derivatives(outcome.status):
            return outcome
        problem, given = self.problem, self.problem.corner_values(self.coordinates)
        energy, smallest = problem.energy(self.coordinates)
        look = missing_derivative if np.isfinite(energy) or not smallest > 0 else missing_value
        reason = look(self.functional, self.parameters, self.coordinates, problem.steps, given)
        return Outcome(Status.NOT_DIFFERENTIABLE, reason) if reason else outcome

    def _has_derivatives(self, status: Status) -> bool:
        """Whether the gradient is made of numbers, and the Hessian, too, where no step made progress."""
        if not np.isfinite(self.problem.energy_gradient(self.coordinates)[2]).all():
            return False
        return status is not Status.STALLED or bool(np.isfinite(self.problem.hessian(self.coordinates)).all())

    def result(self, outcome: Outcome) -> Result:
        """Return the result of the run, with the report on folded cells and on the weight."""
        self.problem.refresh(self.coordinates)
        energy = self.problem.energy(self.coordinates)[0]
        smallest = float(corner_jacobians(*self.coordinates).min())
        grid = Grid.from_planes(*self.coordinates)
        said = UNTANGLED.format(self.untangled_by) if self.untangled_by and self.said is None else self.said or ""
        status, message = outcome.status, said + outcome.message
        proofs: tuple[Certificate, ...] = ()
        if not smallest > 0:
            proofs = self._quick_proofs() if self.proofs is None else self.proofs
            if not status.stop_reason:
                status = Status.IMPOSSIBLE if any(proof.impossible for proof in proofs) else Status.FOLDED
            if not self.explained:
                folded = int(folded_corners(corner_jacobians(*self.coordinates)).any(axis=0).sum())
                message += (
                    f" {folded} {'cell is' if folded == 1 else 'cells are'} folded. {_proofs_text(proofs)}".rstrip()
                )
        change = self._change(grid)
        slides = self.problem.slide.caution(self.coordinates) if self.problem.slide else ""
        growth = wall_remarks(self.walls, self.coordinates)
        told = "".join(f" {one}" for one in (self.remark.strip(), *growth, change.warning) if str(one))
        remarks = self.problem.caution(self.coordinates) + slides + told
        found = Result(
            grid=grid,
            converged=outcome.converged,
            status=status,
            message=(message + remarks).strip(),
            iterations=max(len(self.report.history) - 1, 0),
            energy=energy,
            history=tuple(self.report.history),
            certificates=proofs,
            untangled_by=self.untangled_by,
            logical_area=self.problem.logical_area,
            change=change,
            wall_remarks=growth,
        )
        if smallest > 0:
            self._check_samples(found)
        return found

    def _check_samples(self, found: Result) -> None:
        """Refuse a valid result with nodes outside the samples of a field: what was minimized there is not known."""
        try:
            self.problem.check_samples(self.coordinates)
        except UnusableValueError as error:
            error.result = found  # type: ignore[attr-defined]
            error.add_note("Nodes came there on the way; the attribute 'result' of this error holds the grid.")
            raise

    def _change(self, grid: Grid) -> Change:
        """Return the measures of the start and of the grid that it became."""
        asked = asked_heights(self.walls, grid.shape)
        sizes_asked = self.problem.inputs is not None and not asked
        return Change(Measures.of(self.start, asked), Measures.of(grid, asked), sizes_asked)


#: The message where neither a valid grid nor a proof is found.
_NO_PROOF = (
    "No proof was found that there is no valid grid; certificates(grid, search=True, budget=...) searches longer. "
    "More nodes, other corners or another spacing of the boundary nodes may help."
)
#: The same where boundary nodes slide.
_SLIDES = (
    "Whether there is a valid grid with boundary nodes elsewhere on these curves is not known: more nodes, other "
    "corners or other curves may help."
)
#: The strategy that is reported if nested iteration gave a valid start.
NESTED = "nested iteration"
#: The message of a result whose start was folded.
UNTANGLED = "The grid was folded at the start and was untangled first ({}): "


def _proofs_text(proofs: tuple[Certificate, ...]) -> str:
    """Return the proofs for a boundary as a sentence; nothing where there are none."""
    return f"With this boundary {'; '.join(map(str, proofs))}." if proofs else ""
