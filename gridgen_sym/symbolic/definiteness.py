"""Decide whether a matrix is positive semidefinite or an expression non-negative: proved, refuted or sampled."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import sympy
from sympy import Expr, Symbol

from .admissible import Admissible
from .coordinates import FIRST_DERIVATIVES, METRIC, x_eta, x_xi, y_eta, y_xi

#: Random points on which a claim is tried before and, where no proof is found, instead of a proof.
SAMPLES = 20_000
_ROUND_OFF = 1e-9
#: No algebra is tried where numerators have a higher degree in the first derivatives: it would take minutes, or hours.
_HIGHEST = 12
#: The powers of these roots are powers of one symbol.
_HIGHEST_ROOT = 3
_HUGE = 1e100  # beyond this, products of entries overflow: such points are not informative


@dataclass(frozen=True, slots=True)
class Definiteness:
    """Whether something is non-negative everywhere, and how that is known.

    Attributes:
        holds: the answer.
        proof: `proved` by algebra; `refuted` by a point where it fails; `sampled` at random points only.
        witness: the point where it fails, as (symbol, value) pairs, parameters first.
    """

    holds: bool
    proof: Literal["proved", "refuted", "sampled"]
    witness: tuple[tuple[Symbol, float], ...] = ()


def semidefinite(
    matrix: sympy.Matrix, *, nonnegative: Iterable[Symbol] = (), parameters: Admissible | None = None
) -> Definiteness:
    """Decide whether a symmetric matrix is positive semidefinite for all real values of its symbols.

    First random points try to refute it; then Gaussian elimination with pivots whose sign is read off their
    factors (a factor is non-negative if it is an even power, has only even powers with positive coefficients, or
    is a positive semidefinite quadratic form). A matrix that turns with the physical plane is looked at in the
    frame with y_xi = 0 only. Where the entries are of a high degree the random points alone decide.

    Args:
        matrix: symmetric, of rational expressions.
        nonnegative: symbols that take positive values only.
        parameters: the values that other symbols may take.
    """
    parameters = parameters or Admissible({})
    nonnegative = tuple(nonnegative)
    matrix = _with_impulses(matrix)
    refuted = _refute(matrix, nonnegative, parameters)
    if refuted is not None:
        return refuted
    if is_high(matrix):
        return Definiteness(holds=True, proof="sampled")
    framed = _in_frame(matrix).subs(parameters.substitution())
    rational, _ = without_functions(framed.applyfunc(without_square_roots) if parameters.matrices else framed)
    known = (variable for variable in rational.free_symbols if variable.is_nonnegative)
    proved = _eliminate(rational, (*nonnegative, *known))
    return Definiteness(holds=True, proof="proved" if proved else "sampled")


def _with_impulses(derivatives: sympy.Matrix) -> sympy.Matrix:
    """Return second derivatives with the impulses at kinks of abs() as positive symbols; -abs() is not convex."""
    impulses = sorted(derivatives.atoms(sympy.DiracDelta), key=sympy.default_sort_key)
    return derivatives.subs({impulse: sympy.Dummy("impulse", positive=True) for impulse in impulses})


def almost_everywhere(derivatives: Any) -> Any:  # noqa: ANN401 - an expression, or a matrix of them
    """Return second derivatives without the impulses at the kinks of absolute values: points, which no grid meets."""
    impulses = derivatives.has(sympy.DiracDelta)
    return derivatives.replace(sympy.DiracDelta, lambda *_: sympy.S.Zero) if impulses else derivatives


def without_square_roots(expression: Expr) -> Expr:
    """Return an expression with roots of squares of positive symbols taken, as of the determinant of a field."""
    return expression.replace(
        lambda part: isinstance(part, sympy.Pow) and not part.exp.is_Integer and part.base.is_Add,
        lambda part: sympy.powdenest(sympy.factor(part.base) ** part.exp),
    )


def without_functions(matrix: sympy.Matrix) -> tuple[sympy.Matrix, tuple[Symbol, ...]]:
    """Return the matrix with functions and roots replaced by real symbols, and those symbols that are positive.

    What is then proved for all values of these symbols holds for the functions. Positive are those of exp, and of
    powers of what is positive.
    """
    positive = []
    parts = [part for part in matrix.atoms(sympy.Function, sympy.Pow) if not _is_rational_power(part)]
    for part in sorted(parts, key=lambda part: (-sympy.count_ops(part), sympy.default_sort_key(part))):
        if not matrix.has(part):
            continue
        is_positive = isinstance(part, sympy.exp) or bool(part.is_positive)
        stand_in = sympy.Dummy(positive=True) if is_positive else sympy.Dummy(real=True)
        matrix = matrix.xreplace(_powers_of_root(matrix, part, stand_in))
        if is_positive:
            positive.append(stand_in)
    return matrix, tuple(positive)


def _powers_of_root(matrix: sympy.Matrix, part: Expr, stand_in: Symbol) -> dict[Expr, Expr]:
    """Return what a function or a root is replaced by, and with a square or cubic root all its powers.

    Of a power such as 1.37 nothing else is a small power, and polynomials of degree 137 take long.
    """
    if not (part.is_Pow and part.exp.is_Rational and part.exp.q <= _HIGHEST_ROOT):
        return {part: stand_in}
    powers = [one for one in matrix.atoms(sympy.Pow) if one.base == part.base and one.exp.is_Rational]
    return {one: stand_in ** (one.exp * part.exp.q) for one in powers if one.exp.q == part.exp.q}


def is_high(expressions: Iterable[Expr]) -> bool:
    """Return whether an expression is of so high a degree that algebra in the first derivatives would take minutes."""
    return max(map(degree_bound, expressions)) > _HIGHEST


def degree_bound(expression: Expr) -> int:
    """Return a bound of the degree of the numerator in the first derivatives."""
    if expression.is_Symbol:
        return 1 if expression in FIRST_DERIVATIVES else 2 if expression in METRIC else 0
    of_parts = [degree_bound(part) for part in expression.args]
    if _is_rational_power(expression):
        return max(0, int(expression.exp)) * of_parts[0]
    return sum(of_parts) if expression.is_Mul else max(of_parts, default=0)


def _is_rational_power(part: Expr) -> bool:
    return isinstance(part, sympy.Pow) and bool(part.exp.is_Integer)


def is_nonnegative(expression: Expr, nonnegative: Iterable[Symbol] = ()) -> bool:
    """Return whether the signs of the factors prove that the expression is nowhere negative."""
    positive = tuple(nonnegative)
    constant, factors = _signed_factors(expression)
    return constant >= 0 and all(
        power % 2 == 0 or _sum_of_squares(factor, positive) or _quadratic_form(factor) for factor, power in factors
    )


def is_positive(expression: Expr, positive: Iterable[Symbol] = ()) -> bool:
    """Return whether the factors prove that the expression is positive where the `positive` symbols are.

    Every factor must have even powers and positive coefficients only, and one term in positive symbols alone.
    """
    positive = tuple(positive)
    constant, factors = _signed_factors(expression)
    return constant > 0 and all(
        _sum_of_squares(factor, positive)
        and any(term.free_symbols <= set(positive) for term in sympy.Add.make_args(factor))
        for factor, _ in factors
    )


def _signed_factors(expression: Expr) -> tuple[Expr, list[tuple[Expr, int]]]:
    """Return a number and the factors of numerator and denominator with their powers."""
    above, below = sympy.together(expression).as_numer_denom()
    try:
        constant, factors = sympy.factor_list(above)
        constant_below, factors_below = sympy.factor_list(below)
    except TypeError:  # SymPy sorts factors by their powers, also by those that are symbols.
        return sympy.S.One, [(expression, 1)]
    return constant * constant_below, [*factors, *factors_below]


def _sum_of_squares(factor: Expr, nonnegative: tuple[Symbol, ...]) -> bool:
    symbols = sorted(factor.free_symbols, key=str)
    if not factor.is_polynomial(*symbols):
        return False
    polynomial = sympy.Poly(factor, *symbols)
    return all(
        coefficient.is_positive
        and all(power % 2 == 0 or variable in nonnegative for variable, power in zip(symbols, powers, strict=True))
        for powers, coefficient in polynomial.terms()
    )


def _quadratic_form(factor: Expr) -> bool:
    """Return whether the factor is a positive semidefinite quadratic form."""
    symbols = sorted(factor.free_symbols, key=str)
    if not factor.is_polynomial(*symbols):
        return False
    polynomial = sympy.Poly(factor, *symbols)
    if any(sum(powers) != 2 for powers in polynomial.monoms()):
        return False
    return bool(sympy.hessian(factor, symbols).is_positive_semidefinite)


def _in_frame(matrix: sympy.Matrix) -> sympy.Matrix:
    """Return the matrix with y_xi = 0, if a rotation R of the physical plane turns it: M(R A) = R M(A) R^t.

    Its eigenvalues then stay as they are, and every Jacobian matrix A can be turned to y_xi = 0. The first four
    rows must belong to `FIRST_DERIVATIVES` for this to be found; it is checked for infinitesimal rotations, but not
    where there are roots: that would take minutes.
    """
    if matrix.shape[0] < 4 or any(not power.exp.is_Integer for power in matrix.atoms(sympy.Pow)):
        return matrix
    turn = sympy.zeros(*matrix.shape)
    turn[0, 1] = turn[2, 3] = -1
    turn[1, 0] = turn[3, 2] = 1
    change = (
        x_xi * matrix.diff(y_xi) - y_xi * matrix.diff(x_xi) + x_eta * matrix.diff(y_eta) - y_eta * matrix.diff(x_eta)
    )
    if any(sympy.expand(entry) != 0 for entry in change - turn * matrix + matrix * turn):
        return matrix
    return matrix.subs(y_xi, 0)


def _refute(matrix: sympy.Matrix, nonnegative: tuple[Symbol, ...], parameters: Admissible) -> Definiteness | None:
    """Return a refutation found at random points with admissible parameters, or None."""
    random = np.random.default_rng(0)
    allowed = parameters.sample(random, SAMPLES)
    symbols = sorted(matrix.free_symbols, key=lambda variable: (variable not in allowed, str(variable)))
    points = random.normal(size=(len(symbols), SAMPLES))
    for row, variable in zip(points, symbols, strict=True):
        if variable in allowed:
            row[:] = allowed[variable]
        elif variable in nonnegative or variable.is_nonnegative:
            np.abs(row, out=row)
    with np.errstate(all="ignore"):
        entries = sympy.lambdify(symbols, list(matrix), "numpy", cse=True)(*points)
    size = matrix.shape[0]
    stacked = np.stack([np.broadcast_to(entry, SAMPLES) for entry in entries], axis=-1).reshape(SAMPLES, size, size)
    finite = (np.abs(stacked) < _HUGE).all(axis=(1, 2))
    stacked, points = stacked[finite], points[:, finite]
    if not len(stacked):
        return None
    eigenvalues = np.linalg.eigvalsh(stacked)
    relative = eigenvalues[:, 0] / np.maximum(np.abs(eigenvalues).max(axis=1), np.finfo(float).tiny)
    worst = int(relative.argmin())
    if relative[worst] >= -_ROUND_OFF:
        return None
    named = ((v, float(row[worst])) for v, row in zip(symbols, points, strict=True) if not isinstance(v, sympy.Dummy))
    witness = tuple(named)
    return Definiteness(holds=False, proof="refuted", witness=witness)


def _eliminate(matrix: sympy.Matrix, nonnegative: tuple[Symbol, ...]) -> bool:
    """Return whether every pivot of Gaussian elimination is provably non-negative (zero pivots have zero rows)."""
    rest = matrix.applyfunc(sympy.cancel)
    while rest.shape[0]:
        order = sorted(range(rest.shape[0]), key=lambda k: (rest[k, k] == 0, sympy.count_ops(rest[k, k])))
        k, others = order[0], sorted(order[1:])
        pivot = rest[k, k]
        if pivot == 0:
            return bool(rest.is_zero_matrix)
        if not is_nonnegative(pivot, nonnegative):
            return False
        row = rest.extract([k], others)
        rest = (rest.extract(others, others) - row.T * row / pivot).applyfunc(sympy.cancel)
    return True
