"""Interpolation within the cells of a grid: exact where it must be, on every domain, and quick on large grids."""

from __future__ import annotations

import time

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support_solvers import disordered

import gridgen_sym as gg
from gridgen_sym.fields import grid_field


def points_in_cells(grid, seed=0):
    """Return a random point (2, ni-1, nj-1) of every cell."""
    a, b, c, d = (grid.planes[:, i : i - 1 or None, j : j - 1 or None] for i, j in ((0, 0), (1, 0), (1, 1), (0, 1)))
    s, t = np.random.default_rng(seed).uniform(0, 1, (2, grid.shape[0] - 1, grid.shape[1] - 1))
    return a * (1 - s) * (1 - t) + b * s * (1 - t) + c * s * t + d * (1 - s) * t


@pytest.mark.parametrize("name", gg.domain_names())
def test_linear_functions_are_exact_on_every_domain(name):
    grid = gg.optimize(gg.domain(name, 31, 25), "winslow").grid
    field = grid_field(grid, 2 * grid.x - 3 * grid.y + 1)
    x, y = points_in_cells(grid)
    np.testing.assert_allclose(field(x, y), 2 * x - 3 * y + 1, atol=1e-12)
    assert field.outside(x, y) == field.outside(*grid.planes) == 0


@given(seed=st.integers(0, 10**6), disorder=st.floats(0, 0.9))
def test_values_at_the_nodes_are_kept_and_none_leaves_their_range(seed, disorder):
    grid = disordered(gg.domain("square", 9, 8), disorder, seed)
    nodal = np.random.default_rng(seed).normal(size=grid.shape)
    field = grid_field(grid, nodal)
    np.testing.assert_allclose(field(*grid.planes), nodal, atol=1e-7)
    inside = field(*points_in_cells(grid, seed))
    assert nodal.min() - 1e-12 <= inside.min() <= inside.max() <= nodal.max() + 1e-12
    # Each cell's points take part in no other cell's values.
    a, b, c, d = nodal[:-1, :-1], nodal[1:, :-1], nodal[1:, 1:], nodal[:-1, 1:]
    assert (inside <= np.max((a, b, c, d), axis=0) + 1e-9).all()
    assert (inside >= np.min((a, b, c, d), axis=0) - 1e-9).all()


def test_outside_the_nearest_point_of_the_boundary_counts():
    grid = gg.domain("square", 5, 5)
    field = grid_field(grid, grid.x + 10 * grid.y)
    x, y = np.array([[-1.0, 2.0, 0.3, 0.6, -5.0]]), np.array([[0.3, 0.7, -4.0, 1.5, -5.0]])
    np.testing.assert_allclose(field(x, y), [[3.0, 8.0, 0.3, 10.6, 0.0]], atol=1e-12)
    assert field.outside(x, y) == 5


def test_what_lies_in_the_bay_of_a_domain_is_outside():
    """It is in the hull of the nodes, over which triangles would be stretched."""
    start = gg.domain("horseshoe", 41, 11)
    field = grid_field(start, start.y)
    inside = np.array([[start.x.mean()]]), np.array([[start.y.min()]])
    assert field.outside(*inside) == 1


def test_a_folded_grid_is_still_a_set_of_samples():
    xy = gg.domain("square", 9, 9).xy
    xy[4, 4], xy[5, 4] = xy[5, 4].copy(), xy[4, 4].copy()
    grid = gg.Grid(xy)
    assert gg.quality(grid).folded_cells
    np.testing.assert_allclose(grid_field(grid, grid.x)(*grid.planes), grid.x, atol=1e-12)


def test_large_grids_take_no_time():
    """A triangulation of these nodes takes minutes on a busy machine, which no time limit can interrupt."""
    grid = gg.domain("wavy", 401, 401)
    before = time.process_time()
    field = grid_field(grid, grid.x)
    np.testing.assert_allclose(field(*grid.planes), grid.x, atol=1e-9)
    assert time.process_time() - before < 3
