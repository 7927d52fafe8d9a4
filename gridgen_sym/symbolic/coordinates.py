"""The symbols of the field, and differentiation with respect to them.

Logical coordinates `xi`, `eta`; physical coordinates `x(xi, eta)`, `y(xi, eta)`. Every derivative of the
map is a symbol (`x_xi`, `x_xieta`, ...), so that an expression is an ordinary function of jets. The metric
(`g11`, `g22`, `g12`, `J`) is kept as symbols too: expressions stay small, and `expand_metric` or the chain
rule in `differentiate` bring in what they stand for.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

import sympy
from sympy import Expr, Symbol

from ..functionals.choices import choice
from ..functionals.metric import DERIVATIVE_NAMES, INVERSE_TARGET_NAMES, TARGET_NAMES, symbol
from ..functionals.variant import Variant as Variant

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


def _regularized(jacobian: Symbol, its_root: Symbol) -> tuple[Expr, Expr]:
    """Return what the root and chi of a Jacobian stand for.

    The second branch of chi is the first one multiplied by its conjugate: it does not cancel where the Jacobian is far
    below zero.
    """
    conjugate = epsilon**2 / (2 * (its_root - jacobian))
    return sympy.sqrt(jacobian**2 + epsilon**2), choice(sympy.S.Zero, jacobian, (jacobian + its_root) / 2, conjugate)


#: What the symbols of the regularized barrier stand for.
REGULARIZATION: Mapping[Symbol, Expr] = dict(zip((root, chi), _regularized(J, root), strict=True))

#: The inverse of a target, V = W⁻¹, and the metric of T = A V as a density names it.
V11, V12, V21, V22 = (symbol(name) for name in INVERSE_TARGET_NAMES)
NAMED_TARGET_METRIC = tuple(symbol(name) for name in TARGET_NAMES)
#: The components of T = A V, in the order of `FIRST_DERIVATIVES`, and its metric, in that of `METRIC`.
TARGET_DERIVATIVES = tuple(symbol(f"target_{name}") for name in DERIVATIVE_NAMES)
TARGET_METRIC = tuple(symbol(f"target_{name}") for name in ("g11", "g22", "g12", "J"))
_t_x_xi, _t_y_xi, _t_x_eta, _t_y_eta = TARGET_DERIVATIVES
_t_g11, _t_g22, _t_g12, _t_jacobian = TARGET_METRIC
#: What they stand for.
TARGET: Mapping[Symbol, Expr] = {
    _t_x_xi: V11 * x_xi + V21 * x_eta,
    _t_y_xi: V11 * y_xi + V21 * y_eta,
    _t_x_eta: V12 * x_xi + V22 * x_eta,
    _t_y_eta: V12 * y_xi + V22 * y_eta,
    _t_g11: _t_x_xi**2 + _t_y_xi**2,
    _t_g22: _t_x_eta**2 + _t_y_eta**2,
    _t_g12: _t_x_xi * _t_x_eta + _t_y_xi * _t_y_eta,
    _t_jacobian: (V11 * V22 - V12 * V21) * J,
}
#: The metric of T in that of A: it is linear in it.
TARGET_IN_METRIC: Mapping[Symbol, Expr] = {
    _t_g11: V11**2 * g11 + 2 * V11 * V21 * g12 + V21**2 * g22,
    _t_g22: V12**2 * g11 + 2 * V12 * V22 * g12 + V22**2 * g22,
    _t_g12: V11 * V12 * g11 + (V11 * V22 + V12 * V21) * g12 + V21 * V22 * g22,
    _t_jacobian: TARGET[_t_jacobian],
}
#: The same of the regularized barrier relative to a target: epsilon is relative to det W.
target_root, target_chi = symbol("target_root"), symbol("target_chi")
TARGET_REGULARIZATION: Mapping[Symbol, Expr] = dict(
    zip((target_root, target_chi), _regularized(_t_jacobian, target_root), strict=True)
)
#: Every symbol that stands for something, each after those that it is made of.
DEFINITIONS: Mapping[Symbol, Expr] = {**METRIC, **REGULARIZATION, **TARGET, **TARGET_REGULARIZATION}
#: What chi replaces, and the root in it, by chi.
REGULARIZED: Mapping[Symbol, tuple[Symbol, Symbol]] = {chi: (J, root), target_chi: (_t_jacobian, target_root)}
#: Those whose second derivative in the edge vectors, where it is that of a determinant, is not semidefinite.
DETERMINANTS = (J, chi, _t_jacobian, target_chi)

#: A direction in which derivatives are taken: how the edge vectors and (where values move with the nodes) the
#: position move.
DIRECTION = tuple(symbol(f"v_{p}") for p in DERIVATIVE_NAMES)
POSITION_DIRECTION = v_x, v_y = symbol("v_x"), symbol("v_y")

#: How the symbols of `DEFINITIONS` move along the direction.
METRIC_ALONG: Mapping[Symbol, Symbol] = {m: symbol(f"along_{m}") for m in DEFINITIONS}


def expand_metric(expression: Expr) -> Expr:
    """Return the expression with the symbols of `DEFINITIONS` written out in the derivatives of the map."""
    return expression.xreplace(_written_out())


@lru_cache(maxsize=1)
def _written_out() -> dict[Symbol, Expr]:
    """Return what the symbols of `DEFINITIONS` stand for in the derivatives of the map."""
    result: dict[Symbol, Expr] = {}
    for name, meaning in DEFINITIONS.items():
        result[name] = meaning.xreplace(result)
    return result


def differentiate(expression: Expr, variable: Symbol) -> Expr:
    """Differentiate in a symbol that stands for nothing else, through those of `DEFINITIONS`."""
    result, named = sympy.diff(expression, variable), expression.free_symbols
    for m in DEFINITIONS:
        if m in named:
            slope = definition_slope(m, variable)
            if slope != 0:
                result += sympy.diff(expression, m) * slope
    return result


@lru_cache(maxsize=1024)
def definition_slope(m: Symbol, variable: Symbol) -> Expr:
    """Return the derivative of what a symbol of `DEFINITIONS` stands for.

    A chi has chi'(J) = chi/root; its root has J/root.
    """
    for of_chi, (jacobian, of_root) in REGULARIZED.items():
        if m in (of_chi, of_root):
            return (of_chi if m == of_chi else jacobian) / of_root * definition_slope(jacobian, variable)
    return differentiate(DEFINITIONS[m], variable)


@lru_cache(maxsize=256)
def metric_gradient(m: Symbol) -> tuple[Expr, ...]:
    """Return the derivatives of a symbol of `DEFINITIONS` with respect to `FIRST_DERIVATIVES`."""
    return tuple(definition_slope(m, p) for p in FIRST_DERIVATIVES)


def _definition_along(m: Symbol) -> Expr:
    """Return how a symbol of `DEFINITIONS` moves along the direction, in how those that it is made of move."""
    for of_chi, (jacobian, of_root) in REGULARIZED.items():
        if m in (of_chi, of_root):
            return (of_chi if m == of_chi else jacobian) / of_root * METRIC_ALONG[jacobian]
    moves = {**dict(zip(FIRST_DERIVATIVES, DIRECTION, strict=True)), **METRIC_ALONG}
    meaning = DEFINITIONS[m]
    terms = (sympy.diff(meaning, v) * moves[v] for v in moves if v in meaning.free_symbols)
    return sum(terms, sympy.S.Zero)


#: What the symbols of `METRIC_ALONG` stand for.
ALONG: Mapping[Symbol, Expr] = {METRIC_ALONG[m]: _definition_along(m) for m in DEFINITIONS}


def differentiate_along(expression: Expr, moving: Mapping[Symbol, tuple[Expr, Expr]] | None = None) -> Expr:
    """Differentiate along `DIRECTION`, through the symbols of `DEFINITIONS`.

    Args:
        expression: of the symbols of the metric and of values.
        moving: the derivatives in x and y of values that move with the position, which then moves along
            `POSITION_DIRECTION`.
    """
    moves: dict[Symbol, Expr] = {**dict(zip(FIRST_DERIVATIVES, DIRECTION, strict=True)), **METRIC_ALONG}
    moves |= {value: along_x * v_x + along_y * v_y for value, (along_x, along_y) in (moving or {}).items()}
    terms = (sympy.diff(expression, v) * moves[v] for v in moves if v in expression.free_symbols)
    return sum(terms, sympy.S.Zero)
