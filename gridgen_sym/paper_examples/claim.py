"""What the paper says of an example, and whether the numbers bear it out: decided here, not typed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from ..grids import Quality
from .case import Case

Verdict = Literal["holds", "holds in part", "does not hold here"]

#: What makes a valid grid a good one: the measure's name, its value, and whether more of it is better.
MEASURES: tuple[tuple[str, Callable[[Quality], float], bool], ...] = (
    ("smallest J / mean J", lambda q: q.min_jacobian / q.mean_jacobian, True),
    ("smallest scaled J", lambda q: q.min_scaled_jacobian, True),
    ("mean K", lambda q: q.mean_condition, False),
    ("largest area ratio of neighbors", lambda q: q.max_area_ratio, False),
)
_ALIKE = 0.01  # Measures that differ by less, relative to each other, are left out.


@dataclass(frozen=True, slots=True)
class Claim:
    """One claim.

    Attributes:
        paper: the paper's claim, in one sentence, or one that stands beside it and says that it is not the paper's.
        measured: what was measured, in one sentence.
        verdict: whether the numbers bear the claim out.
    """

    paper: str
    measured: str
    verdict: Verdict


def decide(paper: str, *found: tuple[str, bool]) -> Claim:
    """Return a claim decided by its conditions: each a measured sentence, and whether it speaks for the claim."""
    speaks = [holds for _, holds in found]
    verdict: Verdict = "holds" if all(speaks) else "holds in part" if any(speaks) else "does not hold here"
    return Claim(paper, "; ".join(text for text, _ in found), verdict)


def better(case: Case, than: Case) -> list[tuple[str, bool]]:
    """Return, measure by measure, whether a grid is better than another; measures that are alike are left out.

    A valid grid is better than a folded one, whatever else is measured of the two.
    """
    ours, theirs = case.quality, than.quality
    found = []
    if ours.valid != theirs.valid:
        found = [(f"{ours.folded_cells} folded cells to {theirs.folded_cells}", ours.valid)]
    for name, measure, more in MEASURES if not found else ():
        a, b = measure(ours), measure(theirs)
        if abs(a - b) > _ALIKE * max(abs(a), abs(b)):
            wins = (a > b) == more
            found.append((f"{name} {a:.3g} to {b:.3g} ({'better' if wins else 'worse'})", wins))
    (first, wins), *rest = found or [("alike in every measure", False)]
    return [(f"{case.label} against {than.label}: {first}", wins), *rest]
