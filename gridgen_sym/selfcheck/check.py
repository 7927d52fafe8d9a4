"""The outcome of one check, and the line that tells of it."""

from __future__ import annotations

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
    """

    name: str
    measured: float
    limit: float
    passed: bool
    text: str


def difference(name: str, measured: float, limit: float) -> Check:
    """Return a check of a relative difference; one that is not a number fails."""
    return Check(name, measured, limit, measured <= limit, f"{name}: {measured:.1e} (at most {limit:.0e})")
