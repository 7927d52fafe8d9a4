"""One multigrid cycle as a preconditioner, with nodes inside that are fixed: symmetric, and nothing flows from them."""

import numpy as np
import pytest

import gridgen_sym as gg
from gridgen_sym.runtime import HESSIAN_PLANES, find_compiler
from gridgen_sym.solvers.binding import make_problem
from gridgen_sym.solvers.linear import multigrid
from gridgen_sym.solvers.linear.multigrid import GeneralMultigrid, Multigrid
from gridgen_sym.solvers.linear.sparse import assemble_hessian, assemble_jacobian, to_vector

pytestmark = pytest.mark.skipif(find_compiler() is None, reason="multigrid is compiled")

SHAPES = [(33, 34), (40, 13), (12, 70)]


def bound(shape):
    """A problem with a block, a line and single nodes fixed inside, on every level of the hierarchy, and its grid."""
    fixed = np.zeros(shape, dtype=bool)
    fixed[shape[0] // 2 :: 8, ::4] = True
    fixed[4, 2:9] = True
    fixed[6:9, 4:7] = True
    grid = gg.domain("wavy", *shape)
    return make_problem(grid, "winslow", fixed=fixed), grid.planes.copy()


@pytest.mark.parametrize("shape", SHAPES, ids=str)
def test_systems_with_fixed_nodes_inside_are_solved(shape):
    problem, coordinates = bound(shape)
    free = problem.fixed == 0
    right = np.random.default_rng(0).normal(size=(2, *shape)) * free
    cases = (
        (Multigrid, problem.hessian(coordinates, semidefinite=True), assemble_hessian),
        (GeneralMultigrid, problem.kernels.euler_lagrange_jacobian(coordinates), assemble_jacobian),
    )
    for make, planes, assemble in cases:
        matrix = assemble(planes, problem.fixed)
        solver = make(problem.fixed)
        assert solver.set_operator(planes)
        solution = solver.solve(right, 1e-4)
        assert not solution.vector[:, ~free].any()
        residual = matrix @ to_vector(solution.vector, problem.fixed) - to_vector(right, problem.fixed)
        assert np.linalg.norm(residual) <= 1e-3 * np.linalg.norm(right)
        assert solution.iterations <= 16


@pytest.mark.parametrize("shape", [(33, 34), (34, 34), (40, 13)], ids=str)
def test_a_cycle_is_symmetric(shape, monkeypatch):
    """One step of conjugate gradients gives c M r: M is symmetric if three right-hand sides commute around the ring.

    With a_jk = r_j . c_k M r_k, the factors c cancel in a_01 a_12 a_20 = a_10 a_21 a_02.
    """
    monkeypatch.setattr(multigrid, "_MOST_ITERATIONS", 1)
    problem, coordinates = bound(shape)
    solver = Multigrid(problem.fixed)
    assert solver.set_operator(problem.hessian(coordinates, semidefinite=True))
    right = np.random.default_rng(0).uniform(0, 1, size=(3, 2, *shape)) * (problem.fixed == 0)
    right[:, :, : shape[0] // 2] *= np.array([0.1, 1, 3])[:, None, None, None]
    steps = [solver.solve(one, 1e-12).vector.copy() for one in right]
    a = np.einsum("jcmn,kcmn->jk", right, np.array(steps))
    assert a[0, 1] * a[1, 2] * a[2, 0] == pytest.approx(a[1, 0] * a[2, 1] * a[0, 2], rel=5e-6)


def test_negative_curvature_is_told_where_every_block_is_positive():
    """Laplace's stencil with a diagonal that is too small: blocks and lines are definite, smooth fields are not."""
    fixed = np.ones((20, 20), dtype=np.uint8)
    fixed[1:-1, 1:-1] = 0
    planes = np.zeros((HESSIAN_PLANES, 20, 20))
    planes[[0, 2]], planes[[3, 6, 7, 10]] = 3.92, -1.0
    solver = Multigrid(fixed)
    assert solver.set_operator(planes)
    assert not solver.solve(np.ones((2, 20, 20)) * (fixed == 0), 1e-10).positive
