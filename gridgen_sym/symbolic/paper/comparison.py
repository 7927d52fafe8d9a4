"""Compare equations of the paper with the derived ones, by algebra; one function for each kind of equation."""

from __future__ import annotations

from typing import Any

import sympy
from sympy import Expr, Symbol

from ...errors import GridgenError
from ...functionals import Functional, functional
from ...functionals.paper import PRINTED, PrintedEquation
from ..classify.principal_symbol import principal_symbol
from ..coordinates import METRIC, SECOND_DERIVATIVES, J, expand_metric, s, x, x_eta, x_xi, y, y_eta, y_xi
from ..derive.continuous import euler_lagrange
from ..derive.discrete import corner_model, variant_density
from .errata import Finding
from .notation import read

#: The unit cell and its mirror image: J = 1 and J = -1.
_UNFOLDED = {x_xi: 1, y_xi: 0, x_eta: 0, y_eta: 1}
_FOLDED = {x_xi: 1, y_xi: 0, x_eta: 0, y_eta: -1}

#: A density that names every variable of equation (1), and a field.
GENERAL = Functional(
    "general", "(1 + x*xi + y**2*eta)*(x_xi**2 + y_eta**3) + p*x_eta*y_xi**2 + x_xi*y_eta*J", fields={"p": "scalar"}
)


def agreement(text: str = "") -> Finding:
    """Return the finding of an equation that is the derived one."""
    return Finding(True, "agrees", "same", sympy.S.Zero, text)


def _functionals_of_the_paper() -> tuple[str, ...]:
    return tuple(dict.fromkeys(printed.functional for printed in PRINTED if printed.functional))


def compare_arguments(printed: PrintedEquation) -> Finding:
    """Ask the language which of the listed variables a density may name, and every density for others."""
    allowed = {read(name) for name in printed.expressions} | {s}
    for name in _functionals_of_the_paper():
        density = expand_metric(variant_density(functional(name), "differentiated"))
        strange = density.free_symbols - allowed - set(corner_model(functional(name)).parameters)
        if strange:
            return Finding(False, "differs", "other", sympy.S.Zero, f"the density of {name} depends on {strange}")
    missing = [name for name in printed.expressions if not _can_be_named(name)]
    if missing:
        names = ", ".join(missing)
        text = f"a density cannot name {names}; the position enters through s = s(x, y) alone"
        return Finding(True, f"holds without {names}", "only in part", sympy.S.Zero, text)
    return agreement("a density may name each of these, a weight s and declared fields")


def _can_be_named(name: str) -> bool:
    """Return whether a density may depend on the variable of this name."""
    try:
        return read(name) in Functional("probe", f"{name}*J").expression().free_symbols
    except GridgenError:
        return False


def compare_general(printed: PrintedEquation) -> Finding:
    """Compare a general Euler–Lagrange equation with the residuals of the functionals and of a general density."""
    cases = [
        (functional(name), variant) for name in _functionals_of_the_paper() for variant in ("plain", "differentiated")
    ]
    cases += [(GENERAL, "plain"), (GENERAL, "p:differentiated")]
    factors = set()
    for known, variant in cases:
        derived = euler_lagrange(known, variant)
        factors.add(_factor(read(printed.expressions[0], derived), derived.residual[printed.component]))
    if len(factors) != 1 or None in factors:
        return Finding(False, "differs", "other", sympy.S.Zero, "is not the derived equation of every functional")
    (factor,) = factors
    assert factor is not None
    return _multiple(factor, "the derived residual of every functional, and of a density in all variables and a field")


def compare_equation(printed: PrintedEquation) -> Finding:
    """Compare an Euler–Lagrange equation of one functional with both derived ones, those of its sum where it is one."""
    assert printed.functional is not None
    known = functional(printed.functional)
    scale = known.corner_factor if printed.of_sum else 1
    derived = [scale * part for part in euler_lagrange(known, "plain").residual]
    expression = read(printed.expressions[0])
    own, other = derived[printed.component], derived[1 - printed.component]
    factor = _factor(expression, own)
    if factor is not None:
        return _multiple(factor, "the derived equation")
    exchanged = _factor(expression, other)
    if exchanged is not None:
        here, there = ("x", "y") if printed.component == 0 else ("y", "x")
        text = f"printed in the place of the {here}-equation, it is {exchanged} times the {there}-equation"
        return Finding(True, "agrees in exchanged order", "exchanged", exchanged, text)
    return _other(expression, own)


def _factor(first: Expr, second: Expr) -> Expr | None:
    """Return the number first/second, if it is one: found from one coefficient, proved by expansion."""
    first, second = expand_metric(first), expand_metric(second)
    factor = _leading_factor(first, second)
    if factor is None or sympy.cancel(sympy.together(first - factor * second)) != 0:
        return None
    return factor


def _leading_factor(first: Expr, second: Expr) -> Expr | None:
    """Return the ratio of the first coefficients of a second derivative that are multiples of each other."""
    for derivative in SECOND_DERIVATIVES:
        above, below = sympy.diff(first, derivative), sympy.diff(second, derivative)
        if below != 0 and above != 0:
            ratio = sympy.cancel(above / below)
            if ratio.is_number:
                return ratio
    return None


def _multiple(factor: Expr, what: str) -> Finding:
    if factor == 1:
        return agreement()
    status = "agrees up to sign" if factor == -1 else "agrees up to a factor"
    return Finding(True, status, "multiple", factor, f"{factor} times {what}")


def _other(expression: Expr, derived: Expr) -> Finding:
    factor = _leading_factor(expand_metric(expression), expand_metric(derived)) or sympy.S.One
    difference = sympy.factor(sympy.cancel(expand_metric(expression - factor * derived)))
    times = "" if factor == 1 else f"{factor} times "
    return Finding(False, "differs", "other", difference, f"printed - {times}derived = {difference}")


def compare_integral(printed: PrintedEquation) -> Finding:
    """Compare the density of a printed integral with that of the functional, without a weight."""
    assert printed.functional is not None
    density = variant_density(functional(printed.functional), "plain")
    expression = read(printed.expressions[0])
    difference = expand_metric(expression - density).expand()
    if difference == 0:
        return agreement()
    if _is_null_lagrangian(expression):
        shown = sympy.factor(expression.subs(METRIC[J], J) - density)
        text = f"printed - derived = {shown}; the Euler–Lagrange equations of the printed density vanish identically"
        return Finding(False, "differs", "null Lagrangian", difference, text)
    return Finding(False, "differs", "other", difference, f"printed - derived = {sympy.factor(difference)}")


def _is_null_lagrangian(density: Expr) -> bool:
    """Return whether both Euler–Lagrange equations of a density in first derivatives vanish."""
    return all(sympy.expand(expand_metric(entry)) == 0 for entry in principal_symbol(density))


def compare_sum(printed: PrintedEquation) -> Finding:
    """Compare a corner energy with that of the project, and with the density of the integral."""
    assert printed.functional is not None
    known = functional(printed.functional)
    expression = read(printed.expressions[0])
    energy = corner_model(known, "frozen" if expression.has(s) else "plain").energy
    where, _ = equality(expression, energy)
    if where is None:
        difference = sympy.factor(expand_metric(expression - energy))
        return Finding(False, "differs", "other", difference, f"printed - derived = {difference}")
    if known.corner_factor != 1 and _is_printed_as_integral(printed.functional):
        factor = sympy.Integer(known.corner_factor)
        text = f"the sum is {factor} times the density of the integral"
        return Finding(True, "agrees up to a factor", "multiple of the integral", factor, text)
    return _where(where)


def _is_printed_as_integral(name: str) -> bool:
    """Return whether the paper prints an integral of a functional beside its sum."""
    return any(one.kind == "integral" and one.functional == name for one in PRINTED)


def compare_equality(printed: PrintedEquation) -> Finding:
    """Decide an equality of two expressions or matrices."""
    left, right = (read(text) for text in printed.expressions)
    if isinstance(left, sympy.MatrixBase):
        same = (left - right).applyfunc(lambda entry: sympy.expand(expand_metric(entry))).is_zero_matrix
        return agreement() if same else Finding(False, "differs", "other", sympy.S.Zero, "the matrices differ")
    where, difference = equality(left, right)
    if where is not None:
        return _where(where)
    if equality(left, right**2)[0] == "everywhere":
        text = f"printed - derived = {difference}: the left side is the square of the right side"
        return Finding(False, "differs", "square", difference, text)
    return Finding(False, "differs", "other", difference, f"left - right = {difference}")


def _where(where: str) -> Finding:
    if where == "everywhere":
        return agreement()
    return Finding(True, "holds where J > 0", "only where J > 0", sympy.S.Zero, "the sides differ in sign where J < 0")


def equality(left: Expr, right: Expr) -> tuple[str | None, Expr]:
    """Return where two sides are equal, `everywhere`, `J > 0` or nowhere (None), and their difference.

    Squares remove roots and absolute values. Sides with equal squares that are continuous where J > 0 have one
    relative sign there, because that set of matrices is connected: one point decides it.
    """
    left, right = expand_metric(left), expand_metric(right)
    difference = sympy.factor(left - right) if (left - right).is_rational_function() else left - right
    if _same(left, right):
        return "everywhere", sympy.S.Zero
    if not _same(left**2, right**2):
        return None, difference
    agree = [sympy.simplify((left - right).subs(corner)) == 0 for corner in (_UNFOLDED, _FOLDED)]
    return ("everywhere" if all(agree) else "J > 0" if agree[0] else None), difference


def _same(left: Expr, right: Expr) -> bool:
    parts: list[Any] = [[part.expand() for part in sympy.fraction(sympy.together(side))] for side in (left, right)]
    return bool(sympy.expand(parts[0][0] * parts[1][1] - parts[1][0] * parts[0][1]) == 0)


def compare_vectors(printed: PrintedEquation) -> Finding:
    """Compare covariant vectors with those of a linear map, up to their direction along the grid line."""
    entries = [sympy.expand(read(text)) for text in printed.expressions]
    pairs = ((x_xi, y_xi), (x_eta, y_eta))
    signs = []
    for vector, derived in zip((entries[:2], entries[2:]), pairs, strict=True):
        sign = next((c for c in (1, -1) if [c * part for part in derived] == vector), None)
        if sign is None:
            return Finding(False, "differs", "other", sympy.S.Zero, f"{vector} is not along a grid line")
        signs.append(sign)
    shown = ", ".join(f"{'+' if sign > 0 else '-'}g{i}" for i, sign in enumerate(signs, 1))
    return agreement(f"the printed vectors are {shown} of increasing xi and eta")


def compare_jacobian(printed: PrintedEquation) -> Finding:
    """Compare the determinant of a printed Jacobian matrix with J, on a linear map with J > 0."""
    matrix = sympy.Matrix(2, 2, [read(text) for text in printed.expressions])
    ratio = sympy.cancel(sympy.expand(matrix.det()) / METRIC[J])
    if ratio == 1:
        return agreement()
    if ratio == -1:
        return Finding(False, "differs", "reversed", ratio, "its determinant is -J: negative on a valid grid")
    return Finding(False, "differs", "other", ratio, f"its determinant is {ratio} times J")


def weight_minimum(weight: Expr) -> tuple[Expr, dict[Symbol, Expr]]:
    """Return the smallest value of a weight at multiples of 1/8 in the unit square, exactly, and where."""
    places = [{x: sympy.Rational(i, 8), y: sympy.Rational(j, 8)} for i in range(9) for j in range(9)]
    values = [sympy.sympify(weight.subs(place)) for place in places]
    best = min(range(len(places)), key=lambda i: float(values[i]))
    return values[best], places[best]
