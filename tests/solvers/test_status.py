"""How a run has ended, as a value: every way to end is reached, and says so."""

from __future__ import annotations

from pathlib import Path

import pytest

import gridgen_sym as gg
from gridgen_sym.solvers.run.status import Status, StopReason

SQUARE = gg.domain("square", 9, 9)
SWAN = gg.domain("swan", 17, 17)


def turned_corner():
    """A boundary whose corner turns the wrong way: no valid grid has it, and a certificate says so."""
    xy = gg.domain("square", 9, 9).xy
    xy[0, 0] = 0.3, 0.3
    return gg.Grid(xy)


def stop(step):
    raise StopIteration


def interrupt(step):
    raise KeyboardInterrupt


@pytest.mark.parametrize(
    ("status", "solve"),
    [
        (Status.CONVERGED, lambda: gg.optimize(SWAN, "winslow")),
        (Status.CONVERGED, lambda: gg.optimize(SWAN, "winslow", "local")),
        (Status.CONVERGED, lambda: gg.untangle(SWAN)),
        (Status.CONVERGED, lambda: gg.solve_euler_lagrange(SWAN, "winslow")),
        (Status.ITERATION_LIMIT, lambda: gg.optimize(gg.domain("wavy", 9, 9), "winslow", max_iterations=1)),
        (Status.ITERATION_LIMIT, lambda: gg.optimize(gg.domain("wavy", 9, 9), "winslow", "local", max_iterations=1)),
        (Status.ITERATION_LIMIT, lambda: gg.solve_euler_lagrange(gg.domain("wavy", 9, 9), "liao", max_iterations=1)),
        (Status.HELD_BACK, lambda: gg.optimize(gg.domain("horseshoe", 17, 17), "length")),
        (Status.FOLDED, lambda: gg.optimize(gg.domain("horseshoe", 17, 17), "length", keep_valid=False)),
        (Status.IMPOSSIBLE, lambda: gg.optimize(turned_corner(), "winslow")),
        (Status.IMPOSSIBLE, lambda: gg.untangle(turned_corner())),
        (Status.STOPPED_BY_CALLBACK, lambda: gg.optimize(SWAN, "winslow", callback=stop)),
        (Status.STOPPED_BY_USER, lambda: gg.optimize(SWAN, "winslow", callback=interrupt)),
        (Status.STOPPED_BY_TIME_LIMIT, lambda: gg.optimize(SWAN, "winslow", time_limit=1e-9)),
    ],
)
def test_a_result_has_the_status_of_its_run(status, solve):
    result = solve()
    assert result.status is status
    assert (status is Status.CONVERGED) <= result.converged
    assert (result.stopped_by is not None) == status.name.startswith("STOPPED")
    folded = result.quality.folded_cells > 0
    assert folded == (status in (Status.FOLDED, Status.IMPOSSIBLE)) or result.interrupted


def test_a_reason_equals_its_text_and_is_that_of_its_status():
    for reason in StopReason:
        assert Status.stopped(reason).stop_reason is reason
    assert [*StopReason] == ["Ctrl-C", "time limit", "callback", "error"]
    assert Status.CONVERGED.stop_reason is None


def test_every_status_is_a_sentence_of_its_own():
    sentences = [status.value for status in Status]
    assert len(set(sentences)) == len(sentences)
    assert all(sentence[0].isupper() and sentence.endswith(".") for sentence in sentences)


def test_the_page_on_results_has_every_status():
    page = Path(__file__).resolve().parents[2] / "docs" / "explanations" / "results.md"
    text = page.read_text(encoding="utf-8")
    assert [status.name for status in Status if f"| `{status.name}` | {status.value} |" not in text] == []
