"""Write derived expressions as a reader would: in the metric where that is shorter, terms in the order of the paper."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache

import sympy
from sympy import Expr, Symbol

from ...functionals.choices import CHOICES, choice
from ...functionals.metric import symbol
from ..coordinates import SECOND_DERIVATIVES, expand_metric, g11, g22
from ..definiteness import almost_everywhere, degree_bound, is_high
from ..derive.in_metric import in_metric

#: More operations than this, and an expression is left as it was derived: factoring it would take too long.
_LARGEST = 600
#: Where the degree in the first derivatives is higher than this, as for those below.
_HIGHEST = 6
_LARGEST_FACTORED = 2000
#: The metric is written out up to this size, and where the degree is not high: factors in four variables take long.
_LARGEST_WRITTEN = 100
#: Expressions with roots and more symbols than this are not factored.
_MOST_SYMBOLS = 7
#: A sum within three others counts as so many operations.
_NESTED = 8
_TRACE = symbol("trace")


@lru_cache(maxsize=1024)
def tidy(expression: Expr) -> Expr:
    """Return the shortest of several ways to write an expression: as derived, factored, or factored in the metric.

    Impulses at kinks and jumps are left out: the report says where those are.
    """
    expression, roots = _without_roots(_merged(almost_everywhere(sympy.sympify(expression))))
    size = sympy.count_ops(expression)
    if not _is_short(expression):
        return expression.subs(roots)
    if roots and len(expression.free_symbols) > _MOST_SYMBOLS:
        return min((expression, sympy.factor_terms(sympy.together(expression))), key=_effort).subs(roots)
    single = [sympy.factor(expression)]
    if expression.has(g11) and expression.has(g22):
        single.append(sympy.factor(expression.subs(g11, _TRACE - g22)).subs(_TRACE, g11 + g22))
    if size <= _LARGEST_WRITTEN and not is_high([expression]):
        single.append(in_metric(sympy.factor(expand_metric(expression))))
    return min((expression, *map(sympy.factor_terms, single)), key=_effort).subs(roots)


def _is_short(expression: Expr) -> bool:
    """Return whether an expression is a quotient of polynomials that are factored quickly."""
    largest = _LARGEST if degree_bound(expression) <= _HIGHEST else _LARGEST_WRITTEN
    rational = expression.is_rational_function(*expression.free_symbols)
    return bool(rational) and bool(sympy.count_ops(expression) <= largest)


def _effort(expression: Expr) -> int:
    """Return how hard an expression is to read: its operations, and what is nested within brackets of brackets."""
    return int(sympy.count_ops(expression)) + _NESTED * max(0, _sums_within(expression) - 3)


def _sums_within(expression: Expr) -> int:
    """Return how many sums are within each other at most."""
    return max(map(_sums_within, expression.args), default=0) + bool(expression.is_Add)


def _without_roots(expression: Expr) -> tuple[Expr, dict[Symbol, Expr]]:
    """Return the expression with a symbol for every square root, and what the symbols stand for."""
    halves = [power for power in expression.atoms(sympy.Pow) if power.exp.is_Rational and power.exp.q == 2]
    bases = sorted({power.base for power in halves}, key=sympy.default_sort_key)
    roots = {sympy.Dummy(f"root_{k}", positive=True): sympy.sqrt(base) for k, base in enumerate(bases)}
    names = {base: name for name, base in zip(roots, bases, strict=True)}
    whole = {power: names[power.base] ** (2 * power.exp) for power in halves}
    return expression.xreplace(whole), roots


def _merged(expression: Expr) -> Expr:
    """Return an expression with every product of choices by the same comparison as one choice."""
    if not expression.has(choice):
        return expression
    powers = expression.replace(
        lambda part: part.is_Pow and isinstance(part.base, choice),
        lambda part: choice(*part.base.args[:2], *(value**part.exp for value in part.base.args[2:])),
    )
    return powers.replace(sympy.Mul, _merged_product)


def _merged_product(*factors: Expr) -> Expr:
    number, result = sympy.S.One, sympy.S.One
    branched: dict[tuple[Expr, Expr], list[Expr]] = {}
    for factor in factors:
        if isinstance(factor, CHOICES):
            branched.setdefault(factor.as_choice().args[:2], []).append(factor)
        elif factor.is_Rational:
            number = factor
        else:
            result *= factor
    for sides, found in branched.items():
        if any(isinstance(part, choice) for part in found):
            values = zip(*(part.as_choice().args[2:] for part in found), strict=True)
            result *= choice(*sides, *(number * sympy.prod(of_branch) for of_branch in values))
            number = sympy.S.One
        else:
            result *= sympy.prod(found)
    return number * result


def tidy_quadratic(expression: Expr, first: Symbol, second: Symbol) -> Expr:
    """Return a quadratic form in two variables with tidy coefficients, and with what they have in common taken out."""
    if _is_short(expression):
        terms = sympy.Poly(expression, first, second).terms()
        coefficients = {first**m * second**n: factor for (m, n), factor in terms}
    else:
        one, zero = sympy.S.One, sympy.S.Zero
        coefficients = {
            first**2: expression.xreplace({first: one, second: zero}),
            first * second: sympy.diff(expression, first, second).xreplace({first: zero, second: zero}),
            second**2: expression.xreplace({first: zero, second: one}),
        }
    return without_common_terms(sympy.Add(*(monomial * tidy(factor) for monomial, factor in coefficients.items())))


def without_common_terms(expression: Expr) -> Expr:
    """Return an expression with what its terms have in common taken out, unless it is long: that would take seconds."""
    return expression if sympy.count_ops(expression) > _LARGEST_FACTORED else sympy.factor_terms(expression)


def paper_order(component: int) -> tuple[Symbol, ...]:
    """Return the second derivatives as the paper orders the terms of an equation: along xi, mixed, along eta.

    In each pair the equation's own unknown comes first: x in equation 0, y in equation 1.
    """
    first, second = SECOND_DERIVATIVES[:3], SECOND_DERIVATIVES[3:]
    own, other = (first, second) if component == 0 else (second, first)
    return tuple(derivative for pair in zip(own, other, strict=True) for derivative in pair)


def common_factor(expressions: Iterable[Expr]) -> Expr:
    """Return the number and the denominators of names that all the expressions have in common."""
    present = [expression for expression in expressions if expression != 0]
    numbers = [expression.as_content_primitive()[0] for expression in present]
    powers = [sympy.fraction(expression)[1].as_powers_dict() for expression in present]
    names = sorted({base for power in powers for base in power if base.is_Symbol}, key=str)
    # What divides some of them only belongs to those.
    least = {name: min(power.get(name, sympy.S.Zero) for power in powers) for name in names}
    return sympy.gcd_list(numbers or [1]) / sympy.prod(name**power for name, power in least.items())
