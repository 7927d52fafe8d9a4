"""Names in pictures."""

from __future__ import annotations


def as_written(name: str) -> str:
    """Return a name such that Matplotlib writes it as it is: it reads formulas between dollars, and hides `_name`."""
    return (" " if name.startswith("_") else "") + name.replace("$", r"\$")
