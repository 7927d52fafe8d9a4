"""Transfinite interpolation."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from gridgen_sym.errors import GridgenError
from gridgen_sym.grids import transfinite


def sides(ni=5, nj=4):
    """Four sides of a bent region with exact corners."""
    s, t = np.linspace(0, 1, ni), np.linspace(0, 1, nj)
    bottom = np.stack((s, s * (1 - s)), axis=-1)
    top = np.stack((s, 1 + 2 * s * (1 - s)), axis=-1)
    left = np.stack((t * (t - 1), t), axis=-1)
    right = np.stack((1 + t * (1 - t), t), axis=-1)
    return [bottom, top, left, right]


def test_boundary_is_kept_and_inside_is_coons():
    bottom, top, left, right = sides()
    xy = transfinite(bottom, top, left, right).xy
    assert np.array_equal(xy[:, 0], bottom)
    assert np.array_equal(xy[:, -1], top)
    assert np.array_equal(xy[0], left)
    assert np.array_equal(xy[-1], right)
    s, t = 0.25, 1 / 3
    # By hand: x = s + (1-s) t(t-1) + s t(1-t), y = t + (1-t) s(1-s) + 2 t s(1-s).
    x = s + (2 * s - 1) * t * (1 - t)
    y = t + (1 + t) * s * (1 - s)
    assert xy[1, 1] == pytest.approx([x, y], abs=1e-15)


def test_bilinear_quadrilateral_is_exact():
    corners = np.array([[0, 0], [3, 1], [4, 5], [-1, 2]], dtype=float)
    s = np.linspace(0, 1, 6)[:, None]

    def straight(a, b):
        return (1 - s) * corners[a] + s * corners[b]

    xy = transfinite(straight(0, 1), straight(3, 2), straight(0, 3), straight(1, 2)).xy
    u, v = np.meshgrid(s[:, 0], s[:, 0], indexing="ij")
    weights = np.stack(((1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v), axis=-1)
    assert xy == pytest.approx(weights @ corners, abs=1e-14)


@pytest.mark.parametrize(
    ("corner", "side", "end"),
    [("bottom left", 2, 0), ("bottom right", 3, 0), ("top left", 2, -1), ("top right", 3, -1)],
)
def test_an_open_corner_is_named_with_its_distance(corner, side, end):
    four = sides()
    four[side][end] += [3e-3, 4e-3]
    with pytest.raises(GridgenError, match=f"the {corner} corner.*0.005 apart"):
        transfinite(*four)


def test_rounding_at_a_corner_is_forgiven_relative_to_the_size():
    for scale in (1e-12, 1.0, 1e12):
        four = [scale * side for side in sides()]
        four[3][0] *= 1 + 1e-13
        transfinite(*four)
        four[3][0] *= 1 + 1e-6
        with pytest.raises(GridgenError, match="bottom right"):
            transfinite(*four)


def test_a_reversed_side_is_an_error_with_the_repair():
    bottom, top, left, right = sides()
    with pytest.raises(GridgenError, match=r"\[::-1\]"):
        transfinite(bottom, top[::-1], left, right)


def test_lengths_must_agree():
    bottom, top, left, right = sides()
    with pytest.raises(GridgenError, match="bottom has 5 and top has 4"):
        transfinite(bottom, top[:-1], left, right)
    with pytest.raises(GridgenError, match="left has 4 and right has 3"):
        transfinite(bottom, top, left, right[:-1])


@given(st.integers(0, 3), st.integers(0, 3), st.integers(0, 1), st.sampled_from([np.nan, np.inf, -np.inf]))
def test_a_point_that_is_not_finite_is_named(side, k, axis, value):
    four = sides()
    four[side][k, axis] = value
    name = ("bottom", "top", "left", "right")[side]
    with pytest.raises(GridgenError, match=f"side '{name}'.*point {k} "):
        transfinite(*four)


@given(hnp.arrays(np.float64, hnp.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=4)))
def test_another_shape_is_an_error(side):
    _, top, left, right = sides()
    with pytest.raises(GridgenError):
        transfinite(side, top, left, right)


@given(st.floats(1e-300, 1e307))
def test_huge_and_tiny_sides_scale(factor):
    unit = transfinite(*sides()).xy
    scaled = transfinite(*(factor * side for side in sides())).xy
    assert scaled / factor == pytest.approx(unit, abs=1e-12)
