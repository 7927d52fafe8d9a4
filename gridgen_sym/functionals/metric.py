"""The language that a functional is written in: the metric of the map (xi, eta) -> (x, y), as symbols."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from ..errors import GridgenError
from .expression import FUNCTION_NAMES, FUNCTIONS_OF_ONE

if TYPE_CHECKING:
    import sympy

#: First derivatives of the map: g1 = (x_xi, y_xi) and g2 = (x_eta, y_eta).
DERIVATIVE_NAMES = ("x_xi", "y_xi", "x_eta", "y_eta")
#: g11 = g1.g1, g22 = g2.g2, g12 = g1.g2 and the Jacobian J = x_xi*y_eta - x_eta*y_xi.
METRIC_NAMES = ("g11", "g22", "g12", "J")
#: The same of T = A W⁻¹, with A the Jacobian matrix and W the target; of A itself where there is no target.
TARGET_NAMES = ("t11", "t22", "t12", "tau")
#: What depends on the grid's shape: a density must name one of these.
SHAPE_NAMES = (*METRIC_NAMES, *DERIVATIVE_NAMES, *TARGET_NAMES)
#: The weight (adaptive function of the paper) at the point, s(x, y).
WEIGHT_NAME = "s"
#: The place in the plane, and in the logical square [0, 1]².
POSITION_NAMES, LOGICAL_NAMES = ("x", "y"), ("xi", "eta")
#: Everything that any density may be written in; declared fields come to it.
DENSITY_NAMES = (*METRIC_NAMES, WEIGHT_NAME, *DERIVATIVE_NAMES, *POSITION_NAMES, *LOGICAL_NAMES, *TARGET_NAMES)
#: The inverse of the target, V = W⁻¹, row by row.
INVERSE_TARGET_NAMES = ("V11", "V12", "V21", "V22")
#: The control functions P and Q, which equations may be given.
CONTROL_NAMES = ("control_P", "control_Q")
#: Names that derivations use, so that a parameter cannot have them.
RESERVED_NAMES = frozenset(
    (
        *(
            *DENSITY_NAMES,
            *INVERSE_TARGET_NAMES,
            *CONTROL_NAMES,
            *FUNCTION_NAMES,
            "pi",
            "epsilon",
            "root",
            "chi",
            "k1",
            "k2",
            "D",
        ),
        *(f"{name}_{suffix}" for name in INVERSE_TARGET_NAMES for suffix in ("xi", "eta")),
        *(f"s_{suffix}" for suffix in ("x", "y", "xx", "xy", "yy", "xi", "eta")),
        *(f"{r}_{suffix}" for r in "xy" for suffix in ("xixi", "xieta", "etaeta")),
    )
)


class Metric:
    """What a density may use: `m.g11`, `m.g22`, `m.g12`, `m.J`, `m.s`, `m.x_xi` ..., declared fields, and functions.

    Every attribute is a real SymPy symbol; the functions of `expression.FUNCTION_NAMES` are there
    too (`m.sqrt`, `m.exp`, ...), so that a file of functionals needs no import of SymPy.
    """

    __slots__ = ("_fields", "_values")

    def __init__(self, values: dict[str, Any], fields: tuple[str, ...] = ()) -> None:
        """Hold the values of the names; `fields` are those of the components of declared fields."""
        self._values, self._fields = values, fields

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401 - a SymPy symbol or function
        """Return the symbol or function `name`."""
        if name.startswith("__"):
            raise AttributeError(name)
        try:
            return self._values[name]
        except KeyError:
            raise GridgenError(
                f"a density cannot use m.{name}: the metric has only {', '.join((*DENSITY_NAMES, *self._fields))} "
                f"and the functions {', '.join(FUNCTION_NAMES)}; a field is declared by define(..., "
                f"fields={{{name!r}: 'scalar'}})"
            ) from None


def symbol(name: str) -> sympy.Symbol:
    """Return the real symbol of this name; the same name always gives the same symbol."""
    import sympy

    return sympy.Symbol(name, real=True)


@lru_cache(maxsize=1)
def sympy_functions() -> dict[str, Any]:
    """Return the functions that a formula may call, by name: those of SymPy, and `max`, `min` and `where`."""
    import sympy

    from .choices import largest, smallest, where

    ours = {"abs": sympy.Abs, "max": largest, "min": smallest, "where": where}
    return {name: ours[name] if name in ours else getattr(sympy, name) for name in FUNCTION_NAMES}


@lru_cache(maxsize=1)
def function_types() -> tuple[type, ...]:
    """Return the types of SymPy's nodes that calls of `sympy_functions` give, beside powers."""
    from .choices import CHOICES

    others = {"sqrt", "max", "min", "where"}
    return (*(part for name, part in sympy_functions().items() if name not in others), *CHOICES)


@lru_cache(maxsize=16)
def symbolic_metric(fields: tuple[str, ...] = ()) -> Metric:
    """Return the metric whose attributes are SymPy symbols, with those of the components of declared fields."""
    functions = sympy_functions()
    functions = functions | {name: _of_one_argument(functions[name]) for name in FUNCTIONS_OF_ONE}
    return Metric({name: symbol(name) for name in (*DENSITY_NAMES, *fields)} | functions, fields)


def _of_one_argument(function: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """Return the function without its further arguments: SymPy's sqrt takes `evaluate` as its second."""
    return lambda argument, /: function(argument)
