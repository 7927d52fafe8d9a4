"""The multigrid over blocks: it solves what a factorization solves, in a number of steps that does not grow."""

from __future__ import annotations

import numpy as np
import pytest
from layouts import butterfly, cut, ring

import gridgen_sym as gg
from gridgen_sym.runtime import find_compiler
from gridgen_sym.solvers.layout import levels
from gridgen_sym.solvers.layout.binding import make_layout_problem
from gridgen_sym.solvers.layout.linear import LayoutDirectSolver
from gridgen_sym.solvers.layout.multigrid import LayoutMultigrid

pytestmark = pytest.mark.skipif(find_compiler() is None, reason="multigrid is compiled")


@pytest.fixture(autouse=True)
def many_levels(monkeypatch):
    """Small grids would be factorized as they are."""
    monkeypatch.setattr(levels, "_FEWEST_NODES", 24)


def sector():
    nodes = ring(np.linspace(0, 2 * np.pi / 6, 9), 1.0, 3.0, 17)
    return gg.MultiBlock([nodes], [gg.Connection((0, "left"), (0, "right"), rotation=-60)])


def grid_of_size(nodes):
    lines = np.linspace(0, nodes - 1, 4 + 1).astype(int)
    return cut(gg.domain("wavy", nodes, nodes), lines, lines)


LAYOUTS = {
    "cut": lambda: cut(gg.domain("wavy", 17, 33), (0, 4, 16), (0, 16, 20, 32)),
    "odd": lambda: cut(gg.domain("wavy", 14, 20), (0, 5, 13), (0, 6, 19)),
    "ring": lambda: gg.MultiBlock([ring(np.linspace(0, 2 * np.pi, 33), 1.0, 3.0, 9)]),
    "sector": sector,
    "pipe": lambda: butterfly(8, 6),
    "odd pipe": lambda: butterfly(7, 9),
}


def system(layout):
    """A problem, its Hessian at the start, and a right-hand side."""
    problem = make_layout_problem(layout, "winslow")
    place = problem.exchange.join([block.planes for block in layout.blocks])
    right = problem.exchange.of_first_copies(np.random.default_rng(0).normal(size=place.shape))
    right[problem._held] = 0.0
    return problem, problem.hessian(place, semidefinite=True), right


@pytest.mark.parametrize("make", LAYOUTS.values(), ids=LAYOUTS)
def test_it_solves_what_a_factorization_solves(make):
    problem, hessian, right = system(make())
    arguments = problem.exchange, problem.copies, problem.fixed
    direct, multigrid = LayoutDirectSolver(*arguments), LayoutMultigrid(*arguments, problem.bonds)
    assert direct.set_operator(hessian)
    expected = direct.solve(right, 0.0).vector
    for _ in range(2):  # The second time with the levels of the first.
        assert multigrid.set_operator([2 * planes for planes in hessian])
        found = multigrid.solve(right, 1e-9)
        assert found.positive
        assert found.iterations <= 18
        assert found.vector == pytest.approx(expected / 2, abs=1e-5 * np.abs(expected).max())


@pytest.mark.parametrize("sizes", [(33, 129), (36, 134)], ids=["even", "odd"])
def test_the_number_of_steps_does_not_grow_with_the_grid(sizes):
    """Whatever the numbers of cells are: with odd ones, too, the coarsest level is small."""
    steps = []
    for nodes in sizes:
        problem, hessian, right = system(grid_of_size(nodes))
        solver = LayoutMultigrid(problem.exchange, problem.copies, problem.fixed, problem.bonds)
        assert solver.set_operator(hessian)
        assert solver.levels[-1].node_count <= 36
        steps.append(solver.solve(right, 1e-6).iterations)
    assert steps[1] <= 14


@pytest.mark.parametrize(("growth", "most"), [(1.0, 8), (1.2, 20), (1.3, 25)])
def test_thin_cells_on_both_sides_of_a_connection(growth, most):
    """Heights down to 1e-4 of the length: a node there moves with the columns of cells on both sides."""
    x, y = np.linspace(0, 1, 33), np.concatenate(([0], np.cumsum(growth ** np.arange(32))))
    y = (0.01 if growth == 1 else 1.0) * y / y[-1]
    blocks = [gg.Grid.from_planes(*np.meshgrid(x, one, indexing="ij")) for one in (y, -y[::-1])]
    layout = gg.MultiBlock(blocks)
    problem = make_layout_problem(layout, "winslow", target=layout)
    place = problem.exchange.join([block.planes for block in layout.blocks])
    hessian = problem.hessian(place, semidefinite=True)
    right = problem.exchange.of_first_copies(np.random.default_rng(0).normal(size=place.shape))
    right[problem._held] = 0.0
    solver = LayoutMultigrid(problem.exchange, problem.copies, problem.fixed, problem.bonds)
    assert solver.set_operator(hessian)
    found = solver.solve(right, 1e-6)
    assert found.positive
    assert found.iterations <= most


def test_double_precision_takes_over_where_cells_are_too_thin():
    """An aspect ratio of 1e5; where it is the Hessian that is not positive, single precision stays."""
    y = np.concatenate(([0], np.cumsum(1.6 ** np.arange(32))))
    blocks = [gg.Grid.from_planes(*np.meshgrid(np.linspace(0, 1, 9), one, indexing="ij")) for one in (y, -y[::-1])]
    layout = gg.MultiBlock([gg.Grid.from_planes(grid.x, grid.y / y[-1]) for grid in blocks])
    problem = make_layout_problem(layout, "winslow", target=layout)
    place = problem.exchange.join([block.planes for block in layout.blocks])
    hessian = problem.hessian(place, semidefinite=True)
    right = problem.exchange.of_first_copies(np.random.default_rng(0).normal(size=place.shape))
    right[problem._held] = 0.0
    solver = problem.solver()
    assert solver.set_operator([-planes for planes in hessian]) is False
    wrong = [planes.copy() for planes in hessian]
    for planes in wrong:
        planes[3:11] *= 1.5
    assert not (solver.set_operator(wrong) and solver.solve(right, 1e-6).positive)
    assert solver._now is not solver._precise
    assert solver.set_operator(hessian)
    found = solver.solve(right, 1e-6)
    assert solver._now is solver._precise
    assert found.positive
    assert found.iterations <= 20


def test_any_number_of_threads_gives_the_same_bits(monkeypatch):
    vectors = []
    for threads in ("1", "2", "3"):
        monkeypatch.setenv("OMP_NUM_THREADS", threads)
        for layout in (grid_of_size(129), gg.MultiBlock([ring(np.linspace(0, 2 * np.pi, 257), 1.0, 3.0, 129)])):
            problem, hessian, right = system(layout)
            solver = problem.solver()
            assert solver.set_operator(hessian)
            vectors.append(solver.solve(right, 1e-6).vector)
    assert all(np.array_equal(vectors[k], vectors[k % 2]) for k in range(2, 6))


def test_a_hessian_that_is_not_positive_is_told():
    problem, hessian, right = system(LAYOUTS["cut"]())
    solver = problem.solver()
    assert solver.set_operator(hessian)
    assert not (solver.set_operator([-planes for planes in hessian]) and solver.solve(right, 1e-6).positive)
    assert not solver.set_operator([np.nan * planes for planes in hessian])
    for planes in hessian:
        planes[3:] *= 3.0  # Couplings outweigh the diagonal, whose blocks are positive.
    assert not (solver.set_operator(hessian) and solver.solve(right, 1e-6).positive)
