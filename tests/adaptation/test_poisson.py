"""Solve and adapt in turns: Poisson's equation by scikit-fem's finite elements, with a known sharp solution."""

from __future__ import annotations

import numpy as np
import pytest

import gridgen_sym as gg

from .conftest import front, interpolation_error, ring, shock

skfem = pytest.importorskip("skfem")


def mesh_of(grid):
    """Return the grid as a mesh of quadrilaterals whose vertices are the nodes, in the order of the array."""
    number = np.arange(grid.x.size).reshape(grid.shape)
    cells = np.stack((number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]))
    return skfem.MeshQuad(grid.planes.reshape(2, -1), cells.reshape(4, -1))


def poisson_solver(exact, element):
    """Return the function that solves -div grad u = f on a grid, u being `exact` on the boundary; nodal values."""
    from skfem.helpers import dot, grad

    def source(x, y, h=1e-4):
        around = exact(x + h, y) + exact(x - h, y) + exact(x, y + h) + exact(x, y - h)
        return (4 * exact(x, y) - around) / h**2

    def solve(grid):
        basis = skfem.Basis(mesh_of(grid), element(), intorder=6)
        stiffness = skfem.BilinearForm(lambda u, v, w: dot(grad(u), grad(v))).assemble(basis)
        load = skfem.LinearForm(lambda v, w: source(*w.x) * v).assemble(basis)
        boundary = basis.get_dofs()
        u = np.zeros(basis.N)
        u[boundary] = exact(*basis.doflocs[:, np.asarray(boundary)])
        u = skfem.solve(*skfem.condense(stiffness, load, x=u, D=boundary))
        return u[basis.nodal_dofs[0]].reshape(grid.shape)

    return solve


@pytest.mark.slow
@pytest.mark.parametrize("measure", ["curvature", "recovery_error", "hierarchical_error"])
@pytest.mark.parametrize("exact", [front, shock, ring])
def test_error_of_the_solution_is_at_most_a_third(exact, measure):
    start, solve = gg.domain("square", 33, 33), poisson_solver(exact, skfem.ElementQuad1)
    result = gg.adapt(start, solve, monitor=measure, max_iterations=8)
    assert result.quality.valid
    assert result.iterations <= 8
    uniform, adapted = (interpolation_error(grid, exact, solve(grid)) for grid in (start, result.grid))
    # Measured: 0.03 to 0.33.
    assert adapted < uniform / 3
    # The values that come back are those of the solver on the grid that comes back.
    np.testing.assert_allclose(result.values, solve(result.grid), atol=1e-9)


def test_quadratic_elements_profit_too():
    start, solve = gg.domain("square", 25, 25), poisson_solver(shock, skfem.ElementQuad2)
    result = gg.adapt(start, solve, max_iterations=8)
    assert result.quality.valid
    uniform, adapted = (interpolation_error(grid, shock, solve(grid)) for grid in (start, result.grid))
    assert adapted < uniform / 3


def test_the_estimate_follows_the_true_error():
    """The front is seen a little too wide on the uniform grid; on the adapted one the estimate is good."""
    start = gg.domain("square", 33, 33)
    result = gg.adapt(start, poisson_solver(shock, skfem.ElementQuad1), max_iterations=8)
    true = interpolation_error(result.grid, shock, result.values)
    assert 0.5 < result.history[-1].error / true < 2
    assert result.history[-1].error < result.history[0].error / 3
