"""The errata are found by comparison, and an equation altered on purpose is objected to."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import sympy

import gridgen_sym as gg
from gridgen_sym.functionals import definition
from gridgen_sym.functionals.metric import DENSITY_NAMES, symbol
from gridgen_sym.functionals.paper import PRINTED
from gridgen_sym.symbolic import euler_lagrange, verify
from gridgen_sym.symbolic.coordinates import eta, x, y
from gridgen_sym.symbolic.paper import interpolation, small_grid
from gridgen_sym.symbolic.paper.comparison import GENERAL
from gridgen_sym.symbolic.paper.notation import read

BY_KEY = {equation.key: equation for equation in PRINTED}
EXPECTED = {
    "E1": {"area-integral-2"},
    "E2": {"area-divergence-1", "area-divergence-2"},
    "E3": {"area-expanded-2"},
    "E5": {"jacobian-k2", "jacobian-k4"},
    "E6": {"winslow-unfolded", "winslow-bounded", "modified-liao-unfolded"},
    "E7": {"frobenius-norm"},
    "E8": {"weight-2"},
    "E9": {"area-sum", "length-sum", "orthogonality-sum"},
    "E10": {"winslow-inner-nodes"},
    "E11": {"winslow-degenerate", "modified-liao-degenerate"},
    "E12": {"metric-length"},
    "E13": {"metric-angle"},
    "E14": {"winslow-minimum", "modified-liao-minimum"},
}


@pytest.fixture(scope="module")
def verdicts():
    return {verdict.equation.key: verdict for verdict in verify()}


def test_keys_are_unique():
    assert len(BY_KEY) == len(PRINTED)


@pytest.mark.slow
@pytest.mark.parametrize("key", EXPECTED)
def test_each_erratum_is_found_where_it_stands(verdicts, key):
    assert {name for name, verdict in verdicts.items() if verdict.erratum == key} == EXPECTED[key]


@pytest.mark.slow
def test_nothing_else_differs(verdicts):
    assert not [name for name, verdict in verdicts.items() if verdict.is_discovery]


@pytest.mark.slow
def test_the_difference_of_e3(verdicts):
    expected = read("x_etaeta*y_xi*(x_xi - y_xi)")
    assert sympy.expand(verdicts["area-expanded-2"].difference - expected) == 0


@pytest.mark.slow
def test_a_condition_is_not_plain_agreement(verdicts):
    conditional = {name for name, verdict in verdicts.items() if verdict.status == "holds where J > 0"}
    assert conditional == {"norm-of-inverse", "winslow-sum-3", "eigenvalues"}
    plain = {name for name, verdict in verdicts.items() if verdict.is_plain}
    assert plain == set(verdicts) - conditional - set().union(*EXPECTED.values())


def test_a_known_error_in_another_place_is_a_discovery():
    copies = (("weight-2", "weight-1"), ("frobenius-norm", "condition-number"), ("jacobian-k2", "jacobian-k1"))
    for source, place in copies:
        (verdict,) = verify([replace(BY_KEY[source], key=place)])
        assert not verdict.agrees
        assert verdict.is_discovery


@pytest.mark.slow
def test_witnesses(verdicts):
    assert verdicts["weight-2"].difference == -195
    assert verdicts["winslow-bounded"].difference == -sympy.oo


@pytest.mark.slow
def test_the_minimum_of_the_sum_over_inner_nodes(verdicts):
    """The known answer: (0.310, 0.676), energy 17.25, J = -0.053, although a valid grid exists."""
    found = verdicts["winslow-inner-nodes"]
    assert float(found.difference) == pytest.approx(-0.053, abs=5e-4)
    for words in ("at (0.310, 0.676) with energy 17.25", "has J = -0.053", "where J >= 0.0155"):
        assert words in found.text


@pytest.mark.slow
def test_the_least_energy_of_shrinking_cells(verdicts):
    assert verdicts["winslow-degenerate"].difference == 2
    assert verdicts["modified-liao-degenerate"].difference == 4


@pytest.mark.slow
def test_the_combination_is_one_of_sums(verdicts):
    """Section 2.4 combines sums, which have no 1/2: ½ (J² + g12²) = ½ g11 g22, whose equations are printed."""
    for key in ("combined-sum", "knupp-expanded-1", "knupp-expanded-2"):
        assert verdicts[key].is_plain
    (verdict,) = verify([replace(BY_KEY["knupp-expanded-1"], of_sum=False)])
    assert (verdict.difference, verdict.is_discovery) == (2, True)


@pytest.mark.slow
def test_exchanged_equations_are_right_as_a_pair_and_a_discovery_elsewhere(verdicts):
    for key in ("area-divergence-1", "area-divergence-2"):
        assert (verdicts[key].agrees, verdicts[key].erratum) == (True, "E2")
        assert "as a pair they are right" in verdicts[key].text
    (verdict,) = verify([replace(BY_KEY["length-expanded-1"], component=1)])
    assert verdict.status == "agrees in exchanged order"
    assert verdict.is_discovery


def altered(key, old, new):
    equation = BY_KEY[key]
    texts = tuple(text.replace(old, new, 1) for text in equation.expressions)
    assert texts != equation.expressions
    (verdict,) = verify([replace(equation, expressions=texts)])
    return verdict


@pytest.mark.slow
@pytest.mark.parametrize(
    ("key", "old", "new"),
    [
        ("euler-lagrange-1", "- D_xi", "+ D_xi"),
        ("area-expanded-1", "- 2.0*", "+ 2.0*"),
        ("area-expanded-1", "2.0*", ""),
        ("length-expanded-1", "+", "-"),
        ("length-expanded-2", "y_xixi", "2*y_xixi"),
        ("orthogonality-expanded-1", "4*", "2*"),
        ("orthogonality-expanded-2", "+ 2*x_xi", "- 2*x_xi"),
        ("orthogonality-divergence-1", "+", "-"),
        ("knupp-expanded-1", "4*", "2*"),
        ("knupp-expanded-2", "+ 2*", "- 2*"),
        ("length-integral-2", "+ y_xi", "- y_xi"),
        ("orthogonality-integral-3", "/2", ""),
        ("winslow-sum-1", "+", "-"),
        ("liao-sum", "+ 2*", "+ "),
        ("modified-liao-sum-1", "))**2", "))"),
        ("metric-12", "g2", "g1"),
        ("metric-angle", "g12", "g12/g11"),
        ("metric-length", "g11", "2*g11"),
        ("metric-matrix", "g21", "-g21"),
        ("metric-determinant", "**2", ""),
        ("eigenvalues", "+ lambda_2", "- lambda_2"),
        ("eigenvalue-bound", "2.0", "2.1"),
        ("vectors-k1", "x_4", "x_1"),
        ("jacobian-k1", "x_4", "x_3"),
        ("jacobian-k4", "x_4 - x_k", "x_k - x_4"),
        ("knupp-parameters", "0.0", "0.1"),
        ("area-classification", "non-elliptic", "elliptic"),
        ("length-classification", "uncoupled", "coupled"),
        ("weight-1", "200", "-200"),
        ("liao-folds", "no barrier", "barrier"),
        ("winslow-barrier", "barrier", "no barrier"),
        ("combined-parameters", "k_L >= 0", "k_L >= 1"),
        ("combined-sum", "k_L*", "2*k_L*"),
    ],
)
def test_an_altered_equation_is_objected_to(key, old, new):
    verdict = altered(key, old, new)
    assert not verdict.agrees
    assert verdict.erratum is None
    assert verdict.is_discovery


def test_a_lost_factor_is_reported_with_the_factor():
    verdict = altered("length-expanded-1", "x_xixi + x_etaeta", "3*x_xixi + 3*x_etaeta")
    assert (verdict.status, verdict.difference, verdict.erratum) == ("agrees up to a factor", 3, None)
    assert verdict.is_discovery


def test_the_corrected_equations_agree():
    assert altered("area-expanded-2", "y_xi*y_xi*x_etaeta", "x_xi*y_xi*x_etaeta").status == "agrees"
    assert altered("frobenius-norm", "norm(A)", "norm(A)**2").status == "agrees"
    assert altered("metric-length", "norm(g1)", "norm(g1)**2").status == "agrees"
    assert altered("metric-angle", "g12", "g12/sqrt(g11*g22)").status == "agrees"
    assert altered("weight-2", "(sin(2*pi*x)*sin(2*pi*y))", "abs(sin(2*pi*x)*sin(2*pi*y))").agrees
    assert altered("area-integral-2", "x_xi*y_eta - x_eta*y_xi", "(x_xi*y_eta - x_eta*y_xi)**2/2").status == "agrees"


def test_a_different_error_in_the_place_of_e3_is_a_discovery():
    verdict = altered("area-expanded-2", "y_xi*y_xi*x_etaeta", "2*x_xi*y_xi*x_etaeta")
    assert verdict.is_discovery


def test_equation_1_is_judged_by_what_a_density_may_name(monkeypatch):
    (verdict,) = verify([BY_KEY["functional"]])
    assert verdict.is_plain
    monkeypatch.setattr(definition, "DENSITY_NAMES", tuple(name for name in DENSITY_NAMES if name not in ("xi", "y")))
    (verdict,) = verify([BY_KEY["functional"]])
    assert (verdict.status, verdict.is_plain) == ("holds without xi, y", False)


def test_the_general_equations_are_those_of_a_density_in_all_variables():
    general = euler_lagrange(GENERAL, "p:differentiated")
    density = GENERAL.expression()
    names = {str(name) for name in density.free_symbols}
    assert names >= {*BY_KEY["functional"].expressions, "p"}
    p_x, p_y = map(symbol, ("p_x", "p_y"))
    for source, name, slope in zip(general.sources, (x, y), (p_x, p_y), strict=True):
        assert sympy.expand(source - density.diff(name) - density.diff(symbol("p")) * slope) == 0


def test_what_the_winslow_sum_minimizes():
    """The minima of the sums of K and of K² differ, and at neither is the largest K smallest."""
    first, second = verify([BY_KEY["winslow-minimum"], BY_KEY["modified-liao-minimum"]])
    assert float(first.difference) == pytest.approx(6.944, abs=5e-4)
    assert float(second.difference) == pytest.approx(6.107**2, abs=5e-3)
    assert "at (0.310, 0.676)" in first.text
    assert "at (0.281, 0.663)" in second.text


@pytest.mark.slow
def test_on_squares_the_minimum_of_the_sum_is_that_of_each_corner(monkeypatch):
    square = small_grid._BOUNDARY | {(1, 0): (sympy.Rational(1, 2), 0)}
    monkeypatch.setattr(small_grid, "_BOUNDARY", square)
    for key in ("winslow-minimum", "modified-liao-minimum", "winslow-inner-nodes"):
        (verdict,) = verify([BY_KEY[key]])
        assert verdict.agrees
        assert "(0.500, 0.500)" in verdict.text


def test_a_negative_weight_has_a_bound_on_valid_grids_only():
    (verdict,) = verify([BY_KEY["weight-2"]])
    assert "at least -195/4 while J > 0 and tends to -oo" in verdict.text


def test_kinks_are_carried_by_the_interpolation_and_by_no_smooth_map():
    (verdict,) = verify([BY_KEY["transfinite-kinks"]])
    assert "by 1 - eta times its jump" in verdict.text
    smooth_inside = eta + (1 - sympy.sign(eta)) * interpolation._KINKED
    assert not interpolation.carried_jump(smooth_inside).agrees


def test_grids_by_interpolation_have_the_jump_that_is_derived():
    side = np.linspace(0, 1, 9)
    straight, upwards = np.zeros((9, 2)), np.stack((np.zeros(9), side), axis=-1)
    straight[:, 0] = side
    kinked = straight + np.stack((0 * side, 0.25 - np.abs(side - 0.5) / 2), axis=-1)
    grid = gg.transfinite(kinked, straight + np.array([0, 1]), upwards, upwards + np.array([1, 0]))
    jump = np.diff(grid.y, 2, axis=0)[3]
    assert jump == pytest.approx(jump[0] * (1 - side), abs=1e-14)
