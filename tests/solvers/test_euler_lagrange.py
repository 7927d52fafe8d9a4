"""Solve the Euler–Lagrange equations: to exact maps at second order, alike by both methods, and honestly."""

from __future__ import annotations

import math
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
import sympy
from support_solvers import assert_consistent, edges, farthest, mild_grid

import gridgen_sym as gg

CLASSICAL = ("swan", "chevron", "horseshoe")
SECOND_ORDER = 1.8

# ---- residuals, derived in the test ----


@cache
def residual_function(name):
    """Return the two expanded Euler–Lagrange equations, from the density alone, as a function of 4 + 6 derivatives."""
    first = sympy.symbols("x_xi y_xi x_eta y_eta", real=True)
    second = {key: sympy.Symbol(key) for key in ("xii", "xie", "xee", "yii", "yie", "yee")}
    a, b, c, d = first
    metric = {"g11": a * a + b * b, "g22": c * c + d * d, "g12": a * c + b * d, "J": a * d - b * c, "s": 1}
    definition = gg.functional(name)
    density = definition.expression().subs(
        {sympy.Symbol(key, real=True): value for key, value in (metric | dict(definition.parameters)).items()}
    )
    # d/dxi and d/deta of a flux, by the chain rule over the four first derivatives.
    along = (("xii", "yii", "xie", "yie"), ("xie", "yie", "xee", "yee"))
    equations = [
        sum(
            sympy.diff(density, first[component + 2 * direction], p) * second[key]
            for direction in (0, 1)
            for p, key in zip(first, along[direction], strict=True)
        )
        for component in (0, 1)
    ]
    return sympy.lambdify([*first, *second.values()], equations, "numpy")


def residual_norm(grid, name):
    """Return the norm of the residual on the unit square by central differences at the inner nodes."""
    h, k = (1 / (count - 1) for count in grid.shape)
    mid = grid.planes[:, 1:-1, 1:-1]
    west, east, south, north = (
        grid.planes[:, :-2, 1:-1],
        grid.planes[:, 2:, 1:-1],
        grid.planes[:, 1:-1, :-2],
        grid.planes[:, 1:-1, 2:],
    )
    corners = grid.planes[:, 2:, 2:] - grid.planes[:, 2:, :-2] - grid.planes[:, :-2, 2:] + grid.planes[:, :-2, :-2]
    (x_xi, y_xi), (x_eta, y_eta) = (east - west) / (2 * h), (north - south) / (2 * k)
    (xii, yii), (xee, yee) = (east - 2 * mid + west) / h**2, (north - 2 * mid + south) / k**2
    xie, yie = corners / (4 * h * k)
    return float(np.linalg.norm(residual_function(name)(x_xi, y_xi, x_eta, y_eta, xii, xie, xee, yii, yie, yee)))


# ---- classical domains ----


@pytest.mark.parametrize("domain", CLASSICAL)
@pytest.mark.parametrize("name", ["length", "winslow", "modified_liao"])
def test_newton_converges_on_the_classical_domains(domain, name):
    start = gg.domain(domain, 41, 41)
    result = gg.solve_euler_lagrange(start, name, keep_valid=False)
    assert result.converged, result.message
    assert np.array_equal(edges(result.grid.xy), edges(start.xy))
    assert residual_norm(result.grid, name) <= 1e-6 * residual_norm(start, name)
    assert_consistent(result, name)
    if name == "length":
        assert result.quality.folded_cells > 0
        assert "folded" in result.message
    else:
        assert result.quality.valid
        assert ("untangled" in result.message) == (domain == "swan")


@pytest.mark.parametrize("domain", CLASSICAL)
@pytest.mark.parametrize("name", ["length", "winslow"])
def test_relaxation_finds_the_grid_of_newtons_method(domain, name):
    start = gg.domain(domain, 41, 41)
    newton, relaxed = (
        gg.solve_euler_lagrange(start, name, method, tolerance=1e-10, keep_valid=False)
        for method in ("newton", "relaxation")
    )
    assert relaxed.converged, relaxed.message
    assert farthest(relaxed.grid, newton.grid) < 1e-8
    assert relaxed.iterations > newton.iterations
    assert_consistent(relaxed, name)


@pytest.mark.parametrize("factor", [0.5, 1.0, 1.5])
def test_the_factor_of_relaxation_changes_the_way_and_not_the_end(factor):
    start = gg.domain("chevron", 15, 13)
    expected = gg.solve_euler_lagrange(start, "winslow", tolerance=1e-10)
    result = gg.solve_euler_lagrange(start, "winslow", "relaxation", relaxation=factor, tolerance=1e-10)
    assert result.converged
    assert farthest(result.grid, expected.grid) < 1e-8


@pytest.mark.parametrize("method", ["newton", "relaxation"])
@pytest.mark.parametrize("name", ["length", "winslow", "modified_liao"])
def test_fixed_inner_nodes_do_not_move(method, name):
    start = mild_grid(11, 10)
    fixed = np.zeros(start.shape, dtype=bool)
    fixed[4, 5] = True
    result = gg.solve_euler_lagrange(start, name, method, fixed=fixed)
    assert np.array_equal(result.grid.xy[4, 5], start.xy[4, 5])
    assert result.converged
    assert farthest(result.grid, start) > 1e-3


# ---- exact maps ----


def exponential(w):
    """A conformal map: harmonic, and so is its inverse."""
    return np.exp(0.9 * w)


def harmonic(w):
    """A harmonic map that is not conformal: the real and imaginary parts of two different analytic functions."""
    return (w + 0.2 * np.exp(1.3 * w)).real + 1j * (w + 0.15 * np.sin(1.7 * w)).imag


def inverse_harmonic(w):
    """A map whose inverse is harmonic and which is not conformal: xi, eta are linear in the harmonic log r, theta."""
    return np.exp(0.7 * w.real + 0.2 * w.imag + 1j * (0.1 * w.real + 1.1 * w.imag))


def sample(exact, cells, height=1.0):
    """Return the exact map at the nodes over [0, 1] x [0, height], as a grid."""
    xi, eta = np.meshgrid(np.linspace(0, 1, cells + 1), np.linspace(0, height, cells + 1), indexing="ij")
    z = exact(xi + 1j * eta)
    return gg.Grid.from_planes(z.real, z.imag)


def errors(solve, exact, height=1.0):
    """Return the largest error of the nodes for 8, 16 and 32 cells, from a start that knows the boundary alone."""
    found = []
    for cells in (8, 16, 32):
        expected = sample(exact, cells, height)
        xy = expected.xy
        result = solve(gg.transfinite(xy[:, 0], xy[:, -1], xy[0], xy[-1]), (1 / cells, height / cells))
        assert result.converged, result.message
        found.append(farthest(result.grid, expected))
    return found


def assert_second_order(found):
    assert found[0] > 1e-6, "the map is so simple that the test says nothing"
    for coarse, fine in pairwise(found):
        assert math.log2(coarse / fine) > SECOND_ORDER, found


@pytest.mark.parametrize("method", ["newton", "relaxation"])
@pytest.mark.parametrize(
    ("name", "exact"),
    [
        ("length", exponential),
        ("length", harmonic),
        ("winslow", exponential),
        ("winslow", inverse_harmonic),
    ],
)
def test_exact_maps_are_approached_at_second_order(name, exact, method):
    assert_second_order(errors(lambda start, _: gg.solve_euler_lagrange(start, name, method), exact))


def test_a_conformal_map_solves_the_equations_of_modified_liao():
    """Its density is the square of Winslow's, which is least, and so stationary, where the map is conformal."""
    assert_second_order(errors(lambda start, _: gg.solve_euler_lagrange(start, "modified_liao"), exponential))


def test_the_spacing_of_the_logical_coordinates_counts():
    solve = lambda start, spacing: gg.solve_euler_lagrange(start, "length", spacing=spacing)  # noqa: E731
    assert_second_order(errors(solve, harmonic, height=0.6))
    unit = errors(lambda start, _: gg.solve_euler_lagrange(start, "length"), harmonic, height=0.6)
    assert unit[-1] > 1e-3


def test_the_test_of_exact_maps_can_fail():
    """The solution of another system stays away from the map."""
    found = errors(lambda start, _: gg.solve_euler_lagrange(start, "length"), inverse_harmonic)
    assert found[-1] > 0.5 * found[0] > 1e-3


@pytest.mark.parametrize("domain", ["quarter_annulus", "mild"])
@pytest.mark.parametrize("name", ["winslow", "modified_liao"])
def test_the_discrete_minimum_and_the_equations_approach_each_other(name, domain):
    """On domains whose corners are nearly right: the solution of a continuous problem is singular at others."""
    found = []
    for cells in (8, 16, 32):
        start = mild_grid(cells + 1, cells + 1, 0.0) if domain == "mild" else gg.domain(domain, cells + 1, cells + 1)
        minimum = gg.optimize(start, name, tolerance=1e-10)
        solution = gg.solve_euler_lagrange(start, name, tolerance=1e-10)
        assert minimum.converged
        assert solution.converged
        found.append(farthest(minimum.grid, solution.grid))
    assert found[0] > 1e-4
    assert found[1] < found[0] / 2.5
    assert found[2] < found[1] / 3


# ---- equations that are not elliptic ----


@pytest.mark.parametrize("domain", ["quarter_annulus", "chevron", "wavy", "swan"])
@pytest.mark.parametrize("name", ["area", "orthogonality", "knupp", "combined", "liao"])
def test_convergence_is_told_honestly(name, domain):
    start = gg.domain(domain, 11, 11)
    result = gg.solve_euler_lagrange(start, name, max_iterations=60)
    least = (
        residual_norm(result.grid, name) / residual_norm(start, name) if domain != "chevron" or name != "area" else 0
    )
    assert result.converged == (least <= 1.01e-8), result.message
    # A step that does not lower the residual is not taken.
    assert least <= 1
    norms = [step.gradient_norm for step in result.history]
    assert all(after <= before for before, after in pairwise(norms))
    assert ("not elliptic" in result.message) == (name != "liao")
    kind = {"area": "degenerate", "liao": ""}.get(name, "changing type")
    assert kind in result.message
    assert_consistent(result, name)


@pytest.mark.parametrize("name", ["area", "orthogonality"])
def test_folds_are_told_where_it_did_not_converge(name):
    result = gg.solve_euler_lagrange(gg.domain("swan", 11, 11), name)
    assert not result.converged
    assert result.quality.folded_cells > 0
    assert "folded" in result.message


# ---- the course of a run ----


@pytest.mark.parametrize("method", ["newton", "relaxation"])
def test_the_callback_sees_every_step(method):
    steps = []
    result = gg.solve_euler_lagrange(mild_grid(), "winslow", method, callback=steps.append)
    assert tuple(steps) == result.history
    assert [step.iteration for step in steps] == list(range(result.iterations + 1))
    assert all(math.isnan(step.energy) for step in steps)


@pytest.mark.parametrize("method", ["newton", "relaxation"])
def test_an_error_in_the_callback_comes_through(method):
    def stop(step):
        raise KeyError("enough")

    with pytest.raises(KeyError, match="enough"):
        gg.solve_euler_lagrange(mild_grid(), "winslow", method, callback=stop)


@pytest.mark.parametrize("method", ["newton", "relaxation"])
@pytest.mark.parametrize("name", ["length", "winslow", "modified_liao"])
def test_no_iterations_return_the_start_and_a_solution_converges_at_once(method, name):
    start = mild_grid()
    result = gg.solve_euler_lagrange(start, name, method, max_iterations=0)
    assert (result.converged, result.iterations, result.grid) == (False, 0, start)
    solution = gg.solve_euler_lagrange(start, name, tolerance=1e-13, max_iterations=30).grid
    again = gg.solve_euler_lagrange(solution, name, method)
    assert again.iterations <= 1, again.message
    assert again.converged, again.message


@pytest.mark.parametrize("method", ["newton", "relaxation"])
def test_the_best_valid_grid_is_returned_where_that_is_asked_for(method):
    start = gg.domain("chevron", 15, 15)
    folded, valid = (gg.solve_euler_lagrange(start, "length", method, keep_valid=keep) for keep in (False, True))
    assert folded.converged
    assert folded.quality.folded_cells > 0
    assert "folded" in folded.message
    assert not valid.converged
    assert valid.quality.valid
    left, kept, given = (residual_norm(grid, "length") for grid in (folded.grid, valid.grid, start))
    # The first sweep folds a cell, so that the start is the best valid grid of a relaxation.
    assert left < kept < given or (method == "relaxation" and valid.grid == start)


@pytest.mark.parametrize(("scale", "shift"), [(1e-6, 0.0), (1e6, 0.0), (1.0, 1e3), (1e-6, 1e3), (1e6, 1e3)])
@pytest.mark.parametrize("method", ["newton", "relaxation"])
def test_neither_size_nor_place_matter(scale, shift, method):
    start = mild_grid()
    expected = gg.solve_euler_lagrange(start, "winslow", method)
    result = gg.solve_euler_lagrange(gg.Grid((start.xy + shift) * scale), "winslow", method)
    assert result.converged, result.message
    assert farthest(gg.Grid(result.grid.xy / scale - shift), expected.grid) < 1e-7


def test_both_backends_give_one_solution(backend):
    start = mild_grid(11, 9)
    expected = gg.solve_euler_lagrange(start, "winslow", tolerance=1e-10)
    for method in ("newton", "relaxation"):
        result = gg.solve_euler_lagrange(start, "winslow", method, tolerance=1e-10, backend=backend)
        assert farthest(result.grid, expected.grid) < 1e-9
