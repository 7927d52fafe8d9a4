"""The principal symbol A(k) of the Euler–Lagrange equations, and its determinant in the metric."""

from __future__ import annotations

from functools import lru_cache

import sympy
from sympy import Expr

from ...functionals.metric import symbol
from ..coordinates import J, epsilon, g11, g12, g22, x_eta, x_xi, y_eta, y_xi
from ..definiteness import almost_everywhere, is_high, without_functions
from ..derive.discrete import hessian
from .frame_determinant import frame_determinant

k1, k2 = symbol("k1"), symbol("k2")

_q = sympy.Dummy("q", real=True)
_p, _r = (sympy.Dummy(name, positive=True) for name in "pr")
#: More operations than this in a matrix, and no proof is tried: it would take minutes.
_PROOF_LIMIT = 1200


def principal_symbol(density: Expr) -> sympy.Matrix:
    """Return A(k)_ij = sum over a, b of d²F/dp^i_a dp^j_b k_a k_b, with i, j in (x, y) and a, b in (xi, eta)."""
    slope = almost_everywhere(hessian(density))
    return sympy.Matrix(
        2,
        2,
        lambda i, j: slope[i, j] * k1**2 + (slope[i, 2 + j] + slope[2 + i, j]) * k1 * k2 + slope[2 + i, 2 + j] * k2**2,
    )


def determinant(matrix: sympy.Matrix, *, rotates: bool) -> Expr:
    """Return the determinant of a principal symbol, in the metric symbols where it can be written in them.

    Args:
        matrix: the principal symbol.
        rotates: whether the density is invariant under rotation, so that the frame with y_xi = 0 stands for all.
    """
    if not rotates or is_large(matrix) or matrix.has(epsilon) or without_functions(matrix)[0] != matrix:
        return matrix[0, 0] * matrix[1, 1] - matrix[0, 1] * matrix[1, 0]
    framed = frame_determinant(matrix, {x_xi: _p, x_eta: _q, y_xi: sympy.S.Zero, y_eta: _r})
    value = None if framed is None else in_invariants(framed)
    return matrix[0, 0] * matrix[1, 1] - matrix[0, 1] * matrix[1, 0] if value is None else value


def in_invariants(framed: Expr) -> Expr | None:
    """Rewrite an expression of the frame g1 = (p, 0), g2 = (q, r) in g11, g22, g12 and J; None if it is impossible."""
    above, below = framed.as_numer_denom()
    constant, factors = sympy.factor_list(above)
    constant_below, factors_below = sympy.factor_list(below)
    result, power_of_p = constant / constant_below, 0
    for factor, power in (*factors, *((factor, -power) for factor, power in factors_below)):
        if factor == _p:
            power_of_p += power
        elif factor == _q:  # q = g12/p and r = J/p: p must come out in even powers at the end
            result, power_of_p = result * g12**power, power_of_p - power
        elif factor == _r:
            result, power_of_p = result * J**power, power_of_p - power
        else:
            result *= _reduce(factor) ** power
    result *= g11 ** sympy.Rational(power_of_p, 2)
    return None if power_of_p % 2 or result.has(_p, _q, _r) else result


def _reduce(polynomial: Expr) -> Expr:
    """Return the polynomial modulo what the metric stands for, lowest in p, q and r."""
    others = sorted({k1, k2} | polynomial.free_symbols - {_p, _q, _r}, key=str)
    terms = [
        (sympy.prod(v**n for v, n in zip(others, powers, strict=True)), part)
        for powers, part in sympy.Poly(polynomial, *others).terms()
    ]
    return sum((_metric_basis().reduce(part)[1] * monomial for monomial, part in terms), sympy.S.Zero)


@lru_cache(maxsize=1)
def _metric_basis() -> sympy.polys.polytools.GroebnerBasis:
    relations = [_p**2 - g11, _p * _q - g12, _q**2 + _r**2 - g22, _p * _r - J]
    return sympy.groebner(relations, _p, _q, _r, J, g12, g11, g22, order="lex")


def is_large(matrix: sympy.Matrix) -> bool:
    """Return whether algebra would take minutes: many operations, a high degree, or roots, which stand-ins multiply."""
    roots = any(not power.exp.is_Integer for power in matrix.atoms(sympy.Pow))
    return roots or is_high(matrix) or bool(sympy.count_ops(matrix) > _PROOF_LIMIT)
