"""Interpolated values as functions of the samples: the same values, and the transpose."""

from __future__ import annotations

import numpy as np
import pytest

import gridgen_sym as gg
from gridgen_sym.fields import grid_field

RANDOM = np.random.default_rng(0)
X, Y = RANDOM.random((2, 5, 7))
FOLDED = gg.domain("swan", 9, 11)
VALID = gg.optimize(FOLDED, "winslow").grid


def raster(*, smooth: bool) -> tuple[gg.SampledField, np.ndarray]:
    values = RANDOM.random((6, 8))
    return gg.raster_field(np.linspace(0, 1, 6) ** 1.2, np.linspace(1, 0, 8), values, smooth=smooth), values


def on_grid(grid: gg.Grid, shape: tuple[int, int]) -> tuple[gg.SampledField, np.ndarray]:
    values = RANDOM.random(shape)
    return grid_field(grid, values, outside="nearest"), values


def scattered() -> tuple[gg.SampledField, np.ndarray]:
    values = RANDOM.random(30)
    return gg.scattered_field(RANDOM.random((30, 2)), values, outside="nearest"), values


CASES = {
    "bilinear": lambda: raster(smooth=False),
    "bicubic": lambda: raster(smooth=True),
    "nodes": lambda: on_grid(VALID, (9, 11)),
    "cells": lambda: on_grid(VALID, (8, 10)),
    "folded_nodes": lambda: on_grid(FOLDED, (9, 11)),
    "folded_cells": lambda: on_grid(FOLDED, (8, 10)),
    "scattered": scattered,
}


@pytest.mark.parametrize("make", CASES.values(), ids=CASES)
def test_values_are_a_product_with_the_samples(make):
    field, values = make()
    assert np.allclose(field.along(values, X, Y), field(X, Y), rtol=1e-12)
    assert (field.transposed(X, X, Y) * values).sum() == pytest.approx((X * field(X, Y)).sum(), rel=1e-12)


@pytest.mark.parametrize("key", ["x", "y"])
def test_so_are_derivatives_of_a_spline(key):
    field, values = raster(smooth=True)
    (slope,) = field.derivatives(X, Y, (key,))
    assert np.allclose(field.along(values, X, Y, key), slope, rtol=1e-11, atol=1e-11)
    assert (field.transposed(X, X, Y, key) * values).sum() == pytest.approx((X * slope).sum(), rel=1e-11)


def test_smooth_fields_of_scattered_points_refuse():
    field = gg.scattered_field(RANDOM.random((30, 2)), RANDOM.random(30), smooth=True)
    with pytest.raises(gg.GridgenError, match=r"sampled at 30 points, smooth on triangles .* has no derivatives"):
        field.transposed(X, X, Y)
