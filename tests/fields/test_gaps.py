"""Rasters with missing samples: values beside gaps, what counts as outside, longitudes in any turn."""

from __future__ import annotations

import numpy as np
import pytest

import gridgen_sym as gg

X, Y = np.linspace(0, 3, 13), np.linspace(2, 0, 9)
VALUES = X[:, None] + 10 * Y
LAND = (X[:, None] > 2.1) & (Y > 1.1)
GAPPED = np.where(LAND, np.nan, VALUES)


@pytest.mark.parametrize("smooth", [False, True])
def test_a_point_is_missing_where_the_nearest_sample_is(smooth):
    """Both axes, of which one falls; values where no gap is near are those of the whole raster."""
    field = gg.raster_field(X, Y, GAPPED, smooth=smooth)
    x, y = np.random.default_rng(0).uniform(0, 1, (2, 500)) * [[3], [2]]
    nearest = LAND[np.abs(X[:, None] - x).argmin(axis=0), np.abs(Y[:, None] - y).argmin(axis=0)]
    np.testing.assert_array_equal(field.missing(x, y), nearest)
    np.testing.assert_array_equal(field.covers(x, y), ~nearest)
    assert 0 < nearest.sum() < 250
    assert field.outside(x, y) == nearest.sum()
    assert not field.covers(np.array([3.1]), np.array([0.0])).any()
    assert not field.missing(np.array([3.1]), np.array([2.0])).any()  # Nothing is known outside.
    if not smooth:
        far = (x < 2) | (y < 1)
        np.testing.assert_allclose(field(x[far], y[far]), (x + 10 * y)[far])
    assert np.isfinite(field(x, y)).all()


def test_nodes_on_missing_samples_are_refused_or_take_the_nearest():
    grid = gg.Grid(gg.domain("square", 9, 9).xy * (3, 2))
    with pytest.raises(gg.GridgenError, match="the weight is known by samples on a raster of 13 x 9 points, and node"):
        gg.optimize(grid, "area", weight=gg.Weight(gg.raster_field(X, Y, 1 + GAPPED)))
    weight = gg.Weight(gg.raster_field(X, Y, 1 + GAPPED, outside="nearest"))
    assert gg.optimize(grid, "area", weight=weight).quality.valid


def test_what_is_no_raster_is_refused():
    with pytest.raises(gg.GridgenError, match="all samples of the raster are missing"):
        gg.raster_field(X, Y, np.full_like(VALUES, np.nan))
    with pytest.raises(gg.GridgenError, match=r"samples must be finite: sample \(3, 2\) is not"):
        gg.raster_field(X, Y, np.where((np.indices(VALUES.shape).T == (3, 2)).all(-1).T, np.inf, GAPPED))


class Shifted:
    """A projection of one degree to one unit, whose longitudes are negative."""

    def to_geographic(self, xy):
        return np.asarray(xy) - (360.0, 0.0)


def test_samples_in_longitude_and_latitude_are_a_field_of_the_plane():
    field = gg.raster_field(X, Y, GAPPED)
    flat = field.on_plane(Shifted())
    x, y = np.array([1.0, 2.9, 1.0]), np.array([1.0, 1.9, 5.0])
    np.testing.assert_allclose(flat(x[:1], y[:1]), 11)
    np.testing.assert_array_equal(flat.missing(x, y), [False, True, False])
    np.testing.assert_array_equal(flat.covers(x, y), [True, False, False])
    slope = flat.derivatives(*np.random.default_rng(0).uniform(0.3, 0.9, (2, 20)), ("x", "y"))
    np.testing.assert_allclose(slope, [[1] * 20, [10] * 20], rtol=1e-6)
