"""The walls of a layout's description: what is asked of the cells at its boundaries."""

from __future__ import annotations

from collections.abc import Container
from typing import Any

from ..boundary.wall import Wall
from ..errors import GridgenError, quoted
from .values import check_keys

#: What a wall on a boundary takes: a boundary has its own nodes.
_KEYS = ("first", "growth", "law", "layers", "share", "orthogonal")


def described_walls(given: dict[str, Any], boundaries: Container[str]) -> dict[str, Wall]:
    """Return the walls of the table `walls` by the names of boundaries.

    Args:
        given: the table.
        boundaries: the names that the table `boundaries` has.

    Raises:
        GridgenError: for an unknown boundary, and for what is no wall; the boundary is named.
    """
    found = {}
    for name, one in given.items():
        if name not in boundaries:
            raise GridgenError(f"unknown boundary {quoted(name)} in walls: a wall has the name of one of boundaries")
        check_keys(one, _KEYS, f"the wall {name}", required=("first",))
        try:
            found[name] = Wall(**one)
        except GridgenError as error:
            raise GridgenError(f"the wall {name}: {error}") from error
    return found
