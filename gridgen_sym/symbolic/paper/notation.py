"""Read the text of a printed equation into SymPy: the names and functions that `functionals.paper` is written in."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import sympy

from ...functionals.expression import evaluate
from ...functionals.metric import symbol, sympy_functions
from ..coordinates import (
    FIRST_DERIVATIVES,
    METRIC,
    SECOND_DERIVATIVES,
    eta,
    g11,
    g12,
    g22,
    s,
    x,
    x_eta,
    x_xi,
    xi,
    y,
    y_eta,
    y_xi,
)
from ..derive.continuous import EulerLagrange, total_derivative
from ..values import Values

_JACOBIAN = sympy.Matrix([[x_xi, x_eta], [y_xi, y_eta]])
#: Logical positions of the neighbors relative to node k, and of the ends o, a, b of Figure 1.
_POSITIONS = {"k": (0, 0), "4": (1, 0), "1": (0, 1), "2": (-1, 0), "3": (0, -1), "o": (0, 0), "a": (1, 0), "b": (0, 1)}

_NO_VALUES = Values((), {}, {}, ())


def read(text: str, derived: EulerLagrange | None = None) -> Any:  # noqa: ANN401 - an expression or a matrix
    """Return a printed expression in the symbols of the project.

    Args:
        text: as `functionals.paper` gives it.
        derived: whose density `F_x`, `F_x_xi`, ... are derivatives of.
    """
    names = _names() | (_density_names(derived) if derived else {})
    return evaluate(text, names, _functions(derived.values if derived else _NO_VALUES), sympy.Rational)


def _names() -> dict[str, Any]:
    metric = sympy.Matrix([[g11, g12], [g12, g22]])
    half, spread = (g11 + g22) / 2, sympy.sqrt((g11 - g22) ** 2 + 4 * g12**2) / 2
    names: dict[str, Any] = {str(v): v for v in (x, y, xi, eta, s, *METRIC, *FIRST_DERIVATIVES, *SECOND_DERIVATIVES)}
    names |= {name: symbol(name) for name in ("k_A", "k_L", "k_O")}
    names |= {"pi": sympy.pi, "A": _JACOBIAN, "G": metric, "g1": _JACOBIAN[:, 0], "g2": _JACOBIAN[:, 1], "g21": g12}
    names |= {"lambda_1": half + spread, "lambda_2": half - spread}
    for node, position in _POSITIONS.items():
        place = sympy.Matrix([x, y]) + _JACOBIAN * sympy.Matrix(position)
        names |= {f"x_{node}": place[0], f"y_{node}": place[1]}
    return names


def _density_names(derived: EulerLagrange) -> dict[str, Any]:
    fluxes = zip(("F_x_xi", "F_y_xi", "F_x_eta", "F_y_eta"), derived.fluxes, strict=True)
    return dict(fluxes) | {"F_x": derived.sources[0], "F_y": derived.sources[1]}


def _functions(values: Values) -> Mapping[str, Callable[..., Any]]:
    return sympy_functions() | {
        "D_xi": lambda expression: total_derivative(expression, "xi", values),
        "D_eta": lambda expression: total_derivative(expression, "eta", values),
        "norm": lambda matrix: sympy.sqrt(sum(entry**2 for entry in matrix)),
        "det": lambda matrix: matrix.det(),
        "matrix": lambda *entries: sympy.Matrix(2, 2, entries),
        "inverse": lambda matrix: matrix.adjugate() / matrix.det(),
        "transpose": lambda matrix: matrix.T,
        "dot": lambda first, second: first.dot(second),
        "cross": lambda first, second: first[0] * second[1] - first[1] * second[0],
    }
