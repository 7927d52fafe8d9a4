"""max, min, where, sign, acos, asin, atan2 in a density: read, refused, derived, classified and reported."""

from __future__ import annotations

import mpmath
import pytest
import sympy
from support import close, evaluate, metric_values

from gridgen_sym import GridgenError, define
from gridgen_sym.functionals import Functional
from gridgen_sym.functionals.choices import CHOICES, branches
from gridgen_sym.symbolic import classify, corner_model, derive_latex, derive_text, euler_lagrange, has_barrier
from gridgen_sym.symbolic.coordinates import J, g11, g22
from gridgen_sym.symbolic.definiteness import almost_everywhere

#: Each names its terms so that corners of areas 0.5 and 2 and both signs of g12 take all branches.
DENSITIES = [
    *("max(g11, g22)*J", "max(J, 1, g11 - 1/3)**2", "min(g12, J - 1)*g22", "max(0, 1 - J)**2 + min(J, 1)**3"),
    *("where(J > 1, J**2, g11)", "where(J > 1, log(J - 1), g12)*g11", "where(g12 < 0, 1/J, sqrt(g12)*J)"),
    *("sign(J - 1)*J*g11", "acos(g12/sqrt(g11*g22))**2*J", "asin(g12/sqrt(2*g11*g22))/J", "atan2(J, g12)**2*g22"),
    "where(J <= 1, where(g12 >= 0, J, g11**2), max(g12, 0)*min(J, g22))",
]
QUICK = {DENSITIES[k] for k in (0, 2, 5, 7, 10)}
CORNERS = [(1.1, 0.2, 0.3, 0.5), (1.2, 0.1, -0.4, 0.6), (1.7, 0.2, 0.4, 1.3), (1.3, 0.1, -0.6, 1.8)]


def text(density):
    return Functional("chosen", density).expression()


@pytest.mark.parametrize(
    ("density", "function", "printed"),
    [
        ("max(g11, g22, 1)", lambda m: m.max(m.g11, m.g22, 1), "max(g11, g22, 1)"),
        ("max(0, 0.5 - J)**2", lambda m: m.max(0, 0.5 - m.J) ** 2, "max(0, 1/2 - J)**2"),
        ("min(J, 2)", lambda m: m.min(m.J, 2), "min(J, 2)"),
        ("where(J > 1, J, g11)", lambda m: m.where(m.J > 1, m.J, m.g11), "where(J > 1, J, g11)"),
        ("where(J >= 1, J, g11)", lambda m: m.where(m.J >= 1, m.J, m.g11), "where(J < 1, g11, J)"),
        ("where(1 > J, J, g11)", lambda m: m.where(m.J < 1, m.J, m.g11), "where(J < 1, J, g11)"),
        ("where(g11 <= g22, J, 1)", lambda m: m.where(m.g11 <= m.g22, m.J, 1), "where(g22 < g11, 1, J)"),
        ("acos(g12) + asin(J)", lambda m: m.acos(m.g12) + m.asin(m.J), "acos(g12) + asin(J)"),
        ("atan2(J, g12)*sign(J)", lambda m: m.atan2(m.J, m.g12) * m.sign(m.J), "atan2(J, g12)*sign(J)"),
        ("max(g12, J)", lambda m: sympy.Max(m.J, m.g12), "max(g12, J)"),
        ("where(J > 1, J, 2)", lambda m: sympy.Piecewise((m.J, m.J > 1), (2, True)), "where(J > 1, J, 2)"),
    ],
)
def test_a_text_and_a_function_are_the_same_density(density, function, printed):
    read, called = text(density), Functional("chosen", function).expression()
    assert called in (read, text("max(J, g12)"))  # SymPy's Max forgets the order.
    assert str(read) == printed
    assert text(printed) == read


@pytest.mark.parametrize(
    ("density", "message"),
    [
        ("where(0 < J < 1, J, 1)", "the condition '0 < J < 1': it must be one comparison.* nest: where"),
        ("where(J > 0 and J < 1, J, 1)", "the condition 'J > 0 and J < 1': it must be one comparison"),
        ("where(J == 1, J, 1)", "the condition 'J == 1': .* instead of ==, give a tolerance"),
        ("where(J != 1, J, 1)", "the condition 'J != 1': it must be one comparison"),
        ("where(J, J, 1)", "the condition 'J': it must be one comparison"),
        ("(J > 1)*g11", "the comparison 'J > 1': a comparison is no value; write where"),
        ("where(J > 1, J)", r"where takes a comparison and two values, and 2 came; write where\(a < b, p, q\)"),
        ("max(J)", r"max takes two arguments or more, and 1 came; write max\(a, b\)"),
        ("atan2(J)", "atan2 takes two arguments, and 1 came"),
        ("acos(2 + J)", "it must be real and finite wherever J > 0"),
        (lambda m: max(m.J, 1), "instead of Python's max and min"),
        (lambda m: m.J if m.J > 1 else 1, "write m.where.* instead of if"),
        (lambda m: m.where(0 < m.J < 1, m.J, 1), "of a chain such as 0 < m.J < 1"),
        (lambda m: m.where(m.J == 1, m.J, 1), "the condition False: it must be one comparison"),
        (lambda m: m.where((m.J > 1) & (m.g11 > 1), m.J, 1), "it must be one comparison"),
        (lambda m: m.where(sympy.Eq(m.J, 1), m.J, 1), "it must be one comparison"),
        (lambda m: m.max(m.J), "cannot be evaluated on symbols"),
        (lambda m: sympy.Piecewise((m.J, m.J > 1)), "uses Piecewise, for which there is no kernel"),
    ],
)
def test_what_is_no_choice_is_refused_with_the_repair(density, message):
    with pytest.raises(GridgenError, match=message):
        define("refused", density)


@pytest.mark.parametrize(
    ("density", "order", "term"),
    [
        ("g11 + sqrt(max(0, J - 1))", "first", "sqrt(max(0, J - 1))"),
        ("g11 + max(0, J - 1)**1.5", "second", "max(0, J - 1)**(3/2)"),
        ("where(J > 1, 1, sqrt(max(0, J - 1)))*g11", "first", "sqrt(max(0, J - 1))"),
        ("atan2(max(0, -J), min(0, g11))", "first", "atan2(max(0, -J), min(0, g11))"),
        ("acos(max(1, cos(g12)))", "first", "acos(max(1, cos(g12)))"),
        ("where(J < 0, sqrt(max(0, -g22)), sqrt(max(0, -g11)))", "first", "sqrt(max(0, -g11))"),
    ],
)
def test_a_branch_without_derivatives_where_it_holds_is_refused_with_the_term(density, order, term):
    with pytest.raises(GridgenError, match=f"no {order} derivative on the valid corner") as error:
        define("rough", density)
    assert f"because of the term {term}: " in str(error.value)
    assert "or choose: where(u > 0, sqrt(u), 0)" in str(error.value)


@pytest.mark.parametrize(
    "density",
    [
        "where(J > 1, sqrt(J - 1), 0)*g11 + g22",
        "where(J > 0, log(J), 0)",
        "where(J < 1, g11, sqrt(max(0, J - 1)))",
        "where(J > 1, sqrt(max(0, J - 1)), g11)",
        "g11 + acos(g12/sqrt(g11*g22))",
        "max(0, 1 - J)**2 + sign(J - 1)",
    ],
)
def test_a_branch_without_derivatives_where_it_does_not_hold_is_allowed(density):
    define("chosen", density)


# ---- derivatives ----


def at(corner):
    names = dict(zip(("x_xi", "y_xi", "x_eta", "y_eta"), map(mpmath.mpf, corner), strict=True))
    return metric_values(names)


def differences(function, corner):
    """Return the 4 central differences of a function of corners, good to 24 digits."""
    step = mpmath.mpf(10) ** -13
    moved = [[[c + way * step * (k == i) for i, c in enumerate(corner)] for way in (1, -1)] for k in range(4)]
    return [(function(ahead) - function(behind)) / (2 * step) for ahead, behind in moved]


@pytest.mark.parametrize(
    "density", [one if one in QUICK else pytest.param(one, marks=pytest.mark.slow) for one in DENSITIES]
)
def test_derivatives_are_those_of_the_branch_at_every_corner(density):
    model = corner_model(Functional("chosen", density))
    gradient = [almost_everywhere(part) for part in model.gradient]
    with mpmath.workdps(50):
        for corner in CORNERS:
            corner = [*map(mpmath.mpf, corner)]
            slopes = differences(lambda place: evaluate(model.energy, at(place)), corner)
            for part, slope in zip(gradient, slopes, strict=True):
                assert close(evaluate(part, at(corner)), slope, mpmath.mpf(10) ** -20)
            for k, part in enumerate(gradient):
                curves = differences(lambda place, part=part: evaluate(part, at(place)), corner)
                for q, curve in enumerate(curves):
                    found = evaluate(almost_everywhere(model.hessian[k, q]), at(corner))
                    assert close(found, curve, mpmath.mpf(10) ** -20)


def test_the_corners_take_all_branches():
    """Else a wrong derivative of one would not be seen."""
    taken = {density: set() for density in DENSITIES}
    for density in DENSITIES:
        compared = [part.as_choice().args[:2] for part in text(density).atoms(*CHOICES)]
        for corner in CORNERS:
            for pair in compared:
                left, right = (evaluate(side, at(corner)) for side in pair)
                taken[density].add((pair, left < right))
        assert len(taken[density]) == 2 * len({*compared}), density


def test_equations_are_derived_by_branches():
    """Where J > 1 they are those of J**2/2, elsewhere those of the length."""
    whole, *parts = (
        euler_lagrange(Functional("chosen", density)).residual
        for density in ("where(J > 1, J**2/2, (g11 + g22)/2)", "J**2/2", "(g11 + g22)/2")
    )
    for component in (0, 1):
        for one, other in zip(branches(whole[component]), parts, strict=True):
            assert sympy.expand(one - other[component]) == 0


# ---- classification and report ----


@pytest.mark.slow
@pytest.mark.parametrize(
    ("density", "degree", "exchange", "bound", "barrier"),
    [
        ("max(g11, g22)", 2, True, 0, False),
        pytest.param("max(g11, g22)/J", 0, True, 0, True, marks=pytest.mark.slow),
        ("where(g11 > g22, g11**2, g22*J)", 4, False, None, False),
        ("max(0, 1 - J)**2", None, True, 0, False),
        ("where(J < 1, 1/J, 1)", None, True, None, True),
        ("where(J < 1, 1, 1/J)", None, True, None, False),
        ("min(1/J, 5) + g11", None, False, None, False),
    ],
)
def test_choices_are_classified(density, degree, exchange, bound, barrier):
    functional = Functional("chosen", density)
    found = classify(functional)
    assert (found.scaling_degree, found.exchange) == (degree, exchange)
    assert has_barrier(functional) is barrier
    if bound is not None:
        assert (found.lower_bound.value, found.lower_bound.proof) == (bound, "proved")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("density", "holds", "proof"),
    [
        *(("max(J, 1)", True, "proved"), ("max(g11, g22)", True, "proved"), ("max(g11, g22) + g11/J", True, "proved")),
        *(("(g11 + g22)/J + max(0, 1 - J)**2", True, "proved"), ("max(0, 1 - J)**3", True, "sampled")),
        *(("where(J > 1, J, 1)", True, "sampled"), ("where(J > 1, (J - 1)**2, 0)", True, "sampled")),
        *(("sign(J - 1)*(J - 1)", True, "sampled"), ("max(g11, g22, J)", True, "sampled")),
        *(("min(J, 1)", False, "refuted"), ("min(g11, g22)", False, "refuted"), ("-max(J, 1)", False, "refuted")),
        *(("where(J > 1, 1, J)", False, "refuted"), ("where(J > 1, J**2, 0)", False, "refuted")),
        *(("sign(J - 1)", False, "refuted"), ("max(0, 1 - J)**2*g11", False, "refuted")),
    ],
)
def test_convexity_counts_branches_kinks_and_jumps(density, holds, proof):
    found = corner_model(Functional("chosen", density)).splitting
    assert (found.holds, found.proof) == (holds, proof)


@pytest.mark.slow
def test_a_report_has_the_branches_in_words_and_in_latex():
    functional = Functional("chosen", "max(g11, g22) + where(J > 1, J**2, J)")
    report, formulas = derive_text(functional), derive_latex(functional)
    assert "F = where(J > 1, J**2, J) + max(g11, g22)" in report
    for tie in ("g11 - g22", "J - 1"):
        assert f"The first derivatives of F jump or do not exist where {tie} = 0: " in report
    assert r"\max(g_{11}, g_{22})" in formulas
    assert r"\begin{cases} J^{2} & \text{if } J > 1 \\ J & \text{otherwise} \end{cases}" in formulas
    assert r"$\theta_{1} = 1$ where $J > 1$, $\theta_{2} = 1$ where $g_{11} < g_{22}$, and each is 0" in formulas
    assert "choice" not in report + formulas


@pytest.mark.slow
def test_products_of_one_comparison_are_one_choice_for_readers():
    report = derive_text(Functional("chosen", "max(0, 1 - J)**2 + sign(J - 2)*J + abs(J - 3)"))
    assert "dE/dx_xi = y_eta*(where(J < 1, 2*J - 2, 0) + sign(J - 3) + sign(J - 2))\n" in report
    assert "DiracDelta" not in report


def test_branches_decide_a_comparison_the_same_everywhere():
    both = branches(text("max(g11, g22) - where(g22 > g11, g22, g11)*where(g22 < g11, 1, J)"))
    assert both == [g22 - g22 * J, g11 - g11]
    assert branches(text(" + ".join(f"max(J, {k})" for k in range(2, 9)))) is None
