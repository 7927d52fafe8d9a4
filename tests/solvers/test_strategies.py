"""The last strategies and the searches for proofs: in which order, and what is reported if one is stopped."""

from __future__ import annotations

import pytest
from support_boundaries import grid_of_ring, smooth_curve

import gridgen_sym as gg
from gridgen_sym.certificates.branching import DEFAULT_BUDGET, LARGE_BUDGET
from gridgen_sym.solvers.binding import make_problem
from gridgen_sym.solvers.run.deadline import StopRequest
from gridgen_sym.solvers.run.progress import Progress
from gridgen_sym.solvers.run.status import StopReason
from gridgen_sym.solvers.untangling import proofs
from gridgen_sym.solvers.untangling.all_nodes import AllNodes
from gridgen_sym.solvers.untangling.coarse_grids import CoarseGrids
from gridgen_sym.solvers.untangling.feasible_starts import FeasibleStarts
from gridgen_sym.solvers.untangling.other_barriers import OtherBarriers
from gridgen_sym.solvers.untangling.strategies import begin_search

SLIVER, CONFLICT = (gg.Certificate(kind, (), (0.0, 0.0), {}, f"a {kind}") for kind in ("sliver", "conflict"))


@pytest.fixture
def stages(monkeypatch):
    """Have a stage do what is given for it, or find nothing; a list of the stages that were reached.

    Searches ask for the time, which is never over.
    """
    seen = []

    def prepare(does):
        def reach(stage, budget, nothing):
            seen.append(f"{'short' if budget == DEFAULT_BUDGET else 'long'} {stage}")
            outcome = does.get(seen[-1], nothing)
            if isinstance(outcome, BaseException):
                raise outcome
            return outcome

        def certificates(grid, *, search=False, budget=LARGE_BUDGET, check=None):
            return reach("search", budget, ()) if search and check() else ()

        monkeypatch.setattr(proofs, "certificates", certificates)
        monkeypatch.setattr(
            proofs, "sliver_certificate", lambda grid, *, budget, check: check() and reach("sliver", budget, None)
        )
        monkeypatch.setattr(CoarseGrids, "run", lambda self, search: None)
        monkeypatch.setattr(FeasibleStarts, "_search", lambda self, search: reach("starts", self.budget, None))
        return seen

    return prepare


def folded_start():
    """A boundary of which no grid is valid: all stages are reached."""
    return grid_of_ring(smooth_curve(3211, 12, 0.6), 5, 3)


SHORT, LONG = ["short search", "short starts", "short sliver"], ["long starts", "long search", "long sliver"]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("does", "reached", "found"),
    [
        ({}, SHORT + LONG, ()),
        ({"short search": (CONFLICT,)}, SHORT[:1], (CONFLICT,)),
        ({"short sliver": SLIVER}, [*SHORT, "long search"], (SLIVER,)),
        ({"short sliver": SLIVER, "long search": (CONFLICT,)}, [*SHORT, "long search"], (CONFLICT,)),
        ({"long search": (CONFLICT,)}, SHORT + LONG[:2], (CONFLICT,)),
        ({"long sliver": SLIVER}, SHORT + LONG, (SLIVER,)),
    ],
)
def test_no_stage_is_reached_in_vain_and_the_best_proof_is_told(stages, does, reached, found):
    seen = stages(does)
    result = gg.untangle(folded_start())
    assert seen == reached
    assert result.certificates == found
    assert result.stopped_by is None
    assert ("No proof was found" in result.message) == (CONFLICT not in found)
    assert result.message.count("folded (J <= 0") == 1
    for proof in (SLIVER, CONFLICT):
        assert result.message.count(str(proof)) == (proof in found)


@pytest.mark.slow
@pytest.mark.parametrize("stage", SHORT + LONG)
@pytest.mark.parametrize("error", [KeyboardInterrupt(), StopRequest(StopReason.TIME_LIMIT, "it is over")], ids=str)
def test_whatever_is_stopped_tells_once_what_is_folded_and_what_is_proved(stages, stage, error):
    first = {"short sliver": SLIVER} if stage == "long search" else {}
    seen = stages({**first, stage: error})
    start = folded_start()
    result = gg.untangle(start)
    assert seen[-1] == stage
    assert result.interrupted
    assert not result.converged
    folded = result.quality.folded_cells
    assert 0 < folded <= gg.quality(start).folded_cells
    count = "1 cell is" if folded == 1 else f"{folded} cells are"
    assert result.message.count("folded") == result.message.count(f" {count} folded.") == 1
    assert result.certificates == tuple(first.values())
    assert result.message.count("a sliver") == len(first)


@pytest.mark.slow
def test_a_barrier_that_is_too_weak_falls_back_on_winslows():
    """By itself this barrier leaves folds in the swan."""
    mu = 1e-3
    weak = gg.define("weak", "(g11 + g22) - mu*log(J)", parameters={"mu": 1.0}, constraints=("mu > 0",))
    start = gg.domain("swan", 33, 33)
    result = gg.optimize(start, weak, parameters={"mu": mu})
    assert result.quality.valid
    assert result.untangled_by
    assert f"untangled first ({result.untangled_by})" in result.message
    problem = make_problem(start, weak, parameters={"mu": mu})
    search = begin_search(problem, weak, start.planes, {"mu": mu}, Progress("weak", show=False))
    search.run([AllNodes()])
    assert not search.valid
    fallback = OtherBarriers(("winslow",))
    search.run([fallback])
    assert search.valid
    assert search.untangled_by == fallback.name
