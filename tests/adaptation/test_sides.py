"""The boundary in adaptation: which sides slide, how far their nodes go, and that the domain keeps its shape."""

from __future__ import annotations

import numpy as np
import pytest

import gridgen_sym as gg
from gridgen_sym.adaptation.sides import SideSpacing, _straight, sliding_curves, straight_stretches
from gridgen_sym.boundary.slide_curve import SlideCurve

from .conftest import L_SHAPE, corner_singularity, interpolation_error, l_shape, shock, square


def test_nodes_on_straight_sides_are_equidistributed_too():
    result = gg.adapt(square(), shock)
    for side in (np.s_[:, 0], np.s_[0, :]):
        spacing, density = np.hypot(*np.diff(result.grid.xy[side], axis=0).T), result.density[side]
        product = spacing * (density[1:] + density[:-1]) / 2
        # The springs and the functional share the side: measured 0.11.
        assert product.std() / product.mean() < 0.15
        assert spacing.std() / spacing.mean() > 0.3
    stays = gg.adapt(square(), shock, boundary="fixed").grid
    assert interpolation_error(result.grid, shock) < 0.6 * interpolation_error(stays, shock)


def test_which_sides_are_straight():
    x = np.array([0.0, 0.1, 0.5, 1.0])
    assert _straight(np.stack((x, 2 * x)))
    assert _straight(np.stack((x, 2 * x + 1e-12 * (x == 0.5))))
    assert not _straight(np.stack((x, 2 * x + 1e-6 * (x == 0.5))))
    assert not _straight(np.stack((x, 2 * x + 1e-6 * (x == 1.0))))
    assert not _straight(np.stack((x * (1 - x), x * (1 - x)))), "it ends where it began"
    assert _straight(1e-9 * np.stack((x, 2 * x))), "in any unit"
    assert not _straight(1e-9 * np.stack((x, 2 * x + 1e-6 * (x == 0.5))))


def test_a_side_slides_between_its_turns():
    """Turns, and a node at which the side runs back, end a stretch; one without a node inside cannot slide."""
    points = np.array([(0, 0), (1, 0), (2, 0), (2, 1), (3, 1), (4, 1), (5, 1), (4.5, 1), (4, 1), (4, 2)]).T
    assert list(straight_stretches(points)) == [(0, 2), (3, 6), (6, 8)]
    assert list(straight_stretches(1e-9 * points)) == [(0, 2), (3, 6), (6, 8)]
    angle = np.linspace(0, 1e-2, 50)
    assert not list(straight_stretches(np.stack((np.cos(angle), np.sin(angle)))))
    for count in (3, 4, 5, 17, 100):
        line = np.stack((np.linspace(0, 3, count), np.linspace(1, 2, count)))
        assert list(straight_stretches(line)) == [(0, count - 1)]
        bent = np.concatenate((line, line[:, -1:] + np.array([[0.0, 0.0], [0.1, 0.2]])), axis=1)
        assert list(straight_stretches(bent)) == [(0, count - 1), (count - 1, count + 1)]


def test_turns_of_a_side_stay_and_the_domain_keeps_its_shape():
    start = l_shape(17)
    moved = gg.adapt(start, corner_singularity, max_iterations=4).grid
    for corner in L_SHAPE:
        assert np.hypot(*(moved.xy - corner).transpose(2, 0, 1)).min() == 0
    assert not np.array_equal(moved.xy[:, 0], start.xy[:, 0])
    area = sum(gg.quality(grid).mean_jacobian * 16 * 16 for grid in (start, moved))
    assert area == pytest.approx(2 * 3.0, rel=1e-12)


def test_fixed_nodes_are_corners_of_the_curves_and_a_side_without_others_does_not_slide():
    mask = np.zeros((5, 5), dtype=bool)
    mask[0, 0] = mask[2, 2] = True
    curves = sliding_curves(square(5), "straight", mask)
    assert all(len(curve.corners) == 2 for curve in curves.values())
    assert list(curves) == ["bottom", "right", "top", "left"]
    mask[0, 3] = True
    np.testing.assert_allclose(sliding_curves(square(5), "straight", mask)["left"].corners, [0, 0.75, 1])
    mask[0] = True
    assert "left" not in sliding_curves(square(5), "straight", mask)
    assert sliding_curves(square(5), "fixed", None) == {}


def test_what_is_not_straight_slides_only_where_all_may():
    start = gg.domain("quarter_annulus", 9, 7)
    assert set(sliding_curves(start, "straight", None)) == {"left", "right"}
    assert set(sliding_curves(start, "all", None)) == {"bottom", "right", "top", "left"}


def test_fixed_nodes_stay_and_others_of_their_side_slide():
    fixed = np.zeros((21, 21), dtype=bool)
    fixed[5, 5], fixed[0, 10] = True, True
    result = gg.adapt(square(21), shock, fixed=fixed, max_iterations=4)
    assert np.array_equal(result.grid.xy[5, 5], square(21).xy[5, 5])
    np.testing.assert_allclose(result.grid.xy[0, 10], square(21).xy[0, 10], atol=1e-15)
    assert not np.array_equal(result.grid.xy[0], square(21).xy[0])
    assert not np.array_equal(result.grid.xy[:, 0], square(21).xy[:, 0])


def test_springs_go_to_the_density_by_the_damping_and_not_beyond():
    """The weight may: Aitken's rule takes a damping of up to 2."""
    start, density = square(5), 1 + square(5).x
    curves = sliding_curves(start, "straight", None)
    springs = {
        damping: SideSpacing(curves).toward(start, density, damping, 1.0)["bottom"].springs
        for damping in (1e-9, 0.5, 1.0, 2.0)
    }
    at_edges = np.array([1.125, 1.375, 1.625, 1.875])
    uneven = gg.Grid(square(5).xy ** 1.5)
    over = [SideSpacing(curves).toward(uneven, density, damping, 1.0)["bottom"].springs for damping in (1.0, 2.0)]
    np.testing.assert_array_equal(*over)
    # Of even edges none is pulled more than the others.
    np.testing.assert_allclose(springs[1e-9] / springs[1e-9].mean(), 1, rtol=1e-8)
    np.testing.assert_allclose(springs[0.5] / springs[0.5].mean(), at_edges**0.5 / (at_edges**0.5).mean())
    np.testing.assert_allclose(springs[1.0] / springs[1.0].mean(), at_edges / at_edges.mean())
    np.testing.assert_array_equal(springs[2.0], springs[1.0])


def test_curved_domains_keep_their_shape():
    start = gg.optimize(gg.domain("horseshoe_map", 33, 17), "winslow").grid
    center = start.planes[:, 16, 8]

    def spot(x, y):
        return np.tanh(6 * (np.hypot(x - center[0], y - center[1]) - 0.4))

    result = gg.adapt(start, spot)
    assert result.quality.valid
    assert interpolation_error(result.grid, spot) < 0.7 * interpolation_error(start, spot)
    for side in (np.s_[:, 0], np.s_[:, -1]):
        assert np.array_equal(result.grid.xy[side], start.xy[side])
    free = gg.adapt(start, spot, boundary="all", max_iterations=5)
    assert free.quality.valid
    assert not np.array_equal(free.grid.xy[:, -1], start.xy[:, -1])
    # Every boundary node stays on the curve of its side.
    curve, nodes = SlideCurve.of_points(start.xy[:, -1]), free.grid.xy[:, -1]
    np.testing.assert_allclose(curve.point(curve.nearest(nodes)), nodes, atol=1e-9)
