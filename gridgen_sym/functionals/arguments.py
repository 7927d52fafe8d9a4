"""What `define` accepts: names, parameters and their defaults; anything else is refused with the repair."""

from __future__ import annotations

import inspect
import keyword
import operator
import re
from collections.abc import Callable, Mapping
from numbers import Real
from typing import Any, SupportsIndex

from ..errors import GridgenError, quoted
from .expression import name_instead_of
from .field_kinds import KINDS, LOGICAL_SUFFIXES, PHYSICAL_SUFFIXES, components
from .metric import RESERVED_NAMES

_NAME = re.compile(r"[a-z][a-z0-9_]*")
_PARAMETER = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_LONGEST_NAME = 64  # Names of files and of C functions are made of it.
_LARGEST_FACTOR = 1000
_LONGEST_FIELD = 32


def check_arguments(name: object, density: object, constraints: object, factor: object, description: object) -> None:
    """Refuse arguments of `define` that are not of their kind."""
    if isinstance(name, str) and keyword.iskeyword(name):
        raise GridgenError(f"{name!r} cannot name a functional: it is a word of Python; write {name_instead_of(name)}")
    if not isinstance(name, str) or not _NAME.fullmatch(name):
        raise GridgenError(
            f"{quoted(name)} cannot name a functional: use lower-case letters, digits and _, as in 'my_winslow'"
        )
    if len(name) > _LONGEST_NAME:
        raise GridgenError(
            f"the name {name[:20] + '...'!r} of a functional has {len(name)} letters: use at most {_LONGEST_NAME}"
        )
    if not (isinstance(density, str) or callable(density)):
        raise GridgenError(
            f"the density of functional {name!r} must be a function of the metric m, or text such as "
            f"'(g11 + g22)/J'; came {quoted(density)}"
        )
    if not (isinstance(constraints, (tuple, list)) and all(isinstance(one, str) for one in constraints)):
        raise GridgenError(
            f"constraints of functional {name!r} must be a tuple of comparisons, such as ('k >= 0',); "
            f"came {quoted(constraints)}"
        )
    whole = isinstance(factor, SupportsIndex) and not isinstance(factor, bool)
    if not (whole and 1 <= operator.index(factor) <= _LARGEST_FACTOR):  # type: ignore[arg-type]
        raise GridgenError(
            f"corner_factor of functional {name!r} must be a whole number from 1 to {_LARGEST_FACTOR}; "
            f"came {quoted(factor)}; put other factors into the density"
        )
    if not isinstance(description, str):
        raise GridgenError(f"description of functional {name!r} must be text; came {quoted(description)}")


def given_parameters(name: str, parameters: object) -> dict[str, float]:
    """Return the parameters of a density given as text, as floats."""
    if parameters is None:
        return {}
    if not isinstance(parameters, Mapping):
        raise GridgenError(
            f"parameters of functional {name!r} must map names to numbers, such as {{'k': 1.0}}; "
            f"came {quoted(parameters)}"
        )
    for key, value in parameters.items():
        if not isinstance(value, Real):
            raise GridgenError(
                f"parameter {quoted(key)} of functional {name!r} is {quoted(value)}: give a finite number"
            )
    return {key: _float(value) for key, value in parameters.items()}


def parameters_of(density: Callable[..., Any]) -> dict[str, float]:
    """Return the parameters of a density function: its arguments after the metric, with their defaults."""
    name = getattr(density, "__name__", "density")
    try:
        arguments = list(inspect.signature(density).parameters.values())
    except (TypeError, ValueError) as error:
        raise GridgenError(
            f"the arguments of the density function {name!r} cannot be read ({error}): write one with def or lambda, "
            "such as lambda m: m.J**2"
        ) from None
    if not arguments:
        raise GridgenError(f"the density function {name!r} takes no argument: its first one must be the metric m")
    for argument in arguments[1:]:
        if not isinstance(argument.default, Real):
            raise GridgenError(
                f"parameter {argument.name!r} of the density function {name!r} needs a number as its default value"
            )
    return {argument.name: _float(argument.default) for argument in arguments[1:]}


def given_fields(name: str, fields: object, parameters: Mapping[str, float]) -> dict[str, str]:
    """Return the declared fields of a functional, by name, with their kinds."""
    if fields is None:
        return {}
    kinds = ", ".join(map(repr, KINDS))
    if not isinstance(fields, Mapping):
        raise GridgenError(
            f"fields of functional {name!r} must map names to kinds, such as {{'M': 'symmetric'}}; "
            f"came {quoted(fields)}"
        )
    taken = {*RESERVED_NAMES, *parameters}
    for field, kind in fields.items():
        if kind not in KINDS:
            raise GridgenError(
                f"the kind of field {quoted(field)} of functional {name!r} is {quoted(kind)}: use {kinds}"
            )
        if field == "s":
            raise GridgenError(
                f"functional {name!r} declares the field 's': that is the weight, which any density may name; give it "
                "as weight="
            )
        if not isinstance(field, str) or not _PARAMETER.fullmatch(field) or keyword.iskeyword(field):
            raise GridgenError(
                f"{quoted(field)} cannot name a field of functional {name!r}: use letters, digits and _, with a letter "
                "first"
            )
        if len(field) > _LONGEST_FIELD:
            raise GridgenError(
                f"the field {field[:20] + '...'!r} of functional {name!r} has {len(field)} letters: use at most "
                f"{_LONGEST_FIELD}"
            )
        own = components(field, kind)
        own = (*own, *(part + suffix for part in own for suffix in (*PHYSICAL_SUFFIXES, *LOGICAL_SUFFIXES)))
        for one in own:
            if one in taken:
                raise GridgenError(
                    f"the field {field!r} of functional {name!r} brings the name {one!r}, which means something else "
                    "already: give the field another name"
                )
        taken |= {*own, field}
    return dict(fields)


def _float(value: Real) -> float:
    """Return the number as a float; one too large for that is infinite, and refused with its name later."""
    try:
        return float(value)
    except OverflowError:
        return float("inf")


def check_parameter_names(functional: str, parameters: Mapping[str, float]) -> None:
    """Refuse names of parameters that are taken or unusable."""
    for name in parameters:
        if isinstance(name, str) and keyword.iskeyword(name):
            raise GridgenError(
                f"parameter {name!r} of functional {functional!r} is not a usable name: it is a word of Python; "
                f"write {name_instead_of(name)}"
            )
        if not isinstance(name, str) or not _PARAMETER.fullmatch(name):
            raise GridgenError(
                f"parameter {quoted(name)} of functional {functional!r} is not a usable name: use letters, digits and "
                "_, with a letter first"
            )
        if len(name) > _LONGEST_NAME:
            raise GridgenError(
                f"parameter {name[:20] + '...'!r} of functional {functional!r} has {len(name)} letters: use at most "
                f"{_LONGEST_NAME}"
            )
        if name in RESERVED_NAMES:
            raise GridgenError(
                f"parameter {name!r} of functional {functional!r}: that name means something else already"
            )
