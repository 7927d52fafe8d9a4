"""How nodes are moved: without a folded cell, so often in each step, and by a damping that Aitken's rule chooses."""

from __future__ import annotations

import numpy as np
import pytest

import gridgen_sym as gg
from gridgen_sym.adaptation.mover import Mover, movement
from gridgen_sym.adaptation.sides import SideSpacing
from gridgen_sym.adaptation.weight_exponent import WeightExponent

from .conftest import front, ring, square, two_scales


def test_every_grid_on_the_way_is_valid_also_with_too_much_asked_of_it():
    smallest = []
    monitor = gg.Monitor("gradient", feature_fraction=0.99, smoothing=0)
    result = gg.adapt(
        square(),
        front,
        monitor=monitor,
        damping=1.0,
        max_iterations=6,
        callback=lambda step: smallest.append(step.min_jacobian),
    )
    assert min(smallest) > 0
    assert len(smallest) == 7
    assert result.quality.valid


@pytest.mark.parametrize("functional", ["area", "length", "combined"])
def test_functionals_without_a_barrier_do_not_fold_either(functional):
    result = gg.adapt(square(17), two_scales, functional=functional, max_iterations=8)
    assert result.quality.valid
    assert result.history[-1].error < result.history[0].error


def test_a_grid_that_cannot_move_is_not_called_settled():
    """Length folds cells in a domain like this one: its minimum cannot be reached."""
    start = gg.optimize(gg.domain("annulus", 33, 17), "winslow").grid
    result = gg.adapt(start, "tanh(20*(x - 0.2))", functional="length")
    assert result.quality.valid
    assert not result.converged
    assert "length is not minimized: every step downhill that was tried would fold a cell" in result.message


def solver(grid):
    return ring(grid.x, grid.y)


@pytest.mark.parametrize(
    ("solution", "given", "moves"), [(ring, 3, 3), (ring, None, 1), (solver, 1, 1), (solver, None, 3)]
)
def test_nodes_are_moved_so_often_in_each_step(solution, given, moves, monkeypatch):
    calls = []

    def counted(grid, *arguments, optimize=gg.optimize, **options):
        calls.append(grid)
        return optimize(grid, *arguments, **options)

    monkeypatch.setattr("gridgen_sym.adaptation.mover.optimize", counted)
    result = gg.adapt(square(17), solution, max_iterations=2, moves=given)
    assert (len(calls), result.iterations) == (2 * moves, 2)


def test_parameters_are_those_of_the_functional():
    """With much of Winslow's smoothness the weight changes little."""
    start = square(17)
    free, stiff = (
        gg.adapt(start, ring, max_iterations=3, boundary="fixed", parameters={"k": k}).grid for k in (1e-9, 1e3)
    )
    assert movement(start, stiff) < 0.1 * movement(start, free)


@pytest.mark.slow
@pytest.mark.parametrize("nodes", [17, 33, 65])
def test_a_front_through_two_corners_settles_soon(nodes):
    """Its nodes crowd from both sides of the corners; a damping that is only ever lowered takes 18 to 31 steps."""
    result = gg.adapt(square(nodes), front)
    assert result.converged, result.message
    assert result.iterations <= 20
    dampings = [step.damping for step in result.history]
    assert dampings[0] == dampings[1] == 0.5
    assert max(dampings) > 0.5


def test_the_damping_of_a_step_is_chosen_anew():
    shares = [step.damping for step in gg.adapt(square(17), ring, max_iterations=4, damping=0.4).history]
    assert shares[:2] == [0.4, 0.4]
    assert len(set(shares[1:])) == 4


@pytest.mark.parametrize(
    ("damping", "rest", "expected"),
    [(0.5, 0.5, 1.0), (0.5, 1.0, 0.5), (0.5, -10.0, 0.1), (0.05, -10.0, 0.05), (0.9, 0.7, 2.0)],
)
def test_the_damping_is_that_which_would_have_left_nothing(damping, rest, expected):
    """Of a move that leaves a part of the lack; within bounds, and the same as before where it has changed nothing."""
    fixed = np.ones((5, 5), dtype=np.uint8)
    mover = Mover(gg.functional("area_winslow"), WeightExponent(1, 2), {}, fixed, None, damping, SideSpacing({}))
    residual = 1e-3 * np.random.default_rng(0).normal(size=(5, 5))
    mover._choose_damping(residual)
    mover._choose_damping(rest * residual)
    assert mover.damping == pytest.approx(expected)


def test_a_movement_is_a_part_of_the_domain():
    xy = 300.0 * square(5).xy
    xy[2, 2] += 3.0, 4.0
    for unit in (1.0, 1e-6):
        grid = gg.Grid(unit * 300.0 * square(5).xy)
        assert movement(grid, gg.Grid(unit * xy)) == pytest.approx(5.0 / 300.0)
