"""The local method on several blocks: one node at a time, also those that blocks share and those that slide."""

import itertools

import numpy as np
import pytest
from layouts import butterfly, cut

import gridgen_sym as gg
from gridgen_sym.solvers.layout.binding import make_layout_problem
from gridgen_sym.solvers.layout.relaxation import LayoutSweeps


def farthest(found, expected):
    pairs = zip(found.grid.blocks, expected.grid.blocks, strict=True)
    return max(float(np.abs(one.planes - other.planes).max()) for one, other in pairs)


@pytest.mark.parametrize("backend", ["c", pytest.param("numpy", marks=pytest.mark.slow)])
def test_the_minimum_of_newtons_method_on_a_pipe_of_five_blocks(backend):
    start = butterfly(4, 2)
    expected = gg.optimize(start, "winslow", tolerance=1e-10)
    found = gg.optimize(start, "winslow", "local", tolerance=1e-8, backend=backend)
    assert found.converged
    assert found.energy == pytest.approx(expected.energy, rel=1e-14)
    assert farthest(found, expected) < 1e-7
    energies = [step.energy for step in found.history]
    assert (np.diff(energies) < 1e-13 * energies[0]).all()


def test_copies_that_are_turned_move_as_one():
    start = gg.layout("sector", around=6, outwards=4)
    expected, found = (gg.optimize(start, "winslow", method, tolerance=1e-8) for method in ("newton", "local"))
    assert found.converged
    assert 10 < found.iterations < 100  # Thousands, if their own blocks were not turned.
    assert farthest(found, expected) < 1e-7


def test_sliding_nodes_and_shared_ones_take_as_many_sweeps_as_in_one_block():
    corners, count = np.array([[0.0, 0], [1, 0], [1, 2], [0, 1]]), {"bottom": 7, "top": 7, "left": 5, "right": 5}
    ends = {"bottom": (0, 1), "top": (3, 2), "left": (0, 3), "right": (1, 2)}
    start = gg.transfinite(**{side: np.linspace(corners[a], corners[b], count[side]) for side, (a, b) in ends.items()})
    blocks = cut(start, (0, 2, 6), (0, 2, 4))
    one = gg.optimize(start, "winslow", "local", slide="all", tolerance=1e-3)
    expected = gg.optimize(blocks, "winslow", slide="all", fixed={}, tolerance=1e-10)
    found = gg.optimize(blocks, "winslow", "local", slide="all", fixed={}, tolerance=1e-3)
    assert found.converged
    assert 0.8 < found.iterations / one.iterations < 1.25
    assert farthest(found, expected) < 0.02
    assert found.quality.valid


def test_without_a_barrier_no_step_folds_a_cell():
    start = butterfly(4, 2)
    found = gg.optimize(start, "modified_liao", "local", max_iterations=20)
    assert found.quality.valid
    assert (np.diff([step.energy for step in found.history]) < 0).all()


def test_a_folded_layout_is_untangled_first():
    start = butterfly(4, 2)
    planes = [np.array(grid.planes) for grid in start.blocks]
    planes[0][:, 2, 2] = 0.9
    found = gg.optimize(start.moved(planes), "winslow", "local", tolerance=1e-4)
    assert found.converged
    assert found.untangled_by


@pytest.mark.parametrize("start", [butterfly(4, 3), gg.layout("annulus", around=7, outwards=3), gg.layout("airfoil_c")])
def test_nodes_of_one_color_have_no_cell_in_common(start):
    sweeps = LayoutSweeps(make_layout_problem(start, "winslow", slide="all"))
    copies, colors = sweeps._copies, sweeps._colors
    assert colors.max() < 6
    for block, grid in enumerate(start.blocks):
        color = np.full(grid.shape, -1)
        here = copies.block == block
        color[copies.i[here], copies.j[here]] = colors[copies.node[here]]
        node = np.full(grid.shape, -1)
        node[copies.i[here], copies.j[here]] = copies.node[here]
        corners = [(color[at], node[at]) for at in itertools.product((slice(None, -1), slice(1, None)), repeat=2)]
        for (one, a), (other, b) in itertools.combinations(corners, 2):
            assert not ((one == other) & (one >= 0) & (a != b)).any()
