"""Recovered derivatives and error indicators against exact ones, on grids that are nowhere regular."""

from __future__ import annotations

import numpy as np
import pytest
from support_solvers import disordered

import gridgen_sym as gg

from .conftest import interpolation_error


def skewed(nodes):
    """Return a smooth grid with no right angle."""
    x, y = gg.domain("square", nodes, nodes).planes
    return gg.Grid.from_planes(x + 0.08 * np.sin(np.pi * x) * np.sin(2 * np.pi * y), y + 0.3 * x + 0.05 * x * y)


def wave(x, y):
    return np.sin(3 * x + 1) * np.cos(2 * y)


def wave_gradient(x, y):
    return np.stack((3 * np.cos(3 * x + 1) * np.cos(2 * y), -2 * np.sin(3 * x + 1) * np.sin(2 * y)))


def wave_hessian(x, y):
    u, mixed = wave(x, y), -6 * np.cos(3 * x + 1) * np.sin(2 * y)
    return np.stack((-9 * u, mixed, -4 * u))


def order(error, coarse=17, fine=33):
    """Return the observed order of an error that depends on the number of nodes."""
    return np.log2(error(coarse) / error(fine))


def inside(field):
    return field[..., 2:-2, 2:-2]


@pytest.mark.parametrize("disorder", [0.0, 0.2])
def test_the_gradient_of_a_linear_function_is_exact_on_any_grid(disorder):
    grid = disordered(skewed(9), disorder)
    gradient = gg.recover_gradient(grid, 2 * grid.x - 5 * grid.y + 3)
    np.testing.assert_allclose(gradient[0], 2, atol=1e-12)
    np.testing.assert_allclose(gradient[1], -5, atol=1e-12)
    np.testing.assert_allclose(gg.recover_hessian(grid, 2 * grid.x - 5 * grid.y), 0, atol=1e-10)


def test_gradients_and_hessians_are_of_second_order_inside():
    def gradient_error(nodes):
        grid = skewed(nodes)
        return np.abs(inside(gg.recover_gradient(grid, wave(*grid.planes)) - wave_gradient(*grid.planes))).max()

    def hessian_error(nodes):
        grid = skewed(nodes)
        return np.abs(inside(gg.recover_hessian(grid, wave(*grid.planes)) - wave_hessian(*grid.planes))).max()

    assert order(gradient_error) > 1.8
    assert order(hessian_error) > 1.6
    assert gradient_error(33) < 0.02
    assert hessian_error(33) < 0.1


def test_the_hessian_treats_both_directions_alike():
    """Mirrored at the diagonal, grid and solution, it has the same entries; the boundary has those of its neighbors."""
    grid = skewed(9)
    mirrored = gg.Grid.from_planes(grid.y.T, grid.x.T)
    values = np.random.default_rng(0).normal(size=grid.shape)
    u_xx, u_xy, u_yy = gg.recover_hessian(grid, values)
    np.testing.assert_allclose(
        gg.recover_hessian(mirrored, values.T), [u_yy.T, u_xy.T, u_xx.T], rtol=1e-9, atol=1e-9 * np.abs(u_xx).max()
    )
    for field in (u_xx, u_xy, u_yy):
        np.testing.assert_array_equal(field, np.pad(field[1:-1, 1:-1], 1, mode="edge"))


def test_the_recovery_error_is_that_of_the_gradient():
    """Its root sum of squares over the true error of the gradient tends to 1."""

    def effectivity(nodes):
        grid = skewed(nodes)
        return np.linalg.norm(gg.recovery_error(grid, wave(*grid.planes))) / gradient_error(grid)

    def gradient_error(grid):
        # By 4 x 4 Gauss points; the bilinear interpolant's gradient by differences of its own.
        points, weights = np.polynomial.legendre.leggauss(4)
        nodes = np.concatenate((grid.planes, wave(*grid.planes)[np.newaxis]))
        a, b, c, d = nodes[:, :-1, :-1], nodes[:, 1:, :-1], nodes[:, 1:, 1:], nodes[:, :-1, 1:]
        total = 0.0
        for p, along in zip((points + 1) / 2, weights / 2, strict=True):
            for q, across in zip((points + 1) / 2, weights / 2, strict=True):
                x, y, _ = a * (1 - p) * (1 - q) + b * p * (1 - q) + c * p * q + d * (1 - p) * q
                one, other = (b - a) * (1 - q) + (c - d) * q, (d - a) * (1 - p) + (c - b) * p
                matrix = np.stack([np.stack((v[0], v[1]), axis=-1) for v in (one, other)], axis=-2)
                slope = np.linalg.solve(matrix, np.stack((one[2], other[2]), axis=-1)[..., np.newaxis])[..., 0]
                difference = wave_gradient(x, y) - np.moveaxis(slope, -1, 0)
                total += along * across * ((difference**2).sum(axis=0) * np.linalg.det(matrix)).sum()
        return np.sqrt(total)

    # One-sided differences at the boundary make it a little larger than 1.
    assert 0.9 < effectivity(65) < 1.1
    assert abs(effectivity(65) - 1) < abs(effectivity(17) - 1)


def test_the_hierarchical_error_is_that_of_interpolation():
    def effectivity(nodes):
        grid = skewed(nodes)
        return np.linalg.norm(gg.hierarchical_error(grid, wave(*grid.planes))) / interpolation_error(grid, wave)

    assert 0.95 < effectivity(65) < 1.05
    assert abs(effectivity(65) - 1) < abs(effectivity(17) - 1)


def test_the_hierarchical_error_of_a_parabola_is_exact_in_every_cell():
    """Of width h along the parabola: its error x(h - x) has the mean square h⁴/30, at the boundary too."""
    grid = gg.domain("square", 9, 5)
    for values, h in ((grid.x**2, 1 / 8), (grid.y**2, 1 / 4)):
        np.testing.assert_allclose(gg.hierarchical_error(grid, values), np.sqrt(h**4 / 30 / 32), rtol=1e-12)


@pytest.mark.parametrize("indicator", [gg.recovery_error, gg.hierarchical_error])
def test_indicators_are_zero_for_linear_functions_and_point_at_kinks(indicator):
    grid = disordered(skewed(17), 0.1)
    assert indicator(grid, grid.x + 2 * grid.y).shape == (16, 16)
    assert np.abs(indicator(grid, grid.x + 2 * grid.y)).max() < 1e-12
    straight = gg.domain("square", 17, 17)
    kink = indicator(straight, np.abs(straight.x - 0.5))
    assert kink[7:9].min() > 0.01 * kink.max()
    assert kink[:5].max() < 1e-12


def test_richardson_finds_the_error_of_a_second_order_solver():
    grid = skewed(17)
    coarse, h = gg.Grid(grid.xy[::2, ::2]), 1 / 16

    def solved(on, size):
        return wave(*on.planes) + size**2 * np.exp(on.x)

    error = gg.richardson_error(grid, solved(grid, h), solved(coarse, 2 * h))
    np.testing.assert_allclose(error[::2, ::2], h**2 * np.exp(grid.x)[::2, ::2], rtol=1e-10)
    np.testing.assert_allclose(error, h**2 * np.exp(grid.x), rtol=0.02)
    third = gg.richardson_error(grid, solved(grid, h), solved(coarse, 2 * h), order=3)
    np.testing.assert_allclose(third, error * 3 / 7, rtol=1e-10)


@pytest.mark.parametrize(
    ("call", "match"),
    [
        (lambda g: gg.recover_gradient(g, np.ones((3, 3))), r"nodal values must have the grid's shape \(9, 9\)"),
        (lambda g: gg.recover_gradient(gg.domain("square", 9, 8), g.x[:-1]), r"shape \(9, 8\); came \(8, 9\)"),
        (lambda g: gg.recover_gradient(g, g.x * np.nan), r"node \(0, 0\) has nan"),
        (lambda g: gg.recover_gradient(g, np.where(g.x + 8 * g.y == 1.25, np.inf, 1.0)), r"node \(2, 1\) has inf"),
        (lambda g: gg.recover_gradient(g.xy, g.x), "expected a Grid, came ndarray"),
        (lambda g: gg.recover_gradient(gg.Grid(g.xy[::-1]), g.x), "derivatives need a valid grid"),
        (lambda g: gg.richardson_error(gg.domain("square", 8, 9), np.ones((8, 9)), g.x), "odd numbers of nodes"),
        (lambda g: gg.richardson_error(gg.domain("square", 9, 8), np.ones((9, 8)), g.x), "the grid has 9 x 8"),
        (lambda g: gg.richardson_error(g, g.x, g.x), r"every second node must have the grid's shape \(5, 5\)"),
        (lambda g: gg.richardson_error(g, g.x, g.x[::2, ::2], order=0), "must be positive; came 0"),
        (lambda g: gg.richardson_error(g, g.x, g.x[::2, ::2], order=np.nan), "must be positive; came nan"),
    ],
)
def test_values_that_cannot_be_used_are_refused(call, match):
    with pytest.raises(gg.GridgenError, match=match):
        call(gg.domain("square", 9, 9))
