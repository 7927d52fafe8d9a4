"""What a functional is: a density, its parameters, and its description."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeAlias

from ..errors import GridgenError, quoted
from ..parsing import number_in
from . import expression
from .field_kinds import all_components
from .metric import DENSITY_NAMES, symbol, symbolic_metric, sympy_functions
from .signs import without_known_signs

Density = Callable[..., Any]
#: What a density function returns: a SymPy expression, whose package is not loaded here.
Formula: TypeAlias = Any


# Compared and hashed by identity: what was derived from one functional is remembered for that one.
@dataclass(frozen=True, slots=True, eq=False)
class Functional:
    """A grid functional, the integral of a density over the logical square.

    Attributes:
        name: the name it is known by; also the prefix of its kernels.
        density: the continuous density as a function of the metric `m` and of the parameters, or as text.
        corner_factor: the discrete corner energy is `corner_factor` times the density of the corner's edge vectors
            over the logical steps (the paper's factor ½ is in its integrals and not in its sums).
        parameters: names and default values of the numbers that a user may set at every solve.
        constraints: comparisons that the parameters must meet, such as `"k >= 0"`, or the components of fields.
        fields: names and kinds (`scalar`, `vector`, `symmetric`, `matrix`) of the fields that the density names.
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
    fields: Mapping[str, str] = field(default_factory=dict)
    description: str = ""
    reference: str = ""
    use_when: str = ""
    avoid_when: str = ""

    @property
    def components(self) -> tuple[str, ...]:
        """The names of the components of the fields, such as M11, M12, M22."""
        return all_components(self.fields)

    def expression(self) -> Any:  # noqa: ANN401 - a SymPy expression; SymPy is not imported here
        """Return the density as a SymPy expression in the symbols of the metric and the parameters.

        Raises:
            GridgenError: if the density uses an unknown name or is not a SymPy expression.
        """
        import sympy

        from .choices import with_choices

        parameters = {name: symbol(name) for name in self.parameters}
        if isinstance(self.density, str):
            known = (*DENSITY_NAMES, *self.components)
            names = {name: symbol(name) for name in known} | parameters | {"pi": sympy.pi}
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
        density = without_known_signs(density, self.constraints, (*self.parameters, *self.components))
        floats = density.atoms(sympy.Float)
        return with_choices(density).xreplace({value: sympy.Rational(repr(float(value))) for value in floats})

    def _call(self, parameters: Mapping[str, Any]) -> Any:  # noqa: ANN401
        """Call the density function; report errors in the terms of functionals."""
        density = self.density
        assert not isinstance(density, str)
        try:
            return density(symbolic_metric(self.components), **parameters)
        except GridgenError:
            raise
        except Exception as error:  # The function is the user's: anything may come.
            if "^" in str(error) or "Boolean" in str(error) or "BooleanAtom" in str(error):
                raise GridgenError(
                    f"the density of functional {self.name!r} uses '^', which is not a power in Python: "
                    "write ** (for example m.J**2)"
                ) from error
            if "truth value" in str(error):
                raise GridgenError(
                    f"the density of functional {self.name!r} decides by a comparison of symbols, which are no numbers "
                    "yet: write m.where(m.J > 1, a, b) instead of if, and of a chain such as 0 < m.J < 1 (nest it), "
                    "and m.max(a, b), m.min(a, b) instead of Python's max and min"
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
        if given is not None and not isinstance(given, Mapping):
            raise GridgenError(f"parameters must be given by name, as in {{'k': 0.5}}; came {quoted(given)}")
        merged = dict(self.parameters)
        for name, value in (given or {}).items():
            if name not in merged:
                known = ", ".join(merged) or "none: it has no parameters"
                raise GridgenError(f"functional {self.name!r} has no parameter {quoted(name)}; it has {known}")
            try:
                merged[name] = _real(value)
            except (TypeError, ValueError, OverflowError):
                raise GridgenError(
                    f"parameter {name!r} of functional {self.name!r} is {quoted(value)}: give a finite number"
                ) from None
            if not abs(merged[name]) < float("inf"):
                raise GridgenError(f"parameter {name!r} of functional {self.name!r} is {value}: give a finite number")
        for constraint in self.constraints:
            if expression.names_in(constraint) & {*self.components}:
                continue  # It is met by the values of fields, which are checked where they are evaluated.
            if not expression.holds(constraint, merged):
                came = ", ".join(f"{name} = {value:g}" for name, value in merged.items())
                raise GridgenError(f"functional {self.name!r} needs {constraint}; came {came}")
        return merged


def _real(value: Any) -> float:  # noqa: ANN401 - whatever a user gave
    """Return a value as a number; a text is read as those of files are, which `float` does not do."""
    return number_in(value) if isinstance(value, str) else float(value)
