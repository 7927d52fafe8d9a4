"""The outcome of one check, and the line that reports it."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Check:
    """The outcome of one check.

    Attributes:
        name: what was compared.
        measured: the number that decides: a relative difference, or an order of convergence.
        limit: what it must not exceed, or must reach.
        passed: whether it does.
        text: one line.
        vacuous: whether it passed because both sides are zero wherever they were compared, which proves little.
    """

    name: str
    measured: float
    limit: float
    passed: bool
    text: str
    vacuous: bool = False

    @property
    def word(self) -> str:
        """The outcome in one word: `ok`, `vacuous` or `FAILED`."""
        return "FAILED" if not self.passed else "vacuous" if self.vacuous else "ok"


def difference(name: str, measured: float, limit: float) -> Check:
    """Return a check of a relative difference; one that is not finite fails."""
    if not math.isfinite(measured):
        return Check(name, measured, limit, False, f"{name}: not finite")
    return Check(name, measured, limit, measured <= limit, f"{name}: {measured:.1e} (at most {limit:.0e})")


def both_zero(name: str, limit: float) -> Check:
    """Return a check of zero against zero: nothing speaks against it, and little for it."""
    return Check(name, 0.0, limit, True, f"{name}: both are zero at all points that were tried", vacuous=True)


def failure(name: str, limit: float, reason: str) -> Check:
    """Return a check that failed for another reason than its number."""
    return Check(name, math.nan, limit, False, f"{name}: {reason}")
