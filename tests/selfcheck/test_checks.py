"""What the checks of a functional say where it has kinks, vanishes, or has no derivative; and that they can fail."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

import gridgen_sym as gg
from gridgen_sym.functionals import Functional
from gridgen_sym.functionals.expression import holds
from gridgen_sym.functionals.metric import symbol
from gridgen_sym.selfcheck import checks, digits, kernels, limit
from gridgen_sym.selfcheck.digits import corner_derivatives, equations
from gridgen_sym.selfcheck.samples import SIZES, active_size, random_jets
from gridgen_sym.selfcheck.setting import Setting

#: No derivative at square cells: a long step of a difference crosses the kink.
KINK = "sqrt(g12**2 + (g11 - g22)**2)"


@pytest.fixture(autouse=True)
def numpy_kernels(monkeypatch):
    """No compiler is needed, nor waited for."""
    monkeypatch.setenv("GRIDGEN_SYM_BACKEND", "numpy")
    monkeypatch.setattr(kernels, "find_compiler", lambda: None)


def slow(density):
    return pytest.param(density, marks=pytest.mark.slow)


def words(functional: Functional) -> list[str]:
    return [check.word for check in checks(functional)]


@pytest.mark.parametrize(
    "density",
    [
        slow(KINK),
        slow(f"(g11 + g22)/J + {KINK}/J"),
        "abs(J - 1)",  # The equations of either branch read 0 = 0, and nodes at the kink have a gradient.
        "2 - 3*J + x_xi",  # A null Lagrangian whose energy nearly vanishes, too.
        "((0.05 - J + abs(0.05 - J))/2)**2",  # Zero at cells of size 1.
        slow("((J - 50 + abs(J - 50))/2)**2"),
        "(g11 + g22) - 0.001*log(J)",  # Of mixed degree.
        slow("tanh(50*(J - 1)) + g11 + g22"),
        slow("exp(g11**2) + g22/J"),  # Too large for floats at large cells.
    ],
)
def test_what_is_right_passes(density):
    assert words(Functional("right", density)) == ["ok"] * 6


def test_a_penalty_is_checked_at_a_size_at_which_it_acts():
    assert active_size(Functional("small", "((0.05 - J + abs(0.05 - J))/2)**2")) == 1 / 8
    assert active_size(Functional("large", "((J - 50 + abs(J - 50))/2)**2")) in (8.0, 64.0)
    assert active_size(Functional("any", "g11")) == 1.0


def test_zero_against_zero_is_called_vacuous():
    """abs(J) - J vanishes on all valid grids."""
    found = list(checks(Functional("nothing", "(abs(J) - J)**2")))
    assert [check.word for check in found if "NumPy kernels" not in check.text] == ["vacuous"] * 5
    assert all("both are zero at all points" in check.text for check in found if check.vacuous)
    assert all(check.passed for check in found)


def test_what_is_not_finite_fails_with_the_corner_and_without_a_traceback():
    """The root of something that vanishes in a region: `define` refuses it, and a check must stand it."""
    functional = Functional("rough", "(g11 + g22)/J + sqrt((g11 - 100 + abs(g11 - 100))/2)")
    found = [*corner_derivatives(functional), equations(functional)]
    assert all("not finite at the corner x_xi = " in check.text and not check.passed for check in found)


def test_a_density_without_values_fails():
    (first, *_) = corner_derivatives(Functional("never", "log(-J)*g11"))
    assert "the density is not finite at any corner" in first.text
    assert first.word == "FAILED"


def changed(part, factor):
    """Return a function that returns what `part` returns times a factor."""
    return lambda *given, **named: part(*given, **named) * factor


def test_a_wrong_hessian_fails_near_kinks_too(monkeypatch):
    right = gg.solvers.hessian
    assert kernels.hessian_kernel(Functional("kink", KINK)).word == "ok"
    for factor in (-1.0, 1.00001):
        monkeypatch.setattr(gg.solvers, "hessian", changed(right, factor))
        assert kernels.hessian_kernel(Functional("kink", KINK)).word == "FAILED"


def test_a_wrong_gradient_fails_in_the_limit(monkeypatch):
    right = limit._residual_function
    for factor in (-1.0, 0.999):
        monkeypatch.setattr(limit, "_residual_function", lambda *given, c=factor: changed(right(*given), c))
        assert limit.convergence(Functional("penalty", "((0.05 - J + abs(0.05 - J))/2)**2")).word == "FAILED"


def test_a_wrong_derivative_fails_at_any_size(monkeypatch):
    """A part that acts on small cells only is wrong: the density that is checked against lacks it."""
    lacking = digits._density(Functional("lacking", "g11 + g22"))
    monkeypatch.setattr(digits, "_density", lambda *_: lacking)
    functional = Functional("penalty", "g11 + g22 + ((0.001 - J + abs(0.001 - J))/2)**2")
    assert [check.word for check in corner_derivatives(functional)] == ["FAILED", "FAILED"]


def levels_of(errors, round_off=1e-15):
    return [limit._Level(cells, error, round_off, 1.0, 1.0) for cells, error in zip(limit._CELLS, errors, strict=False)]


def judged(monkeypatch, errors, **options):
    given = {level.cells: level for level in levels_of(errors, **options)}
    monkeypatch.setattr(limit, "_level", lambda _functional, _residual, cells, _size: given[cells])
    return limit.convergence(Functional("any", "g11"))


def test_the_order_counts_where_it_is_reached(monkeypatch):
    """Orders of 1.64, then 2: the first refinements are too coarse for the functional."""
    late = judged(monkeypatch, [1, 1 / 3.12, 1 / 12.4, 1 / 49.6])
    assert late.passed
    assert "at 128: order 2.00" in late.text
    assert [round(np.log2(a / b), 2) for a, b in pairwise([1, 1 / 3.12])] == [1.64]
    assert judged(monkeypatch, [1, 0.9, 0.8, 0.5, 0.2, 0.05]).passed
    assert not judged(monkeypatch, [1, 0.25, 0.09, 0.05, 0.04, 0.038]).passed  # It tends to an error of its own.
    assert not judged(monkeypatch, [1] * 6).passed


def test_round_off_ends_the_refinement(monkeypatch):
    exact = judged(monkeypatch, [1e-14] * 6, round_off=2e-15)
    assert exact.passed
    assert "which is round-off" in exact.text
    assert not judged(monkeypatch, [1e-12] * 6, round_off=2e-15).passed


def test_samples_have_every_size_and_positive_jacobians():
    for size in SIZES:
        for jet in random_jets(3, size):
            assert 0.1 < (jet["x_xi"] * jet["y_eta"] - jet["x_eta"] * jet["y_xi"]) / size**2 < 3


# ---- fields, places and a target ----

SCALAR = Functional("scalar", "p*(g11 + g22)/J", fields={"p": "scalar"}, constraints=("p > 0",))


@pytest.mark.slow
def test_fields_places_and_a_target_pass():
    assert words(SCALAR) == ["ok"] * 12
    assert words(Functional("relative", "x*xi*t11/tau + t22 + g12**2")) == ["ok"] * 12


def test_a_wrong_slope_of_a_field_fails(monkeypatch):
    right = Setting.given
    assert equations(SCALAR, "p:differentiated").word == "ok"
    for name in ("p_x", "p_y", "p"):
        wrong = lambda self, values, name=name: {**right(self, values), name: -right(self, values)[name]}  # noqa: E731
        monkeypatch.setattr(Setting, "given", wrong)
        assert equations(SCALAR, "p:differentiated").word == "FAILED"


def test_fields_meet_their_constraints():
    for constraint in ("0 < p < 0.5", "p > 7", "p < -1"):
        functional = Functional("limited", SCALAR.density, fields={"p": "scalar"}, constraints=(constraint,))
        (field,) = Setting(functional, "plain").fields(1.0).values()
        values = [
            float(field.source.subs({symbol("xi"): a, symbol("eta"): b})) for a in (0, 0.5, 1) for b in (0, 0.5, 1)
        ]
        assert all(holds(constraint, {"p": value}) for value in values)
        assert max(values) - min(values) > 0.01
