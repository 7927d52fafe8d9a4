"""Boundary nodes of a side, placed along its arc by a spacing law."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from ..arrays import Array, real_array
from ..errors import GridgenError, quoted
from ..parsing import number_in
from .laws import geometric, hyperbolic_sine, hyperbolic_tangent, two_ended
from .sides import Sides

#: How the nodes of a side are placed: a law as text, or the fractions of its length at the nodes.
SideSpacing: TypeAlias = "str | npt.ArrayLike"

_LAWS = {"geometric": geometric, "tanh": hyperbolic_tangent, "sinh": hyperbolic_sine}
_KEYS = ("first", "last", "at", "size")
_FORM = (
    "write it as LAW:first=LENGTH,last=LENGTH with geometric, tanh or sinh, LAW:at=FRACTION,size=LENGTH or 'equal', "
    "for example 'tanh:first=1e-3'"
)


def spacings_by_side(spacing: object) -> Sides[SideSpacing | None]:
    """Return the spacing of every side, None where nothing is said.

    Raises:
        GridgenError: for what is no mapping from sides.
    """
    if not isinstance(spacing, Mapping):
        raise GridgenError(
            f"spacing must map sides to laws, such as {{'bottom': 'tanh:first=1e-3'}}; came {quoted(spacing)}"
        )
    for side in spacing:
        if side not in Sides._fields:
            raise GridgenError(f"unknown side {quoted(side)} in spacing: the sides are {', '.join(Sides._fields)}")
    return Sides(*(spacing.get(side) for side in Sides._fields))


def spaced(line: Array, count: int, spacing: SideSpacing) -> Array:
    """Return `count` points on a polyline (n, 2), placed along its arc by a law; its ends are kept exactly.

    Args:
        line: the side.
        count: number of nodes.
        spacing: `"LAW:first=LENGTH"`, `"LAW:last=LENGTH"` or both, where LAW is `geometric`, `tanh` or `sinh` (with
            both it is Vinokur's, whatever is said) and lengths are those of the first and the last cell along the arc;
            `"LAW:at=FRACTION,size=LENGTH"`: cells of this length at a fraction of the arc, growing to both ends;
            `"equal"`; or an array (count,) of fractions of the length, from 0 to 1.

    Raises:
        GridgenError: for what is none of these, or lengths that have no place on the side.
    """
    arc = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))))
    fractions = fractions_of(spacing, float(arc[-1]), count)
    nodes = np.stack([np.interp(fractions * arc[-1], arc, line[:, axis]) for axis in (0, 1)], axis=-1)
    nodes[0], nodes[-1] = line[0], line[-1]
    return nodes


def fractions_of(spacing: SideSpacing, length: float, count: int) -> Array:
    """Return the fractions of a side's length at its nodes, (count,); see `spaced`."""
    if isinstance(spacing, str):
        return _law(spacing, length, count - 1)
    given = real_array(spacing, "the spacing of a side")
    if given.shape != (count,) or not (given[0] == 0 and given[-1] == 1 and (np.diff(given) > 0).all()):
        raise GridgenError(
            f"the spacing of a side of {count} nodes must be {count} fractions that rise from 0 to 1; came an array of "
            f"shape {given.shape}"
        )
    return given


def _law(text: str, length: float, cells: int) -> Array:
    """Return the fractions that a law in text gives."""
    name, _, rest = text.partition(":")
    if name == "equal" and not rest:
        return np.linspace(0, 1, cells + 1)
    if name not in _LAWS:
        raise GridgenError(f"unknown law {quoted(name)} in the spacing {quoted(text)}: {_FORM}")
    given = _numbers(text, rest)
    if given.keys() == {"at", "size"}:
        return _clustered(name, given["at"], given["size"] / length, cells, text)
    first, last = (given[key] / length if key in given else None for key in ("first", "last"))
    if not given or given.keys() - {"first", "last"}:
        raise GridgenError(f"the spacing {quoted(text)} has no length: {_FORM}")
    if first is not None and last is not None:
        return np.asarray(two_ended(first, last, cells)[0])
    if first is not None:
        return np.asarray(_LAWS[name](first, cells)[0])
    assert last is not None
    return np.asarray(1 - _LAWS[name](last, cells)[0][::-1])


def _numbers(text: str, rest: str) -> dict[str, float]:
    given: dict[str, float] = {}
    for part in rest.split(",") if rest else ():
        key, equals, value = part.partition("=")
        if not equals or key.strip() not in _KEYS:
            raise GridgenError(f"{quoted(part)} in the spacing {quoted(text)} is none of {', '.join(_KEYS)}: {_FORM}")
        try:
            given[key.strip()] = number_in(value)
        except ValueError:
            raise GridgenError(f"{key.strip()} in the spacing {quoted(text)} is no number: {_FORM}") from None
    return given


def _clustered(name: str, at: float, size: float, cells: int, text: str) -> Array:
    """Return fractions with cells of one size at a fraction of the side, in two pieces that meet there."""
    before = round(cells * at)
    if not (0 < at < 1 and 2 <= before <= cells - 2):
        raise GridgenError(
            f"at in the spacing {quoted(text)} must be a fraction of the side with at least 2 cells on both sides of it"
        )
    left = 1 - _LAWS[name](size / at, before)[0][::-1]
    right = _LAWS[name](size / (1 - at), cells - before)[0]
    return np.concatenate((at * left, at + (1 - at) * right[1:]))
