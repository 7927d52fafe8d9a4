"""The language that a functional is written in: the metric of the map (xi, eta) -> (x, y), as symbols."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from ..errors import GridgenError
from .expression import FUNCTION_NAMES

if TYPE_CHECKING:
    import sympy

#: First derivatives of the map: g1 = (x_xi, y_xi) and g2 = (x_eta, y_eta).
DERIVATIVE_NAMES = ("x_xi", "y_xi", "x_eta", "y_eta")
#: g11 = g1.g1, g22 = g2.g2, g12 = g1.g2 and the Jacobian J = x_xi*y_eta - x_eta*y_xi.
METRIC_NAMES = ("g11", "g22", "g12", "J")
#: The weight (adaptive function of the paper) at the point, s(x, y).
WEIGHT_NAME = "s"
#: Everything that a density may be written in.
DENSITY_NAMES = (*METRIC_NAMES, WEIGHT_NAME, *DERIVATIVE_NAMES)
#: Names that derivations use, so that a parameter cannot have them.
RESERVED_NAMES = frozenset(
    (
        *(*DENSITY_NAMES, *FUNCTION_NAMES, "pi", "x", "y", "xi", "eta", "epsilon", "root", "chi", "k1", "k2", "D"),
        *(f"s_{suffix}" for suffix in ("x", "y", "xx", "xy", "yy", "xi", "eta")),
        *(f"{r}_{suffix}" for r in "xy" for suffix in ("xixi", "xieta", "etaeta")),
    )
)


class Metric:
    """What a density may use: `m.g11`, `m.g22`, `m.g12`, `m.J`, `m.s`, `m.x_xi` ... and functions.

    Every attribute is a real SymPy symbol; the functions of `expression.FUNCTION_NAMES` are there
    too (`m.sqrt`, `m.exp`, ...), so that a file of functionals needs no import of SymPy.
    """

    __slots__ = ("_values",)

    def __init__(self, values: dict[str, Any]) -> None:
        """Hold the values of the names."""
        self._values = values

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401 - a SymPy symbol or function
        """Return the symbol or function `name`."""
        if name.startswith("__"):
            raise AttributeError(name)
        try:
            return self._values[name]
        except KeyError:
            raise GridgenError(
                f"a density cannot use m.{name}: the metric has only {', '.join(DENSITY_NAMES)} "
                f"and the functions {', '.join(FUNCTION_NAMES)}"
            ) from None


def symbol(name: str) -> sympy.Symbol:
    """Return the real symbol of this name; the same name always gives the same symbol."""
    import sympy

    return sympy.Symbol(name, real=True)


@lru_cache(maxsize=1)
def sympy_functions() -> dict[str, Any]:
    """Return the functions that a formula may call, as SymPy functions."""
    import sympy

    return {name: sympy.Abs if name == "abs" else getattr(sympy, name) for name in FUNCTION_NAMES}


@lru_cache(maxsize=1)
def symbolic_metric() -> Metric:
    """Return the metric whose attributes are SymPy symbols."""
    functions = {name: _of_one_argument(function) for name, function in sympy_functions().items()}
    return Metric({name: symbol(name) for name in DENSITY_NAMES} | functions)


def _of_one_argument(function: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """Return the function without its further arguments: SymPy's sqrt takes `evaluate` as its second."""
    return lambda argument, /: function(argument)
