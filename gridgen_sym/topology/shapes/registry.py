"""The table of shapes: makers of layouts by name, whose parameters are checked."""

from __future__ import annotations

import difflib
import inspect
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...errors import GridgenError, quoted
from ..multiblock import MultiBlock

#: The fewest cells that a parameter may ask for.
_FEWEST = 2


@dataclass(frozen=True, slots=True)
class _Shape:
    """An entry of the table: what it is, and its maker, whose parameters all have defaults."""

    description: str
    maker: Callable[..., MultiBlock]


_SHAPES: dict[str, _Shape] = {}


def layout_names() -> list[str]:
    """Return the names of all shapes that `layout` makes, sorted."""
    return sorted(_SHAPES)


def layout_description(name: str) -> str:
    """Return one line about the shape `name`.

    Raises:
        GridgenError: if no shape has this name.
    """
    return _find(name).description


def layout(name: str, **parameters: Any) -> MultiBlock:  # noqa: ANN401 - numbers, or a section
    """Return the start of a layout: blocks by transfinite interpolation, connected, with names of their boundaries.

    Interfaces and cuts are straight where nothing is known of them: a solver makes them smooth, since their nodes move
    like inner ones.

    Args:
        name: one of `layout_names()`.
        **parameters: what the shape takes: lengths, angles in degrees, numbers of cells, such as ``radius=2.0`` and
            ``across=16`` of 'pipe'.

    Raises:
        GridgenError: for an unknown name (with the closest ones), a parameter that the shape has not, or values that
            have no meaning.
    """
    shape = _find(name)
    known = inspect.signature(shape.maker, eval_str=True).parameters
    for key, value in parameters.items():
        if key not in known:
            raise GridgenError(f"the layout '{name}' has no parameter '{key}'; it takes: {', '.join(known)}")
        parameters[key] = _checked(name, key, value, known[key].annotation)
    return shape.maker(**parameters)


def shape(description: str) -> Callable[[Callable[..., MultiBlock]], Callable[..., MultiBlock]]:
    """Register the decorated maker of a layout under its own name.

    Its parameters of the type `int` are numbers of cells, those of `float` finite numbers.
    """

    def register(maker: Callable[..., MultiBlock]) -> Callable[..., MultiBlock]:
        _SHAPES[maker.__name__] = _Shape(description, maker)
        return maker

    return register


def require(name: str, **conditions: bool) -> None:
    """Refuse parameters whose conditions do not hold.

    Args:
        name: of the shape.
        **conditions: for each parameter whether its value has a meaning.
    """
    for key, holds in conditions.items():
        if not holds:
            maker = _SHAPES[name].maker
            lines = (line.strip().partition(f"{key}: ") for line in (maker.__doc__ or "").splitlines())
            meaning = next(rest for before, found, rest in lines if found and not before)
            raise GridgenError(f"the parameter {key} of the layout '{name}' does not fit: {meaning}")


def _checked(name: str, key: str, value: object, kind: object) -> object:
    """Return the value of a parameter."""
    if kind is int:
        if not isinstance(value, int | np.integer) or isinstance(value, bool) or value < _FEWEST:
            raise GridgenError(
                f"the parameter {key} of the layout '{name}' must be a whole number of cells, at least {_FEWEST}; came "
                f"{quoted(value)}"
            )
        return int(value)
    if kind is float:
        number = np.asarray(value)
        if number.shape != () or number.dtype.kind not in "iuf" or not np.isfinite(number):
            raise GridgenError(
                f"the parameter {key} of the layout '{name}' must be a finite number; came {quoted(value)}"
            )
        return float(number)
    return value


def _find(name: str) -> _Shape:
    """Return the entry of the table, or raise an error with the closest names."""
    if isinstance(name, str) and name in _SHAPES:
        return _SHAPES[name]
    close = difflib.get_close_matches(str(name), _SHAPES, n=3, cutoff=0.4)
    hint = f"did you mean {' or '.join(repr(c) for c in close)}? " if close else ""
    raise GridgenError(f"no layout is called {quoted(name)}: {hint}Known: {', '.join(layout_names())}")
