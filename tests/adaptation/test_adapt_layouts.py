"""Adaptation of several blocks: the same as of one, and where no one block is left."""

from __future__ import annotations

import numpy as np
import pytest
from layouts import assembled, cut

import gridgen_sym as gg
from gridgen_sym.adaptation.layout_nodes import LayoutNodes
from gridgen_sym.adaptation.lines import LineSpacing, sliding_lines
from gridgen_sym.adaptation.monitor import as_monitor
from gridgen_sym.adaptation.nodes import BlockNodes
from gridgen_sym.adaptation.sides import SideSpacing, sliding_curves
from gridgen_sym.solvers.binding import make_problem
from gridgen_sym.solvers.layout.binding import make_layout_problem
from gridgen_sym.solvers.layout.sparse import LayoutMatrix
from gridgen_sym.solvers.linear.sparse import assemble_hessian

from .conftest import square

LINES = (0, 4, 12), (0, 6, 12)


def front(x, y):
    return np.tanh(20 * (x + y - 1))


def solver(layout):
    """A solver of several blocks, which does not know that they are one grid."""
    return {name: front(block.x, block.y) for name, block in zip(layout.names, layout.blocks, strict=True)}


def as_one(values, lines):
    """Values by block as those of the whole."""
    found = np.empty((2, lines[0][-1] + 1, lines[1][-1] + 1))
    blocks = iter(values.values())
    for i0, i1 in zip(lines[0], lines[0][1:], strict=False):
        for j0, j1 in zip(lines[1], lines[1][1:], strict=False):
            found[:, i0 : i1 + 1, j0 : j1 + 1] = next(blocks)
    return found[0]


@pytest.mark.parametrize("solution", [front, "tanh(20*(x + y - 1))", solver])
@pytest.mark.parametrize("boundary", ["fixed", "straight"])
def test_two_blocks_are_adapted_as_one(solution, boundary):
    given = {"boundary": boundary, "max_iterations": 3}
    one = gg.adapt(square(13), front, moves=1, **given)
    found = gg.adapt(cut(square(13), *LINES), solution, **given)
    assert np.array_equal(assembled(found.grid, *LINES), one.grid.planes)
    np.testing.assert_allclose(as_one(found.density, LINES), one.density, rtol=1e-12)
    np.testing.assert_allclose(as_one(found.values, LINES), one.values, rtol=1e-12)
    assert (found.history, found.status, found.message) == (one.history, one.status, one.message)
    assert str(found) == str(one)
    assert found.iterations == 3


@pytest.mark.parametrize("boundary", ["fixed", "straight"])
def test_blocks_that_are_not_put_together_come_to_the_same_grid(boundary):
    one = gg.adapt(square(13), front, boundary=boundary, max_iterations=4)
    for solution in (front, solver):
        found = gg.adapt(cut(square(13), *LINES), solution, boundary=boundary, fixed={}, max_iterations=4)
        assert np.abs(assembled(found.grid, *LINES) - one.grid.planes).max() < 5e-3
        assert found.history[-1].spread == pytest.approx(one.history[-1].spread, rel=2e-2)


@pytest.mark.parametrize("measure", ["gradient", "arc_length", "curvature", "recovery_error", "values"])
def test_densities_are_the_same_however_a_grid_is_cut(measure):
    whole = gg.optimize(gg.domain("wavy", 13, 13), "winslow").grid
    one, many = BlockNodes(whole), LayoutNodes(cut(whole, *LINES))
    values = [np.exp(front(nodes.x, nodes.y)) for nodes in (one, many)]
    monitor = as_monitor(measure)
    expected = monitor.density_at(one, values[0])
    found = as_one(many.given_back(monitor.density_at(many, values[1])), LINES)
    np.testing.assert_allclose(found, expected, rtol=1e-12)
    for recovered in ("gradient", "hessian"):
        pairs = zip(getattr(many, recovered)(values[1]), getattr(one, recovered)(values[0]), strict=True)
        for part, component in pairs:
            error = np.abs(as_one(many.given_back(part), LINES) - component).max()
            assert error < 1e-12 * np.abs(component).max()


def test_derivatives_turn_with_the_copies_of_a_sector():
    """Of the square of the radius, whose gradient points outwards everywhere; its copies are turned by 60 degrees."""
    sector = gg.layout("sector", around=16, outwards=8)
    nodes = LayoutNodes(sector)
    u_x, u_y = nodes.gradient(nodes.x**2 + nodes.y**2)
    inner = np.abs(np.hypot(nodes.x, nodes.y) - 1.5) < 0.3  # At the arcs differences are one-sided.
    np.testing.assert_allclose(np.stack((u_x, u_y))[:, inner], 2 * np.stack((nodes.x, nodes.y))[:, inner], atol=0.02)
    u_xx, u_xy, u_yy = nodes.hessian(nodes.x**2 + nodes.y**2)
    np.testing.assert_allclose(np.stack((u_xx, u_xy, u_yy))[:, inner], [[2], [0], [2]] * np.ones(inner.sum()), atol=0.2)


@pytest.mark.parametrize(
    ("layout", "given", "solution"),
    [
        ("pipe", {"across": 6, "outwards": 6}, "tanh(20*(x**2 + y**2 - 0.3))"),
        ("sector", {"around": 8, "outwards": 12}, "tanh(20*(x**2 + y**2 - 2))"),
    ],
)
def test_a_ring_in_a_layout_with_singular_or_periodic_nodes_is_found(layout, given, solution):
    start = gg.layout(layout, **given)
    found = gg.adapt(start, solution, boundary="fixed", max_iterations=6)
    assert found.quality.valid
    assert found.history[-1].spread < 0.4 * found.history[0].spread
    assert found.history[-1].error < 0.8 * found.history[0].error
    assert found.grid.boundaries == start.boundaries
    for before, after, outer in zip(start.blocks, found.grid.blocks, start.outer, strict=True):
        np.testing.assert_array_equal(after.planes[:, outer != 0], before.planes[:, outer != 0])


def test_springs_of_lines_are_those_of_sides():
    """Energy, gradient and Hessian: each spring is on the side of one block, and its nodes may have copies in two."""
    whole = gg.optimize(gg.domain("wavy", 9, 9), "winslow", max_iterations=1).grid
    blocks = cut(whole, (0, 2, 8), (0, 4, 8))
    density = [np.exp(nodes.x + nodes.x * nodes.y) for nodes in (BlockNodes(whole), LayoutNodes(blocks))]
    of_one = SideSpacing(sliding_curves(whole, "all", None)).toward(whole, density[0], 0.7, 3.0)
    of_blocks = LineSpacing(sliding_lines(blocks, "all", None)).toward(blocks, density[1], 0.7, 3.0)
    one = make_problem(whole, "winslow", slide=of_one)
    many = make_layout_problem(blocks, "winslow", slide=of_blocks)
    coordinates = many.exchange.join([grid.planes for grid in blocks.blocks])
    energy, _, gradient = one.energy_gradient(np.ascontiguousarray(whole.planes))
    assert energy - gg.energy(whole, "winslow") > 0.1
    found, _, of_copies = many.energy_gradient(coordinates)
    assert found == pytest.approx(energy, rel=1e-13) == many.energy(coordinates)[0]
    assert many.norm(of_copies) == pytest.approx(one.norm(gradient), rel=1e-12)
    for semidefinite in (False, True):
        planes = one.hessian(np.ascontiguousarray(whole.planes), semidefinite=semidefinite)
        expected = np.linalg.eigvalsh(assemble_hessian(planes, one.held).toarray())
        matrix = LayoutMatrix(many.copies, many.held).assemble(many.hessian(coordinates, semidefinite=semidefinite))
        np.testing.assert_allclose(np.linalg.eigvalsh(matrix.toarray()), expected, rtol=1e-9)


def test_nodes_slide_along_straight_walls_from_block_to_block():
    """The front behind the step meets both walls, of which the upper one passes through two blocks."""
    start = gg.layout("step")
    stays, slides = (
        gg.adapt(start, "tanh(3*(x - 2))", boundary=where, max_iterations=6) for where in ("fixed", "straight")
    )
    assert slides.quality.valid
    assert slides.history[-1].error < 0.3 * stays.history[-1].error
    mask = {name: np.ones(grid.shape) for name, grid in zip(start.names, start.blocks, strict=True)}
    assert sliding_lines(start, "straight", mask) == {}
    assert sliding_lines(start, "fixed", None) == {}
    ring = sliding_lines(gg.layout("annulus", around=32, outwards=4), "all", None)
    assert all(line.curve.closed for line in ring.values())
    assert sliding_lines(gg.layout("annulus", around=32, outwards=4), "straight", None) == {}


def test_an_error_on_the_way_holds_the_last_grid():
    start = cut(square(9), (0, 4, 8), (0, 8))

    def fail(layout):
        if not np.array_equal(layout["0-0"].planes, start["0-0"].planes):
            raise ValueError("mine")
        return solver(layout)

    for fixed in (None, {}):
        with pytest.raises(gg.GridgenError, match="your solver raised ValueError") as caught:
            gg.adapt(start, fail, fixed=fixed)
        assert caught.value.result.grid.names == start.names


PIPE = gg.layout("pipe", across=4, outwards=4)


@pytest.mark.parametrize(
    ("solution", "options", "match"),
    [
        (front, {"moves": 2}, "adapt of several blocks does not take 'moves'"),
        (front, {"boundary": "some"}, "unknown boundary 'some'"),
        (solver(PIPE), {}, "nodal values of several blocks are not interpolated from block to block"),
        (lambda layout: [1, 2], {}, "must be given for every block, by name or in the order core, south, east"),
        (
            lambda layout: [np.ones((3, 3))] * 5,
            {},
            "block core: the solution on the grid of step 0 must have",
        ),
        ("x - 5", {"monitor": "values"}, "density of nodes must be positive: it is .* of block west, x = -1, y = "),
    ],
)
def test_what_cannot_be_adapted_is_refused(solution, options, match):
    with pytest.raises(gg.GridgenError, match=match):
        gg.adapt(PIPE, solution, **options)
