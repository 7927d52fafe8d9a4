"""What a functional is, the registry of all of them, and `define`, the one way to add one."""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from typing import Any

from ..errors import GridgenError, quoted
from . import expression
from .arguments import check_arguments, check_parameter_names, given_parameters, parameters_of
from .metric import DENSITY_NAMES, symbol, symbolic_metric, sympy_functions

Density = Callable[..., Any]


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
                raise GridgenError(f"functional {self.name!r} has no parameter {quoted(name)}; it has {known}")
            try:
                merged[name] = float(value)
            except (TypeError, ValueError, OverflowError):
                raise GridgenError(
                    f"parameter {name!r} of functional {self.name!r} is {quoted(value)}: give a finite number"
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
        raise GridgenError(f"unknown functional {quoted(name)}; known: {', '.join(_registry)}.{hint}")
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
            parameters=parameters_of(density),
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
    new = Functional(name, density, operator.index(corner_factor), parameters, tuple(constraints), description)
    check_parameter_names(name, parameters)
    new.values(parameters)
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
