"""What a functional is, the registry of all of them, and `define`, the one way to add one."""

from __future__ import annotations

import inspect
import keyword
import operator
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from numbers import Real
from typing import Any, SupportsIndex

from ..errors import GridgenError
from . import expression
from .metric import DENSITY_NAMES, RESERVED_NAMES, symbol, symbolic_metric, sympy_functions

Density = Callable[..., Any]

_NAME = re.compile(r"[a-z][a-z0-9_]*")
_PARAMETER = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_LONGEST_NAME = 64  # Names of files and of C functions are made of it.
_LARGEST_FACTOR = 1000


# Compared and hashed by identity: what was derived from one functional is remembered for that one.
@dataclass(frozen=True, slots=True, eq=False)
class Functional:
    """A grid functional, the integral of a density over the logical square.

    Attributes:
        name: the name it is known by; also the prefix of its kernels.
        density: the continuous density as a function of the metric `m` and of the parameters, or as text.
        corner_factor: the discrete corner energy is `corner_factor` times the density of the corner's
            edge vectors (the paper's factor ½ stands in its integrals and not in its sums).
        parameters: names and default values of the numbers that a user may set at every solve.
        constraints: comparisons that the parameters must meet, such as `"k >= 0"`.
        description: one sentence for lists.
        reference: where it comes from.
        use_when: when to choose it, in Markdown, for its page.
        avoid_when: when not to.
    """

    name: str
    density: Density | str
    corner_factor: int = 1
    parameters: Mapping[str, float] = field(default_factory=dict)
    constraints: tuple[str, ...] = ()
    description: str = ""
    reference: str = ""
    use_when: str = ""
    avoid_when: str = ""

    def expression(self) -> Any:  # noqa: ANN401 - a SymPy expression; SymPy is not imported here
        """Return the density as a SymPy expression in the symbols of the metric and the parameters.

        Raises:
            GridgenError: if the density uses an unknown name or is not a SymPy expression.
        """
        import sympy

        parameters = {name: symbol(name) for name in self.parameters}
        if isinstance(self.density, str):
            names = {name: symbol(name) for name in DENSITY_NAMES} | parameters | {"pi": sympy.pi}
            density = expression.evaluate(self.density, names, sympy_functions(), sympy.Rational)
        else:
            density = self._call(parameters)
        try:
            density = sympy.sympify(density, strict=True)
        except sympy.SympifyError:
            density = None
        if not isinstance(density, sympy.Expr):
            raise GridgenError(
                f"the density of functional {self.name!r} is not a formula: expected an expression in the "
                "metric such as (m.g11 + m.g22)/m.J; check that the function returns it"
            )
        floats = density.atoms(sympy.Float)
        return density.xreplace({value: sympy.Rational(repr(float(value))) for value in floats})

    def _call(self, parameters: Mapping[str, Any]) -> Any:  # noqa: ANN401
        """Call the density function; say what went wrong in the language of functionals."""
        density = self.density
        assert not isinstance(density, str)
        try:
            return density(symbolic_metric(), **parameters)
        except GridgenError:
            raise
        except Exception as error:  # The function is the user's: anything may come.
            if "^" in str(error) or "Boolean" in str(error) or "BooleanAtom" in str(error):
                raise GridgenError(
                    f"the density of functional {self.name!r} uses '^', which is not a power in Python: "
                    "write ** (for example m.J**2)"
                ) from error
            raise GridgenError(
                f"the density of functional {self.name!r} cannot be evaluated on symbols: {error}. Use "
                "arithmetic and the functions of the metric (m.sqrt, m.exp, ...), not those of math or numpy"
            ) from error

    def values(self, given: Mapping[str, float] | None = None) -> dict[str, float]:
        """Return the parameters' values, with defaults replaced by those `given`, checked.

        Raises:
            GridgenError: for an unknown parameter, a value that is not finite, or a violated constraint.
        """
        merged = dict(self.parameters)
        for name, value in (given or {}).items():
            if name not in merged:
                known = ", ".join(merged) or "none: it has no parameters"
                raise GridgenError(f"functional {self.name!r} has no parameter {name!r}; it has {known}")
            try:
                merged[name] = float(value)
            except (TypeError, ValueError, OverflowError):
                raise GridgenError(
                    f"parameter {name!r} of functional {self.name!r} is {value!r}: give a finite number"
                ) from None
            if not abs(merged[name]) < float("inf"):
                raise GridgenError(f"parameter {name!r} of functional {self.name!r} is {value}: give a finite number")
        for constraint in self.constraints:
            if not expression.holds(constraint, merged):
                came = ", ".join(f"{name} = {value:g}" for name, value in merged.items())
                raise GridgenError(f"functional {self.name!r} needs {constraint}; came {came}")
        return merged


_registry: dict[str, Functional] = {}
_builtin: set[str] = set()


def functionals() -> tuple[str, ...]:
    """Return the names of all known functionals, in the order of their definition."""
    return tuple(_registry)


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
        raise GridgenError(f"unknown functional {name!r}; known: {', '.join(_registry)}.{hint}")
    return _registry[name]


def is_builtin(name: str) -> bool:
    """Return whether the functional comes with the package, so that its kernels stand in `generated/`."""
    return name in _builtin


def builtin(
    *,
    corner_factor: int = 1,
    constraints: tuple[str, ...] = (),
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
            parameters=_parameters_of(density),
            constraints=constraints,
            description=(density.__doc__ or "").strip(),
            reference=reference,
            use_when=use_when,
            avoid_when=avoid_when,
        )
        _builtin.add(density.__name__)
        return density

    return register


def define(
    name: str,
    density: Density | str,
    *,
    parameters: Mapping[str, float] | None = None,
    constraints: tuple[str, ...] = (),
    corner_factor: int = 1,
    description: str = "",
    replace: bool = False,
) -> Functional:
    """Add a functional; it has equations, kernels on every backend and every solver at once.

    Args:
        name: lower-case identifier, not yet taken.
        density: function of the metric `m` (and of parameters with default values), or the same as
            text, for example `"(g11 + g22)/J + k*g12**2"`.
        parameters: default values, for a density given as text.
        constraints: comparisons that the parameters must meet, such as `("k >= 0",)`.
        corner_factor: factor of the discrete corner energy over the density.
        description: one sentence for lists.
        replace: allow a functional that was defined at run time to be defined again.

    Raises:
        GridgenError: for a bad name, a density with unknown symbols, `^`, or values that are not
            real and finite on a valid grid, or constraints that the defaults do not meet.
    """
    _check_arguments(name, density, constraints, corner_factor, description)
    if name in _builtin or (name in _registry and not replace):
        hint = "choose another name" if name in _builtin else "choose another name, or pass replace=True"
        raise GridgenError(f"a functional named {name!r} exists: {hint}")
    if isinstance(density, str):
        parameters = _given_parameters(name, parameters)
    else:
        if parameters:
            raise GridgenError(
                "a density function takes its parameters as arguments with default values: drop parameters="
            )
        parameters = _parameters_of(density)
        description = description or (density.__doc__ or "").strip().split("\n")[0]
    new = Functional(name, density, operator.index(corner_factor), parameters, tuple(constraints), description)
    _check_parameters(new)
    from .check import check_density

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


def _check_arguments(name: object, density: object, constraints: object, factor: object, description: object) -> None:
    """Refuse arguments of `define` that are not of their kind."""
    if not isinstance(name, str) or not _NAME.fullmatch(name) or keyword.iskeyword(name):
        raise GridgenError(
            f"{name!r} cannot name a functional: use lower-case letters, digits and _, as in 'my_winslow'"
        )
    if len(name) > _LONGEST_NAME:
        raise GridgenError(
            f"the name {name[:20] + '...'!r} of a functional has {len(name)} letters: use at most {_LONGEST_NAME}"
        )
    if not (isinstance(density, str) or callable(density)):
        raise GridgenError(
            f"the density of functional {name!r} must be a function of the metric m, or text such as "
            f"'(g11 + g22)/J'; came {density!r}"
        )
    if not (isinstance(constraints, (tuple, list)) and all(isinstance(one, str) for one in constraints)):
        raise GridgenError(
            f"constraints of functional {name!r} must be a tuple of comparisons, such as ('k >= 0',); "
            f"came {constraints!r}"
        )
    whole = isinstance(factor, SupportsIndex) and not isinstance(factor, bool)
    if not (whole and 1 <= operator.index(factor) <= _LARGEST_FACTOR):  # type: ignore[arg-type]
        raise GridgenError(
            f"corner_factor of functional {name!r} must be a whole number from 1 to {_LARGEST_FACTOR}; "
            f"came {factor!r}; put other factors into the density"
        )
    if not isinstance(description, str):
        raise GridgenError(f"description of functional {name!r} must be text; came {description!r}")


def _given_parameters(name: str, parameters: object) -> dict[str, float]:
    """Return the parameters of a density given as text, as floats."""
    if parameters is None:
        return {}
    if not isinstance(parameters, Mapping):
        raise GridgenError(
            f"parameters of functional {name!r} must map names to numbers, such as {{'k': 1.0}}; came {parameters!r}"
        )
    for key, value in parameters.items():
        if not isinstance(value, Real):
            raise GridgenError(f"parameter {key!r} of functional {name!r} is {value!r}: give a finite number")
    return {key: _float(value) for key, value in parameters.items()}


def _parameters_of(density: Density) -> dict[str, float]:
    """Return the parameters of a density function: its arguments after the metric, with their defaults."""
    name = getattr(density, "__name__", "density")
    try:
        arguments = list(inspect.signature(density).parameters.values())
    except (TypeError, ValueError) as error:
        raise GridgenError(
            f"the arguments of the density function {name!r} cannot be told ({error}): write one with def or lambda, "
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


def _float(value: Real) -> float:
    """Return the number as a float; one too large for that is infinite, and refused with its name later."""
    try:
        return float(value)
    except OverflowError:
        return float("inf")


def _check_parameters(new: Functional) -> None:
    """Refuse parameter names that are taken or unusable, and defaults that break the constraints."""
    for name in new.parameters:
        if not isinstance(name, str) or not _PARAMETER.fullmatch(name) or keyword.iskeyword(name):
            raise GridgenError(
                f"parameter {name!r} of functional {new.name!r} is not a usable name: use letters, digits and _"
            )
        if len(name) > _LONGEST_NAME:
            raise GridgenError(
                f"parameter {name[:20] + '...'!r} of functional {new.name!r} has {len(name)} letters: use at most "
                f"{_LONGEST_NAME}"
            )
        if name in RESERVED_NAMES:
            raise GridgenError(f"parameter {name!r} of functional {new.name!r}: that name means something else already")
    new.values(new.parameters)
