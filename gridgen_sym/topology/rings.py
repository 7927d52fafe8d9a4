"""The sides of a block of a layout as curves that are walked forwards or backwards, so that they join to a ring."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import NamedTuple

from ..boundary.sides import Sides
from ..errors import GridgenError, quoted

#: The two ends of every curve, by the names of points.
Ends = Mapping[str, tuple[str, str]]
#: What a user may say of a block: four points, or four sides, each a curve or several.
BlockLike = Sequence[str | Sequence[str]]


class Use(NamedTuple):
    """A curve in a side: its name, and whether it is walked from its first end to its second."""

    curve: str
    forwards: bool


def rings(block: str, sides: Sequence[Sequence[str]], ends: Ends) -> list[Sides[tuple[Use, ...]]]:
    """Return how the sides of a block are walked, as those of a grid run: bottom and top along xi, others along eta.

    There are several ways only where a side is closed, as round an O-grid.

    Args:
        block: its name, for messages.
        sides: the curves of bottom, right, top and left, which follow each other round the block; those of one side in
            either order.
        ends: of all curves.

    Raises:
        GridgenError: for sides that do not join.
    """
    walks = [list(_walks(side, ends)) for side in sides]
    for name, side, found in zip(Sides._fields, sides, walks, strict=True):
        if not found:
            told = ", ".join(f"{curve} ({' to '.join(ends[curve])})" for curve in side)
            raise GridgenError(f"the curves of {name} of block {block} do not follow each other: {told}")
    ways = []
    for walked in product(*walks):
        (a, b), (c, d), (e, f), (g, h) = (_ends(walk, ends) for walk in walked)
        if b == c and d == f and e == h and g == a:
            ways.append(Sides(*walked))
    if ways:
        return ways
    told = "; ".join(
        f"{name}: {' to '.join(_ends(found[0], ends))}" for name, found in zip(Sides._fields, walks, strict=True)
    )
    raise GridgenError(
        f"the sides of block {block} do not join: {told}. Give the curves of bottom, right, top and left in this "
        "order, each of which begins where the one before ends"
    )


def side_lists(block: str, given: object, points: Sequence[str]) -> list[list[str]]:
    """Return the names of the curves of the four sides of a block, from what a user says.

    Between two points a curve has the name `A-B`, whether it is drawn or not.

    Raises:
        GridgenError: for what are not four points or four sides.
    """
    if isinstance(given, str) or not isinstance(given, Sequence) or len(given) != 4:
        raise GridgenError(
            f"block {block} must be four points, counter-clockwise, or the curves of bottom, right, top and left; came "
            f"{quoted(given)}"
        )
    if all(isinstance(item, str) and item in points for item in given):
        return [[f"{a}-{b}"] for a, b in zip(given, [*given[1:], given[0]], strict=True)]
    sides = [[item] if isinstance(item, str) else item for item in given]
    for side in sides:
        if not isinstance(side, Sequence) or not side or not all(isinstance(name, str) for name in side):
            raise GridgenError(f"a side of block {block} must be a curve, or a list of curves; came {quoted(side)}")
    return [list(side) for side in sides]


def _walks(side: Sequence[str], ends: Ends) -> Iterator[tuple[Use, ...]]:
    """Yield the ways to walk curves, in their order or against it, of which each begins where the one before ends."""
    for order in (side, side[::-1]) if len(side) > 1 else (side,):
        for first in (True, False):
            way = [Use(order[0], first)]
            for curve in order[1:]:
                at = _ends(way, ends)[1]
                if at not in ends[curve]:
                    break
                way.append(Use(curve, ends[curve][0] == at))
            else:
                yield tuple(way)


def _ends(walk: Sequence[Use], ends: Ends) -> tuple[str, str]:
    """Return the points that a walk leads from and to."""
    first, last = walk[0], walk[-1]
    return ends[first.curve][not first.forwards], ends[last.curve][last.forwards]
