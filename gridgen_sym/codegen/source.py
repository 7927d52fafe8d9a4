"""One generated file."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Source:
    """One generated file: its path below a folder such as `generated/`, and its text."""

    path: str
    text: str
