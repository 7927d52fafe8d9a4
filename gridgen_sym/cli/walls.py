"""Walls on the command line: `--wall bottom:first=1e-5,growth=1.2`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..errors import GridgenError, quoted
from ..parsing import number_in

if TYPE_CHECKING:
    from ..boundary.wall import Wall

_FORM = "write it as side:first=HEIGHT,growth=FACTOR, for example bottom:first=1e-5,growth=1.2"
#: What `--wall` says besides.
WALLS = (
    " (bottom, right, top, left): 'bottom:first=1e-5,growth=1.2', with law=geometric, tanh or sinh, "
    "layers, share, orthogonal=no and nodes=24-89; of several blocks the name of a boundary, or BLOCK/SIDE"
)
_KEYS = ("first", "growth", "law", "layers", "share", "orthogonal", "nodes")


def walls_of(texts: tuple[str, ...]) -> dict[str, Wall]:
    """Return the walls by side, or by what `walls_on` knows of several blocks.

    Args:
        texts: one for each wall: the side, and after a colon `first`, `growth`, `law`, `layers`, `share`, `orthogonal`
            (yes or no) and `nodes` (two numbers with a hyphen), as `gridgen_sym.Wall` takes them.

    Raises:
        GridgenError: for what cannot be read, or a side that comes twice.
    """
    from ..boundary.wall import Wall

    walls: dict[str, Wall] = {}
    for text in texts:
        side, colon, rest = text.partition(":")
        if not colon:
            raise GridgenError(f"the wall {quoted(text)} has no height: {_FORM}")
        if side in walls:
            raise GridgenError(f"two walls are given for the side {side}: give one")
        given: dict[str, Any] = {}
        for part in rest.split(","):
            key, equals, value = part.partition("=")
            if not equals or key.strip() not in _KEYS:
                raise GridgenError(f"{quoted(part)} in the wall {quoted(text)} is none of {', '.join(_KEYS)}: {_FORM}")
            given[key.strip()] = _value(key.strip(), value.strip(), text)
        if "first" not in given:
            raise GridgenError(f"the wall {quoted(text)} has no height: {_FORM}")
        walls[side] = Wall(**given)
    return walls


def _value(key: str, value: str, text: str) -> Any:  # noqa: ANN401 - of the kind that the key has
    """Return the value of a key."""
    if key == "law":
        return value
    if key == "orthogonal":
        if value not in ("yes", "no"):
            raise GridgenError(f"orthogonal in the wall {quoted(text)} must be yes or no; came {quoted(value)}")
        return value == "yes"
    try:
        if key == "nodes":
            begin, _, end = value.partition("-")
            return int(begin), int(end)
        return int(value) if key == "layers" else number_in(value)
    except ValueError:
        raise GridgenError(f"{key} in the wall {quoted(text)} cannot be read: {_FORM}") from None
