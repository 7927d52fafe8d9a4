"""The registry of all functionals, and `define`, the one way to add one."""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping
from difflib import get_close_matches

from ..errors import GridgenError, quoted
from .arguments import check_arguments, check_parameter_names, given_fields, given_parameters, parameters_of
from .bibliography import short
from .check import check_density
from .definition import Density, Functional

_registry: dict[str, Functional] = {}
_builtin: set[str] = set()
_literature: dict[str, tuple[str, ...]] = {}


def functionals(*, literature: bool = True) -> tuple[str, ...]:
    """Return the names of all known functionals, in the order of their definition.

    Args:
        literature: include those of the literature, whose kernels are derived when they are first used.
    """
    return tuple(name for name in _registry if literature or name not in _literature)


def functional(name: str | Functional) -> Functional:
    """Return the functional of this name (a `Functional` is returned as it is).

    Raises:
        GridgenError: if there is none of this name; the closest one is named.
    """
    if isinstance(name, Functional):
        return name
    if not isinstance(name, str) or name not in _registry:
        close = get_close_matches(str(name), _registry, n=1)
        hint = f" Did you mean {close[0]!r}?" if close else ""
        raise GridgenError(f"unknown functional {quoted(name)}; known: {', '.join(_registry)}.{hint}")
    return _registry[name]


def is_builtin(name: str) -> bool:
    """Return whether the functional comes with the package."""
    return name in _builtin


def is_literature(name: str) -> bool:
    """Return whether the functional is one of the literature: it comes with the package, but its kernels do not."""
    return name in _literature


def literature_sources(name: str) -> tuple[str, ...]:
    """Return the keys of the sources of a functional of the literature, by its name; none for others."""
    return _literature.get(name, ())


def builtin(
    *,
    corner_factor: int = 1,
    constraints: tuple[str, ...] = (),
    fields: Mapping[str, str] | None = None,
    reference: str = "",
    use_when: str = "",
    avoid_when: str = "",
) -> Callable[[Density], Density]:
    """Register the decorated density under the function's name, as part of the package."""

    def register(density: Density) -> Density:
        _registry[density.__name__] = Functional(
            name=density.__name__,
            density=density,
            corner_factor=corner_factor,
            parameters=parameters_of(density),
            constraints=constraints,
            fields=dict(fields or {}),
            description=(density.__doc__ or "").strip(),
            reference=reference,
            use_when=use_when,
            avoid_when=avoid_when,
        )
        _builtin.add(density.__name__)
        return density

    return register


def literature(
    *sources: str, constraints: tuple[str, ...] = (), fields: Mapping[str, str] | None = None
) -> Callable[[Density], Density]:
    """Register the decorated density as a functional of the literature: its kernels are derived when first used.

    Args:
        sources: keys of the bibliography.
        constraints: as in `define`.
        fields: as in `define`.
    """

    def register(density: Density) -> Density:
        _literature[density.__name__] = sources
        reference = "; ".join(map(short, sources))
        return builtin(constraints=constraints, fields=fields, reference=reference)(density)

    return register


def define(
    name: str,
    density: Density | str,
    *,
    parameters: Mapping[str, float] | None = None,
    constraints: tuple[str, ...] = (),
    fields: Mapping[str, str] | None = None,
    corner_factor: int = 1,
    description: str = "",
    replace: bool = False,
) -> Functional:
    """Add a functional; it has equations, kernels on every backend and every solver at once.

    Args:
        name: lower-case identifier, not yet taken.
        density: function of the metric `m` (and of parameters with default values), or the same as
            text, for example `"(g11 + g22)/J + k*g12**2"` or `"max(0, 1 - J)**2"`; the page on the language of
            formulas lists the functions.
        parameters: default values, for a density given as text.
        constraints: comparisons that the parameters must meet, such as `("k >= 0",)` or `("0 < k < 1",)`. What is
            derived, such as polyconvexity, is decided for the parameters that they allow. They may name components of
            fields, too, such as `"p > 0"` of a scalar p.
        fields: what the density names beside the metric, the place and the weight, by name: `scalar` (p),
            `vector` (v1, v2), `symmetric` (M11, M12, M22: a positive definite matrix) or `matrix` (B11, B12, B21,
            B22). Their values are given at a solve, as `fields={"M": ...}`.
        corner_factor: factor of the discrete corner energy over the density.
        description: one sentence for lists.
        replace: allow a functional that was defined at run time to be defined again.

    Raises:
        GridgenError: for a bad name, a density with unknown symbols, `^`, or values that are not
            real and finite on a valid grid, or constraints that the defaults do not meet.
    """
    check_arguments(name, density, constraints, corner_factor, description)
    if name in _builtin or (name in _registry and not replace):
        hint = "choose another name" if name in _builtin else "choose another name, or pass replace=True"
        raise GridgenError(f"a functional named {name!r} exists: {hint}")
    if isinstance(density, str):
        parameters = given_parameters(name, parameters)
    else:
        if parameters:
            raise GridgenError(
                "a density function takes its parameters as arguments with default values: drop parameters="
            )
        parameters = parameters_of(density)
        description = description or (density.__doc__ or "").strip().split("\n")[0]
    new = Functional(
        name,
        density,
        operator.index(corner_factor),
        parameters,
        tuple(constraints),
        given_fields(name, fields, parameters),
        description,
    )
    check_parameter_names(name, parameters)
    new.values(parameters)

    try:
        check_density(new)
    except GridgenError:
        raise
    except (ArithmeticError, MemoryError, RecursionError, SyntaxError, TypeError, ValueError) as error:
        raise GridgenError(
            f"the density of functional {name!r} is too long, too deeply nested or no formula for SymPy "
            f"({type(error).__name__}: {error}): shorten it"
        ) from error
    _registry[name] = new
    return new
