"""Monitors: their formulas, the fraction of nodes that they promise, smoothing; spreads; values carried to a grid."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import gridgen_sym as gg

from .conftest import MEASURES, ring, square, two_scales

SQUARE = square()


def integral(grid, field):
    """Return the integral of nodal values over the unit square's uniform grid, by the trapezoidal rule."""
    return np.trapezoid(np.trapezoid(field, grid.y[0], axis=1), grid.x[:, 0])


# ---- densities ----


@pytest.mark.parametrize("measure", MEASURES)
@pytest.mark.parametrize("fraction", [0.0, 0.3, 0.5, 0.9])
def test_features_get_their_fraction_of_the_nodes(measure, fraction):
    density = gg.Monitor(measure, feature_fraction=fraction, smoothing=0).density(SQUARE, two_scales(*SQUARE.planes))
    total = integral(SQUARE, density)
    assert (total - integral(SQUARE, np.ones((33, 33)))) / total == pytest.approx(fraction, abs=1e-9)
    assert density.min() >= 1 - 1e-12


@pytest.mark.slow
@pytest.mark.parametrize("measure", MEASURES)
@given(scale=st.floats(1e-8, 1e8), offset=st.floats(-1e3, 1e3))
def test_units_of_the_solution_do_not_matter(measure, scale, offset):
    u = two_scales(*SQUARE.planes)
    plain = gg.Monitor(measure).density(SQUARE, u)
    # An offset costs digits of the differences.
    accuracy = 1e-6 * (1 + abs(offset))
    np.testing.assert_allclose(gg.Monitor(measure).density(SQUARE, scale * (u + offset)), plain, rtol=accuracy)


def same_but_for_intensity(density, expected):
    ratio = (density - 1) / expected
    assert ratio.mean() > 0
    np.testing.assert_allclose(ratio, ratio.mean(), rtol=0.05)


@pytest.mark.parametrize("stretched", [0.0, 0.1])
def test_formulas(stretched):
    """u = x³/6: slopes and second derivatives are known, and the errors that follow; the width of cells has no part."""
    x = SQUARE.x + stretched * np.sin(2 * np.pi * SQUARE.x)
    grid = gg.Grid.from_planes(x, SQUARE.y)
    found = {
        name: gg.Monitor(name, feature_fraction=0.5, smoothing=0).density(grid, x**3 / 6)[4:-4] for name in MEASURES
    }
    slope, inside = x[4:-4] ** 2 / 2, x[4:-4]
    same_but_for_intensity(found["gradient"], slope)
    same_but_for_intensity(found["arc_length"] ** 2, slope**2)
    same_but_for_intensity(found["curvature"], inside**0.4)
    same_but_for_intensity(found["recovery_error"], inside ** (2 / 3))
    same_but_for_intensity(found["hierarchical_error"], inside**0.4)


@pytest.mark.parametrize(("measure", "power"), [("gradient", 1), ("arc_length", 2)])
def test_slopes_have_two_components(measure, power):
    inside = SQUARE.planes[:, 4:-4, 4:-4]
    density = gg.Monitor(measure, feature_fraction=0.5, smoothing=0).density(SQUARE, SQUARE.x**2 / 2 + SQUARE.y**2)[
        4:-4, 4:-4
    ]
    same_but_for_intensity(density**power, np.hypot(inside[0], 2 * inside[1]) ** power)


def test_curvature_is_that_of_both_principal_directions():
    """u = x³/6 + x y² has the Hessian ((x, 2y), (2y, 2x)); c is set by the mean over the domain."""
    u = SQUARE.x**3 / 6 + SQUARE.x * SQUARE.y**2
    density = gg.Monitor("curvature", feature_fraction=0.5, smoothing=0).density(SQUARE, u)[4:-4, 4:-4]
    x, y = SQUARE.planes
    hessian = np.stack((np.stack((x, 2 * y), axis=-1), np.stack((2 * y, 2 * x), axis=-1)), axis=-2)
    small, large = np.sort(np.abs(np.linalg.eigvalsh(hessian)), axis=-1).transpose(2, 0, 1)
    typical = integral(SQUARE, large**0.4) ** 2.5
    expected = (large * np.maximum(small, typical**0.8 * large**0.2)) ** (1 / 3)
    assert (small > typical**0.8 * large**0.2).any(), "both branches are met"
    assert (small < typical**0.8 * large**0.2).any()
    same_but_for_intensity(density, expected[4:-4, 4:-4])


@pytest.mark.parametrize("scale", [1e-6, 1e5])
def test_the_unit_of_length_has_no_part_in_curvature(scale):
    plain, scaled = (
        gg.Monitor("curvature").density(gg.Grid(unit * SQUARE.xy), two_scales(*SQUARE.planes)) for unit in (1.0, scale)
    )
    np.testing.assert_allclose(scaled, plain, rtol=1e-9)


def test_values_are_the_density_itself():
    density = 1 + SQUARE.x
    np.testing.assert_array_equal(gg.Monitor("values", smoothing=0).density(SQUARE, density), density)
    result = gg.adapt(SQUARE, "1 + 10*exp(-50*((x - 0.5)**2 + (y - 0.5)**2))", monitor="values")
    assert result.converged
    assert "estimated error" not in result.message
    assert result.after.weight.variation < 0.1 < 0.5 < result.before.weight.variation
    with pytest.raises(gg.GridgenError, match=r"density of nodes must be positive: it is 0 at node \(0, 0\)"):
        gg.Monitor("values").density(SQUARE, SQUARE.x)


def test_your_own_measure():
    own = gg.Monitor(lambda grid, values: np.abs(values), feature_fraction=0.5, smoothing=0)
    np.testing.assert_allclose(own.density(SQUARE, -SQUARE.x), 1 + 2 * SQUARE.x, rtol=1e-12)


@pytest.mark.parametrize("measure", MEASURES)
def test_a_constant_solution_asks_for_nothing(measure):
    np.testing.assert_array_equal(gg.Monitor(measure).density(SQUARE, np.full((33, 33), 2.0)), 1)


def test_a_negative_measure_is_shown_with_its_place_and_what_helps():
    def measure(grid, values):
        return values - 2 * (grid.x == 0.25) * (grid.y == 0.875)

    grid = gg.domain("square", 5, 9)
    with pytest.raises(gg.GridgenError) as caught:
        gg.Monitor(measure).density(grid, np.zeros((5, 9)))
    assert "it is -2 at node (1, 7), x = 0.25, y = 0.875. Take its absolute value, or add 3 to it" in str(caught.value)


def test_smoothing_keeps_constants_and_the_mean_and_widens_peaks():
    def smooth(passes):
        return gg.Monitor("values", smoothing=passes).density(SQUARE, peak)

    peak = np.ones((33, 33))
    np.testing.assert_array_equal(smooth(5), peak)
    peak[16, 16] = 17.0
    np.testing.assert_allclose(smooth(1)[15:18, 15:18] - 1, np.outer([1, 2, 1], [1, 2, 1]), rtol=1e-14)
    assert smooth(6).mean() == pytest.approx(peak.mean())
    assert smooth(6).max() < smooth(2).max()
    peak[0, 32] = 17.0
    assert smooth(6).mean() == pytest.approx(peak.mean())
    np.testing.assert_allclose(smooth(1)[:2, -2:] - 1, [[3, 9], [1, 3]], rtol=1e-14)


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"feature_fraction": 1.0}, "below 1; came 1.0"),
        ({"feature_fraction": -0.1}, "at least 0"),
        ({"feature_fraction": "half"}, "came 'half'"),
        ({"smoothing": -1}, "not negative; came -1"),
        ({"smoothing": 1.5}, "number of passes"),
        ({"measure": "curve"}, "unknown monitor 'curve'"),
    ],
)
def test_settings_that_cannot_be_used_are_refused(options, match):
    with pytest.raises(gg.GridgenError, match=match):
        gg.Monitor(**options)


# ---- spreads ----


def test_spreads_of_a_grid_that_is_known():
    grid = gg.Grid.from_planes(*np.meshgrid([0.0, 1.0, 4.0], [0.0, 1.0, 2.0], indexing="ij"))
    even = gg.equidistribution(grid, 1.0)
    # Areas are 1 and 3: mean 2, standard deviation 1.
    assert (even.weight.variation, even.weight.ratio) == pytest.approx((0.5, 3.0))
    assert even.root == even.weight
    assert str(even.weight) == "variation 0.500, ratio 3"
    assert gg.equidistribution(grid, np.full((3, 3), 7.0)).weight.variation == pytest.approx(0.5)
    assert gg.equidistribution(gg.Grid(1e-6 * grid.xy), 1.0).weight.variation == pytest.approx(0.5)
    nine = gg.equidistribution(grid, lambda x, y: np.where(x < 1, 9.0, 1.0))
    assert nine.root.variation == pytest.approx(0)
    assert nine.weight.ratio == pytest.approx(3)


def test_spreads_of_weights_that_are_not_positive():
    assert gg.equidistribution(SQUARE, lambda x, y: 0.0).weight.ratio == np.inf
    with pytest.raises(gg.GridgenError, match="nowhere negative"):
        gg.equidistribution(SQUARE, gg.Weight("x - 0.5", allow_negative=True))
    with pytest.raises(gg.GridgenError, match="must not be negative"):
        gg.equidistribution(SQUARE, "x - 0.5")


# ---- transfer ----


def test_transfer_is_exact_for_linear_fields_and_for_the_same_grid():
    adapted = gg.adapt(SQUARE, ring, max_iterations=3).grid
    line = lambda grid: 2 * grid.x - grid.y  # noqa: E731
    np.testing.assert_allclose(gg.transfer(adapted, line(adapted), SQUARE), line(SQUARE), atol=1e-12)
    u = ring(*adapted.planes)
    np.testing.assert_allclose(gg.transfer(adapted, u, adapted), u, atol=1e-9)
    both = gg.transfer(adapted, np.stack((u, line(adapted)), axis=-1), SQUARE)
    assert both.shape == (33, 33, 2)
    np.testing.assert_array_equal(both[..., 0], gg.transfer(adapted, u, SQUARE))
    np.testing.assert_array_equal(gg.transfer(adapted, u[..., None], SQUARE)[..., 0], both[..., 0])


def test_transfer_does_not_overshoot_and_the_smooth_one_is_more_accurate():
    fine = gg.domain("square", 50, 41)
    u = ring(*SQUARE.planes)
    moved = gg.transfer(SQUARE, u, fine)
    assert u.min() <= moved.min() <= moved.max() <= u.max()
    hill = lambda grid: np.sin(3 * grid.x) * np.cos(2 * grid.y)  # noqa: E731
    plain, smooth = (
        np.abs(gg.transfer(SQUARE, hill(SQUARE), fine, smooth=smooth) - hill(fine)).max() for smooth in (False, True)
    )
    assert smooth < plain / 5 < 0.001
    with pytest.raises(gg.GridgenError, match=r"shape \(33, 33\); came \(3,\)"):
        gg.transfer(SQUARE, np.ones(3), fine)


def test_the_old_name_of_the_fraction_warns_and_works():
    with pytest.warns(DeprecationWarning, match=r"share=.*feature_fraction"):
        old = gg.Monitor("gradient", share=0.4)
    assert old == gg.Monitor("gradient", feature_fraction=0.4) == gg.Monitor("gradient", 0.4)
    with pytest.warns(DeprecationWarning, match="called feature_fraction"):
        assert old.share == 0.4


@pytest.mark.parametrize("solution", ["x + y", "3*x - 2*y + 1", "x + y + 1e-14*x**2", "1e-3*(x + y)"])
@pytest.mark.parametrize("measure", ["curvature", "recovery_error", "hierarchical_error"])
def test_rounding_is_nothing_to_adapt_to(solution, measure):
    start = gg.domain("square", 11, 11)
    result = gg.adapt(start, solution, monitor=measure, max_iterations=3)
    assert result.converged
    np.testing.assert_allclose(result.grid.xy, start.xy, atol=1e-9)
