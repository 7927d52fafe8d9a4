"""Orthogonality and the first cells at each side, against numbers that are known."""

import numpy as np
import pytest

import gridgen_sym as gg


def sheared(angle=60.0, ratio=1.5, height=0.1):
    """Parallelograms with this angle; heights along eta grow by the ratio."""
    xi, eta = np.arange(6.0), height * np.concatenate(([0.0], np.cumsum(ratio ** np.arange(4))))
    x = xi[:, None] + eta * np.cos(np.radians(angle))
    return gg.Grid.from_planes(x, np.broadcast_to(eta * np.sin(np.radians(angle)), x.shape))


def test_the_angles_of_parallelograms_are_off_by_30_degrees_everywhere():
    found = gg.quality(sheared()).non_orthogonality
    np.testing.assert_allclose([found.mean, found.percentile_95, found.largest], 30.0, rtol=1e-12)


def test_each_side_has_its_own_heights_growth_and_angles():
    sides = gg.quality(sheared()).sides
    assert tuple(sides) == ("bottom", "right", "top", "left")
    np.testing.assert_allclose(sides["bottom"].first_heights, 0.1)
    np.testing.assert_allclose(sides["bottom"].growth, 1.5)
    np.testing.assert_allclose(sides["top"].first_heights, 0.1 * 1.5**3)
    np.testing.assert_allclose(sides["top"].growth, 1 / 1.5)
    np.testing.assert_allclose(sides["left"].first_heights, 1.0)
    for side in sides.values():
        assert side.non_orthogonality.largest == pytest.approx(30.0)


def test_an_edge_without_length_is_as_bad_as_can_be():
    grid = gg.domain("square", 5, 5)
    planes = grid.planes.copy()
    planes[:, 2, 1] = planes[:, 2, 0]
    found = gg.quality(gg.Grid.from_planes(*planes))
    assert found.non_orthogonality.largest == 90.0
    assert found.sides["bottom"].non_orthogonality.largest == 90.0
    assert found.sides["bottom"].first_heights[0] == 0.0


def test_the_report_has_a_line_for_each_side():
    text = gg.quality(sheared()).summary()
    assert "bottom: first height          0.1  0.1  0.1; growth 1.5 to 1.5; degrees off normal 30.00" in text
