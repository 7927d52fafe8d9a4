"""The logical square is [0, 1]²: what is minimized tends to its own integral, whatever the number of nodes."""

from __future__ import annotations

import numpy as np
import pytest
from support_solvers import farthest, mild_grid

import gridgen_sym as gg
from gridgen_sym.solvers.binding import make_problem
from gridgen_sym.solvers.linear.sparse import assemble_hessian
from gridgen_sym.solvers.local import sweep
from gridgen_sym.solvers.logical import LogicalRectangle
from gridgen_sym.solvers.multilevel.nested import coarse_shapes
from gridgen_sym.solvers.subdomains import restrict

COMBINED = {"k_A": 0.4, "k_L": 0.3, "k_O": 0.3}


def annulus(ni, nj):
    return gg.domain("quarter_annulus", ni, nj)


def mild(ni, nj):
    return mild_grid(ni, nj, 0.0)


def distances(name, parameters, start, shapes, spacing="unit"):
    """Return how far the minimum of the energy is from the solution of the equations on the unit square."""
    found = []
    for shape in shapes:
        minimum = gg.optimize(start(*shape), name, parameters=parameters, spacing=spacing, tolerance=1e-9)
        solution = gg.solve_euler_lagrange(minimum.grid, name, parameters=parameters, tolerance=1e-9)
        assert minimum.converged
        assert solution.converged
        found.append(farthest(minimum.grid, solution.grid))
    return found


@pytest.mark.parametrize(
    ("name", "parameters", "start", "shapes", "ratio"),
    [
        ("combined", COMBINED, annulus, [(9, 9), (17, 17), (33, 33)], 3.9),
        ("combined", COMBINED, annulus, [(9, 5), (17, 9), (33, 17)], 3.8),
        ("area_winslow", {"k": 0.5}, mild, [(9, 9), (17, 17), (33, 33)], 3.3),
    ],
    ids=["combined", "combined on a longer grid", "area_winslow"],
)
def test_a_minimum_of_mixed_degree_tends_to_the_solution_of_its_equations(name, parameters, start, shapes, ratio):
    found = distances(name, parameters, start, shapes)
    assert 1e-4 < found[0] < 1e-3
    assert min(np.divide(found[:-1], found[1:])) > ratio


def test_the_sums_over_the_index_tend_to_another_grid():
    """To that of length: squares of areas vanish beside those of lengths."""
    found = distances("combined", COMBINED, annulus, [(9, 9), (17, 17)], "index")
    assert found[1] > found[0] > 0.12
    length = gg.optimize(annulus(17, 17), "length", keep_valid=False).grid
    mixed = gg.optimize(annulus(17, 17), "combined", parameters=COMBINED, spacing="index", keep_valid=False).grid
    assert farthest(mixed, length) < 0.02


@pytest.mark.parametrize("name", ["length", "knupp", "liao", "winslow", "modified_liao"])
@pytest.mark.parametrize("method", ["newton", "local"])
def test_on_square_grids_steps_are_a_factor_of_a_homogeneous_energy(name, method):
    start = mild_grid(9, 9)
    unit, index = (gg.optimize(start, name, method, spacing=spacing) for spacing in ("unit", "index"))
    assert farthest(unit.grid, index.grid) < 1e-9
    degree = {"length": 2, "winslow": 0, "modified_liao": 0}.get(name, 4)
    assert unit.energy == pytest.approx(index.energy * 8.0 ** (degree - 2), rel=1e-9)
    assert unit.iterations == index.iterations


def test_winslow_tends_to_one_grid_whatever_the_steps():
    """Its equations are homogeneous in xi and in eta, so that only the error of second order knows of the steps."""
    apart = [
        farthest(*(gg.optimize(mild(ni, nj), "winslow", spacing=one, tolerance=1e-9).grid for one in ("unit", "index")))
        for ni, nj in ((9, 17), (17, 33), (33, 65))
    ]
    assert apart[0] > 1e-4
    assert min(np.divide(apart[:-1], apart[1:])) > 3


@pytest.mark.parametrize("name", ["length", "area", "winslow", "combined"])
def test_the_energy_tends_to_four_integrals(name):
    """Of the map (1 + xi, ...) of a ring in polar coordinates, r = 1 + xi and the angle pi eta/2; the factor is that of
    `corner_factor` = 2, but 1 for winslow."""
    integrals = {
        "length": (1 + (np.pi / 2) ** 2 * 7 / 3) / 2,
        "area": (np.pi / 2) ** 2 * 7 / 3 / 2,
        "winslow": 2 / np.pi * np.log(2) + np.pi / 2 * 1.5,
    }
    integrals["combined"] = 0.4 * integrals["area"] + 0.2 * integrals["length"]
    factor = 4 if name == "winslow" else 8
    errors = []
    for ni, nj in ((9, 17), (17, 33), (33, 65)):
        r, angle = np.meshgrid(np.linspace(1, 2, ni), np.linspace(0, np.pi / 2, nj), indexing="ij")
        grid = gg.Grid.from_planes(r * np.cos(angle), r * np.sin(angle))
        errors.append(abs(gg.energy(grid, name) / factor - integrals[name]))
    assert errors[-1] < 2e-3 * integrals[name]
    assert min(np.divide(errors[:-1], errors[1:])) > 3.8


# ---- the steps of parts and of coarse grids ----


def test_a_part_of_a_grid_keeps_the_steps_of_the_whole():
    grid = mild_grid(17, 9)
    whole = make_problem(grid, "combined", parameters=COMBINED)
    window = slice(3, 12), slice(2, 8)
    part, place = restrict(whole, grid.planes, window)
    assert part.steps == whole.steps == (1 / 16, 1 / 8)
    inner = np.s_[:, 1:-1, 1:-1]
    expected = whole.energy_gradient(grid.planes)[2][:, *window][inner]
    np.testing.assert_allclose(part.energy_gradient(place)[2][inner], expected, rtol=1e-12)
    free = np.ones(grid.shape, dtype=np.uint8)
    free[4:11, 3:7] = 0
    np.testing.assert_allclose(
        assemble_hessian(part.hessian(place), part.fixed).toarray(),
        assemble_hessian(whole.hessian(grid.planes), free).toarray(),
        rtol=1e-12,
        atol=1e-15,
    )


@pytest.mark.parametrize("spacing", ["unit", "index", (0.3, 0.2)])
def test_coarse_grids_are_of_the_same_logical_rectangle(spacing):
    rectangle = LogicalRectangle.of(spacing, (65, 33))
    extents = {"unit": (1, 1), "index": (64, 32)}.get(spacing, (0.3 * 64, 0.2 * 32))
    for ni, nj in coarse_shapes((65, 33)):
        steps = make_problem(mild(ni, nj), "length", spacing=rectangle).steps
        assert np.multiply(steps, (ni - 1, nj - 1)) == pytest.approx(extents, rel=1e-14)
    assert LogicalRectangle.of(rectangle, (5, 5)) is rectangle


def test_sweeps_lower_the_energy_of_the_steps():
    grid = mild_grid(9, 17)
    problem, place = make_problem(grid, "combined", parameters=COMBINED), grid.planes.copy()
    before = problem.energy(place)[0]
    for _ in range(300):
        sweep(problem, place, problem.fixed, floor=0.0, reach=1.0)
    after = gg.optimize(grid, "combined", parameters=COMBINED, tolerance=1e-10)
    assert problem.energy(place)[0] == pytest.approx(after.energy, rel=1e-9)
    assert problem.energy(place)[0] < before
