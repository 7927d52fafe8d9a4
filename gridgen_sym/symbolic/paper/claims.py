"""Decide the claims that the paper makes in words: classification, bounds, barriers, parameters, weights."""

from __future__ import annotations

import sympy

from ...functionals import Functional, functional
from ...functionals.paper import PrintedEquation
from ..classify.classification import classify
from ..coordinates import J, expand_metric, g11, g12, g22, s, x_eta, x_xi, y_eta, y_xi
from ..definiteness import is_nonnegative
from ..derive.discrete import corner_model, has_barrier, variant_density
from .comparison import agreement, weight_minimum
from .errata import Finding
from .notation import read
from .sums import compare_each, compare_inner_sum, negative_weight_bounds

_t = sympy.Symbol("t", positive=True)
_r1, _r2 = sympy.symbols("r1 r2", positive=True)
_angle, _turn = sympy.symbols("theta turn", real=True)


def refutation(text: str) -> Finding:
    """Return the finding of a claim that does not hold."""
    return Finding(False, "claim refuted", "other", sympy.S.Zero, text)


def compare_classification(printed: PrintedEquation) -> Finding:
    """Compare the words of a classification with the derived one."""
    assert printed.functional is not None
    words = classify(functional(printed.functional)).words()
    known = {*words, *(() if words[2] == "elliptic" else ("non-elliptic",))}
    wrong = [word for word in printed.expressions if word not in known]
    derived = ", ".join(words)
    return refutation(f"{', '.join(wrong)}: derived {derived}") if wrong else agreement(f"derived: {derived}")


def compare_inequality(printed: PrintedEquation) -> Finding:
    """Prove left side >= right side in the eigenvalues of the metric tensor, squares of positive numbers."""
    first, second = sympy.symbols("sigma_1 sigma_2", positive=True)
    invariants = {g11: first**2, g22: second**2, g12: 0, J: first * second}
    left, right = (read(text).subs(invariants) for text in printed.expressions)
    difference = sympy.factor(sympy.simplify(_unroot(left, first, second) - right))
    if is_nonnegative(difference, (first, second)):
        return agreement(f"with lambda_i = sigma_i², left - right = {difference}")
    return refutation(f"left - right = {difference} is not provably non-negative")


def _unroot(expression: sympy.Expr, first: sympy.Symbol, second: sympy.Symbol) -> sympy.Expr:
    """Take roots in an expression symmetric in the eigenvalues: the larger one is the first."""
    gap = sympy.Symbol("gap", positive=True)
    taken = sympy.simplify(expression.subs(first, second + gap))
    return sympy.simplify(taken.subs(gap, first - second))


def compare_parameters(printed: PrintedEquation) -> Finding:
    """Check that the combined functional with the printed parameters is the named one."""
    assert printed.functional is not None
    names = (read(name) for name in ("k_A", "k_L", "k_O"))
    values = dict(zip(names, (read(text) for text in printed.expressions), strict=True))
    combined = variant_density(functional("combined"), "plain").subs(values)
    difference = sympy.expand(expand_metric(combined - variant_density(functional(printed.functional), "plain")))
    if difference == 0:
        return agreement("the combined sum is then that of g11*g22/2")
    return Finding(False, "differs", "other", difference, f"combined - {printed.functional} = {difference}")


def compare_weight(printed: PrintedEquation) -> Finding:
    """Decide whether a weight is non-negative, by signs of terms or by an exact witness."""
    weight = read(printed.expressions[0])
    least, place = weight_minimum(weight)
    if least < 0:
        where = ", ".join(f"{name} = {value}" for name, value in place.items())
        text = f"s = {least} at {where}: there larger cells have less energy; {negative_weight_bounds(least)}"
        return Finding(False, "claim refuted", "negative weight", least, text)
    return agreement("non-negative, term by term") if weight.is_nonnegative else refutation("its sign is not known")


def compare_angle(printed: PrintedEquation) -> Finding:
    """Decide whether a quantity measures the angle between g1 and g2: it depends on nothing else."""
    vectors = {x_xi: _r1 * sympy.cos(_turn), y_xi: _r1 * sympy.sin(_turn)}
    vectors |= {x_eta: _r2 * sympy.cos(_turn + _angle), y_eta: _r2 * sympy.sin(_turn + _angle)}
    printed_text = printed.expressions[0]
    value = sympy.trigsimp(sympy.factor(expand_metric(read(printed_text)).subs(vectors)))
    text = f"with |g1| = r1, |g2| = r2 and the angle theta, {printed_text} = {value}"
    if value.free_symbols == {_angle}:
        return agreement(text)
    doubled = sympy.simplify(value.subs({_r1: 2 * _r1, _r2: 2 * _r2}, simultaneous=True) / value)
    return Finding(False, "claim refuted", "not normalized", doubled, f"{text}: {doubled} times at twice the lengths")


def compare_claim(printed: PrintedEquation) -> Finding:
    """Decide a claim of one functional."""
    word, *rest = printed.expressions
    assert printed.functional is not None
    known = functional(printed.functional)
    if word == "constraints":
        missing = set(rest) ^ set(known.constraints)
        return (
            refutation(f"conditions differ: {missing}") if missing else agreement("the constraints of the functional")
        )
    if word in ("barrier", "no barrier"):
        return (
            agreement()
            if has_barrier(known) == (word == "barrier")
            else refutation("the limit at J = 0 says otherwise")
        )
    if word == "infinite where cells degenerate":
        return _compare_degenerate(known)
    if word == "unfolded by the sum over inner nodes":
        return compare_inner_sum(known)
    if word == "minimizes each corner":
        return compare_each(known)
    if word == "non-negative":
        return agreement("a square") if _is_bounded_below_by_zero(printed) else refutation("negative somewhere")
    return _compare_beyond_barrier(printed)


def _compare_degenerate(known: Functional) -> Finding:
    """Decide 'infinite where |J| -> 0' on the cells g1 = (1, 0), g2 = (0, t), and on those that shrink, t g1 and g2."""
    energy = expand_metric(corner_model(known, "plain").energy).subs({y_xi: 0, x_eta: 0})
    closing, shrinking = (sympy.limit(energy.subs({x_xi: first, y_eta: _t}), _t, 0, "+") for first in (sympy.S.One, _t))
    if closing != sympy.oo:
        return refutation(f"g1 = (1, 0), g2 = (0, t) has energy {closing} as t -> 0")
    if shrinking == sympy.oo:
        return agreement()
    text = f"g1 = (t, 0), g2 = (0, t) has energy {shrinking} as t -> 0; g1 = (1, 0), g2 = (0, t) has {closing}"
    condition = "claim holds under a condition: the edges do not all shrink"
    return Finding(False, condition, "finite where shrinking", shrinking, text)


def _is_bounded_below_by_zero(printed: PrintedEquation) -> bool:
    assert printed.functional is not None
    return is_nonnegative(expand_metric(variant_density(functional(printed.functional), "plain")), (s,))


def _compare_beyond_barrier(printed: PrintedEquation) -> Finding:
    """Decide 'bounded below' and 'unfolded' where J < 0 too, on the cells g1 = (1, 0), g2 = (0, J)."""
    assert printed.functional is not None
    energy = corner_model(functional(printed.functional), "plain").energy
    bound = classify(functional(printed.functional)).lower_bound
    cell = expand_metric(energy).subs({x_xi: 1, y_xi: 0, x_eta: 0}).subs(y_eta, J)
    limit = sympy.limit(cell, J, 0, "-")
    witness = f"g1 = (1, 0), g2 = (0, J) has energy {cell.subs(J, -1)} at J = -1 and tends to {limit} as J -> 0-"
    if limit == -sympy.oo:
        text = f"{witness}; where J > 0 the bound {bound.value} is {bound.proof}"
        return Finding(False, "claim holds under a condition: J > 0", "unbounded where folded", limit, text)
    if printed.expressions[0] == "bounded below":
        return agreement(f"bound {bound.value}")
    text = f"{witness}: a folded cell has finite energy and stays behind the barrier"
    return Finding(False, "claim holds under a condition: J > 0", "finite where folded", cell.subs(J, -1), text)
