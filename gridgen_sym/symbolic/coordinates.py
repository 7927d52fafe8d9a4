"""The symbols of the field, and differentiation with respect to them.

Logical coordinates `xi`, `eta`; physical coordinates `x(xi, eta)`, `y(xi, eta)`. Every derivative of the
map is a symbol (`x_xi`, `x_xieta`, ...), so that an expression is an ordinary function of jets. The metric
(`g11`, `g22`, `g12`, `J`) is kept as symbols too: expressions stay small, and `expand_metric` or the chain
rule in `differentiate` bring in what they stand for.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Literal

import sympy
from sympy import Expr, Symbol

from ..functionals.metric import DERIVATIVE_NAMES, symbol

#: How a weight s(x, y) enters: absent; held at the nodes; differentiated through; or no weight and the
#: barrier regularized (J replaced by chi(J) = (J + sqrt(J² + epsilon²))/2).
Variant = Literal["plain", "frozen", "differentiated", "regularized"]

x, y, xi, eta = (symbol(name) for name in ("x", "y", "xi", "eta"))
x_xi, y_xi, x_eta, y_eta = (symbol(name) for name in DERIVATIVE_NAMES)
g11, g22, g12, J, s = (symbol(name) for name in ("g11", "g22", "g12", "J", "s"))
#: First derivatives of the map, which are also the components of a corner's edge vectors g1 and g2.
FIRST_DERIVATIVES = (x_xi, y_xi, x_eta, y_eta)

x_xixi, x_xieta, x_etaeta = (symbol(name) for name in ("x_xixi", "x_xieta", "x_etaeta"))
y_xixi, y_xieta, y_etaeta = (symbol(name) for name in ("y_xixi", "y_xieta", "y_etaeta"))
SECOND_DERIVATIVES = (x_xixi, x_xieta, x_etaeta, y_xixi, y_xieta, y_etaeta)

s_x, s_y, s_xx, s_xy, s_yy, s_xi, s_eta = (
    symbol(name) for name in ("s_x", "s_y", "s_xx", "s_xy", "s_yy", "s_xi", "s_eta")
)

#: Regularized barrier: chi(J), the square root in it, and its parameter.
epsilon, root, chi = (symbol(name) for name in ("epsilon", "root", "chi"))

#: What the metric symbols stand for.
METRIC: Mapping[Symbol, Expr] = {
    g11: x_xi**2 + y_xi**2,
    g22: x_eta**2 + y_eta**2,
    g12: x_xi * x_eta + y_xi * y_eta,
    J: x_xi * y_eta - x_eta * y_xi,
}

#: What the symbols of the regularized barrier stand for. The second branch of chi is the first one
#: multiplied by its conjugate: it does not cancel where J is far below zero.
REGULARIZATION: Mapping[Symbol, Expr] = {
    root: sympy.sqrt(J**2 + epsilon**2),
    chi: sympy.Piecewise(((J + root) / 2, J > 0), (epsilon**2 / (2 * (root - J)), True)),
}

#: A direction in which derivatives are taken: how the edge vectors and (where the weight is differentiated) the
#: position move.
DIRECTION = tuple(symbol(f"v_{p}") for p in DERIVATIVE_NAMES)
POSITION_DIRECTION = v_x, v_y = symbol("v_x"), symbol("v_y")

#: How the metric symbols, and those of the regularized barrier, move along the direction.
METRIC_ALONG: Mapping[Symbol, Symbol] = {m: symbol(f"along_{m}") for m in (*METRIC, root, chi)}
_v_x_xi, _v_y_xi, _v_x_eta, _v_y_eta = DIRECTION
ALONG: Mapping[Symbol, Expr] = {
    METRIC_ALONG[g11]: 2 * (x_xi * _v_x_xi + y_xi * _v_y_xi),
    METRIC_ALONG[g22]: 2 * (x_eta * _v_x_eta + y_eta * _v_y_eta),
    METRIC_ALONG[g12]: x_xi * _v_x_eta + x_eta * _v_x_xi + y_xi * _v_y_eta + y_eta * _v_y_xi,
    METRIC_ALONG[J]: x_xi * _v_y_eta + y_eta * _v_x_xi - x_eta * _v_y_xi - y_xi * _v_x_eta,
    METRIC_ALONG[root]: J / root * METRIC_ALONG[J],
    METRIC_ALONG[chi]: chi / root * METRIC_ALONG[J],
}


def expand_metric(expression: Expr) -> Expr:
    """Return the expression with the metric (and chi) written out in the derivatives of the map."""
    return expression.subs(REGULARIZATION).subs(REGULARIZATION).subs(METRIC)


@lru_cache(maxsize=256)
def metric_gradient(m: Symbol) -> tuple[Expr, ...]:
    """Return the derivatives of a metric symbol with respect to `FIRST_DERIVATIVES`.

    `chi` has chi'(J) = chi/root; `root` has J/root.
    """
    if m == chi:
        return tuple(chi / root * entry for entry in metric_gradient(J))
    if m == root:
        return tuple(J / root * entry for entry in metric_gradient(J))
    return tuple(sympy.diff(METRIC[m], p) for p in FIRST_DERIVATIVES)


def differentiate_along(expression: Expr) -> Expr:
    """Differentiate along `DIRECTION`, through the metric symbols and the weight, which moves with the position."""
    moves = {
        **dict(zip(FIRST_DERIVATIVES, DIRECTION, strict=True)),
        **METRIC_ALONG,
        s: s_x * v_x + s_y * v_y,
        s_x: s_xx * v_x + s_xy * v_y,
        s_y: s_xy * v_x + s_yy * v_y,
    }
    terms = (sympy.diff(expression, v) * moves[v] for v in moves if v in expression.free_symbols)
    return sum(terms, sympy.S.Zero)


def differentiate(expression: Expr, variable: Symbol) -> Expr:
    """Differentiate with respect to one of `FIRST_DERIVATIVES`, through the metric symbols."""
    k = FIRST_DERIVATIVES.index(variable)
    result = sympy.diff(expression, variable)
    for m in (*METRIC, *REGULARIZATION):
        if m in expression.free_symbols:
            result += sympy.diff(expression, m) * metric_gradient(m)[k]
    return result
