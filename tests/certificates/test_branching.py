"""The search for a proof that no valid grid exists: that it is never wrong, and that it finds what is there."""

from __future__ import annotations

import contextlib
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from support_boundaries import flat_polygon, grid_of_ring, smooth_curve, star_polygon, valid_grids
from support_polygons import inside

import gridgen_sym as gg
from gridgen_sym.certificates.branching import (
    LARGE_BUDGET,
    Conflict,
    _adopt,
    _search_tree,
    feasible_regions,
    search_conflict,
)
from gridgen_sym.certificates.constraint_network import BudgetExceeded, ConstraintNetwork
from gridgen_sym.certificates.feasible_region import Constraint, FeasibleRegion, bounding_box, overlap
from gridgen_sym.certificates.integer_polygons import convex_hull, doubled_area
from gridgen_sym.certificates.search import find_conflict


def assert_regions_hold(grid):
    """Check that nothing proves a valid grid impossible, and that each node is inside its feasible region; exactly."""
    ni, nj = grid.shape
    network = ConstraintNetwork(grid, [(i, j) for i in range(ni - 1) for j in range(nj - 1)], budget=2000)
    regions = network.start.copy()
    with contextlib.suppress(BudgetExceeded):
        assert search_conflict(network, regions, True) is None
    assert len(network.free) == (ni - 2) * (nj - 2)
    for node in network.free:
        point = tuple(
            (Fraction(float(value)) - zero) * network.coordinates.scale
            for value, zero in zip(grid.xy[node], network.coordinates.origin, strict=True)
        )
        assert any(inside(part, point, strictly=True) for part in regions[node].parts)


@settings(max_examples=3)
@given(valid_grids())
def test_the_nodes_of_a_valid_grid_are_in_their_feasible_regions(grid):
    assert_regions_hold(grid)
    regions = feasible_regions(grid, budget=500)
    assert not isinstance(regions, Conflict)
    assert all(len(part) >= 3 for parts in regions.values() for part in parts)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("make", [lambda *a: star_polygon(*a, 1e-6), lambda *a: flat_polygon(*a, 1e-2)])
def test_the_nodes_of_an_untangled_grid_are_in_their_feasible_regions(make, seed):
    """The feasible regions of these are tiny."""
    start = grid_of_ring(make(seed, 14), 5, 4)
    result = gg.untangle(start)
    if result.converged:
        assert_regions_hold(result.grid)
    else:
        assert result.certificates


#: Those whose proofs take longest.
SLOW = {"a band that only branching decides"}
#: Boundaries of grids (ni, nj) without a valid grid, and how many cells are left of what conflicts, at most.
IMPOSSIBLE = {
    "a long neck": (grid_of_ring(smooth_curve(3211, 12, 0.6), 5, 3), 8),
    "a wave": (grid_of_ring(smooth_curve(2741, 16, 0.6), 5, 5), 2),
    "a band": (grid_of_ring(flat_polygon(9, 12, 1e-2), 3, 5), 3),
    "a band that only branching decides": (grid_of_ring(flat_polygon(416, 20, 1e-2), 4, 8), 20),
    "a bent band that only parts of regions decide": (grid_of_ring(flat_polygon(89, 28, 1e-2), 9, 7), 30),
    "a bay that only visibility decides": (grid_of_ring(smooth_curve(906, 20, 0.6), 7, 5), 6),
}


@pytest.mark.parametrize(
    ("start", "most"),
    [pytest.param(*case, marks=[pytest.mark.slow] * (name in SLOW), id=name) for name, case in IMPOSSIBLE.items()],
)
def test_cells_that_conflict_are_found(start, most):
    assert gg.certificates(start) == ()
    found = find_conflict(start, LARGE_BUDGET)
    assert isinstance(found, Conflict)
    assert 0 < len(found.cells) <= most
    # The proof needs no other cells.
    again = feasible_regions(start, found.cells, LARGE_BUDGET)
    assert isinstance(again, Conflict)
    assert set(again.cells) <= set(found.cells)


@pytest.mark.parametrize("scale", [1e-9, 1e9])
@pytest.mark.parametrize("turned", [0.0, 0.7])
def test_neither_the_unit_of_length_nor_the_position_nor_the_direction_matters(scale, turned):
    turning = np.array([[np.cos(turned), np.sin(turned)], [-np.sin(turned), np.cos(turned)]])
    start = grid_of_ring(scale * (smooth_curve(3211, 12, 0.6) @ turning + 1e3), 5, 3)
    assert find_conflict(start) is not None


def test_a_certificate_of_the_search_names_cells():
    start, most = IMPOSSIBLE["a wave"]
    (proof,) = gg.certificates(start, search=True)
    assert proof.kind == "conflict"
    assert len(proof.nodes) == 4 * proof.numbers["cells"] <= 4 * most
    for i, j in proof.nodes[::4]:
        assert f"({i}, {j})" in proof.message
        # If others were folded, there would be room.
        assert "while every other cell is" in proof.message
        assert proof.nodes[proof.nodes.index((i, j)) :][:4] == ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))
    assert gg.untangle(start).certificates[0].kind == "conflict"


def test_what_is_adopted_keeps_its_reasons():
    whole, part = (((0, 0), (4, 0), (0, 4)),), (((0, 0), (2, 0), (0, 2)),)
    regions = {(1, 1): FeasibleRegion.of(whole, 1), (1, 2): FeasibleRegion.of(whole, 8)}
    _adopt(regions, {**regions, (1, 1): FeasibleRegion.of(part, 3)}, 4)
    assert regions == {(1, 1): FeasibleRegion.of(part, 7), (1, 2): FeasibleRegion.of(whole, 8)}


def test_a_constraint_follows_from_its_cell_and_from_the_regions_of_its_nodes():
    region = (((0, 0), (4, 0), (0, 4)),)
    regions = {(1, k): FeasibleRegion.of(region, 1 << k) for k in range(4)}
    assert Constraint((1, 0), ((1, 1), (1, 2)), (), 1 << 5).reasons(regions) == 0b100111


def nothing():
    pass


def units(*points):
    return tuple((x << 20, y << 20) for x, y in points)


@pytest.mark.parametrize("order", [1, -1])
def test_a_node_may_see_any_part_of_the_region_of_another(order):
    """From above an obstacle the upper part of what is behind it is seen, and from below the lower."""
    wall = units((0, 0), (8, 0), (8, 8), (0, 8))
    behind = units((9, -6), (14, 4), (9, 14))
    above, below, before = (units((-3, y), (-2, y), (-2, y + 1)) for y in (20, -12, 3))
    rule = Constraint((1, 1), ((1, 2),), ((wall, bounding_box(wall)),), 1)

    def left(*parts):
        return rule.clip(
            {(1, 1): FeasibleRegion.of((behind,), 0), (1, 2): FeasibleRegion.of(parts[::order], 0)}, nothing
        )[0]

    assert left(before) == ()
    for parts in ((above,), (before, above)):
        (upper,) = left(*parts)
        assert [inside(upper, point) for point in behind] == [False, True, True]
    (whole,) = left(above, below)
    assert all(inside(whole, point) for point in behind)


def test_each_part_of_a_region_is_clipped():
    left, right, middle = (
        units((-4, 0), (-2, 0), (-2, 2)),
        units((2, 0), (4, 0), (4, 2)),
        units((-1, 0), (1, 0), (0, 3)),
    )
    line = (units((0, 0)), units((0, 1)))
    regions = {(0, k): FeasibleRegion.of((end,), 0) for k, end in enumerate(line)}
    region = regions[1, 1] = FeasibleRegion.of((left, right, middle), 0)
    assert all(inside(region.hull, point) for part in region.parts for point in part)
    assert region.box == bounding_box(left + right + middle)
    assert region.area == sum(map(doubled_area, region.parts))
    two = FeasibleRegion.of((left, right), 0)
    assert all(inside(two.hull, point) for part in two.parts for point in part)
    parts, _ = Constraint((1, 1), ((0, 0), (0, 1)), (), 1).clip(regions, nothing)
    assert len(parts) == 2
    assert parts[0] == left
    assert [inside(parts[1], point) for point in middle] == [True, False, True]


def test_a_region_is_clipped_to_the_inside_of_the_boundary():
    """The reasons of a region outside are those of a conflict."""
    ring = np.array([(0, 0), (1, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2), (0, 1)], dtype=float)
    network = ConstraintNetwork(grid_of_ring(ring, 3, 3), [(0, 0)], 100)

    def region_of(*points):
        return FeasibleRegion.of((convex_hull(network.coordinates.to_integers(np.array(points))),), 0b1000)

    notch, across = region_of((1.2, 1.2), (1.6, 1.2), (1.2, 1.6)), region_of((0.2, 1.8), (1.8, 0.2), (1.5, 1.5))
    assert network.clip_to_inside({**network.start, (1, 1): notch}) == 0b1000
    regions = {**network.start, (1, 1): across}
    network._constraints.clear()
    assert network.clip_to_inside(regions) is None
    assert regions[1, 1].reasons == 0b1000
    assert len(regions[1, 1].parts) > 1
    assert regions[1, 1].area < 0.8 * across.area
    for x, y in ((0.3, 1.75), (1.75, 0.3), (0.98, 1.1), (1.1, 0.98)):
        assert any(inside(part, *network.coordinates.to_integers(np.array([(x, y)]))) for part in regions[1, 1].parts)


def test_boxes_overlap_by_more_than_a_side():
    box = (0, 4, 0, 4)
    assert all(overlap(box, (x, x + 4, y, y + 4)) for x in (-3, 0, 3) for y in (-3, 0, 3))
    assert not any(overlap(box, (x, x + 4, y, y + 4)) for x, y in ((-4, 0), (4, 0), (0, -4), (0, 4), (4, 4)))


def test_bits_stand_for_cells():
    network = ConstraintNetwork(gg.domain("square", 3, 3), [(1, 1), (0, 1), (0, 0), (1, 0)], 100)
    assert network.cells_of(0b0101) == ((0, 0), (1, 0))
    assert {rule.cell for rule in network._constraints} == {1, 2, 4, 8}


class Answers:
    """A network that answers to each question what it is told, and remembers the questions."""

    hull = ((0, 0), (64, 0), (64, 64), (0, 64))

    def __init__(self, *answers, free=((1, 1),)):
        self.answers, self.free, self.asked = list(answers), free, []

    def propagate(self, case, node):
        self.asked.append(case[node].reasons)
        return self.answers.pop(0)


def test_the_reasons_of_all_branches_are_those_of_a_conflict():
    regions = {(1, 1): FeasibleRegion.of((Answers.hull,), 1)}
    both = Answers(2, 4)
    assert _search_tree(both, regions.copy()) == 6
    assert both.asked == [1, 3]  # What excludes one half is a reason for the other.
    # Of the first question one half is left, and then both halves of two, which are infeasible.
    network, known = Answers(2, None, None, None, 8, 16, 32, 64), regions.copy()
    assert _search_tree(network, known) == 120
    assert network.asked == [1, 3, 3, 3, 3, 11, 3, 35]
    assert known[1, 1].reasons == 3
    # The second half may be excluded, too.
    network, known = Answers(None, 2, 4, 8), regions.copy()
    assert _search_tree(network, known) == 12
    assert network.asked == [1, 1, 3, 7]
    assert not network.answers


def test_what_cannot_be_bisected_is_no_proof():
    regions = {(1, 1): FeasibleRegion.of((Answers.hull,), 1)}
    assert _search_tree(Answers(free=()), regions) is None
    thin = {(1, 1): FeasibleRegion.of((((0, 0), (64, 64)),), 1)}
    assert _search_tree(Answers(*[None] * 4), thin) is None


def test_an_exceeded_budget_is_no_proof():
    start, _ = IMPOSSIBLE["a band"]
    assert find_conflict(start, budget=5) is None
    assert gg.certificates(start, search=True, budget=5) == ()
    assert gg.certificates(start, search=True, budget=5000)


@pytest.mark.parametrize("budget", [0, -3, 2.5, True, "long"])
def test_a_budget_must_be_a_positive_integer(budget):
    with pytest.raises(gg.GridgenError, match=f"budget must be an integer, at least 1, .* came {budget!r}"):
        gg.certificates(gg.domain("square", 5, 5), search=True, budget=budget)


def test_what_the_check_raises_ends_the_search():
    start, _ = IMPOSSIBLE["a band that only branching decides"]
    calls = []

    def check():
        calls.append(None)
        if len(calls) == 40:
            raise TimeoutError

    with pytest.raises(TimeoutError):
        gg.certificates(start, search=True, check=check)
    assert len(calls) == 40


def test_a_valid_grid_is_not_searched():
    grid = gg.optimize(gg.domain("swan", 21, 21), "winslow").grid
    assert find_conflict(grid) is None
    assert gg.certificates(grid, search=True) == ()


@pytest.mark.parametrize("thickness", [1e-6, 1e-12])
def test_a_thin_inclined_band_is_searched(thickness):
    """Rounding makes the moments of its hull singular, on which the direction of a bisection depends, but no proof."""
    s, t = np.meshgrid(np.linspace(0, 1, 20), thickness * np.linspace(-0.5, 0.5, 10), indexing="ij")
    planes = np.stack((np.cos(0.5) * s - np.sin(0.5) * t, np.sin(0.5) * s + np.cos(0.5) * t))
    planes[:, [10, 11], 5] = planes[:, [11, 10], 5]
    found = gg.certificates(gg.Grid.from_planes(*planes), search=True, budget=3000)
    assert all(proof.kind != "conflict" for proof in found)


def test_coordinates_of_very_different_sizes_are_searched():
    s = np.linspace(0, 1, 12)
    planes = np.stack(np.meshgrid(s, s, indexing="ij"))
    planes[:, 4:8, 4:8] = planes[:, 4:8, 4:8][:, ::-1].copy()
    planes[1, 3, 0], planes[0, 0, 4] = 1e-200, -1e-200
    assert gg.certificates(gg.Grid.from_planes(*planes), search=True, budget=3000) == ()
