"""The search for a proof that no valid grid exists: that it is never wrong, and that it finds what is there."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from support_boundaries import flat_polygon, grid_of_ring, smooth_curve, star_polygon, valid_grids
from support_polygons import inside

import gridgen_sym as gg
from gridgen_sym.certificates.conflict import WORK, Conflict, _contradiction, _learn, contracted_places
from gridgen_sym.certificates.lattice import convex_hull, doubled_area
from gridgen_sym.certificates.network import Network, OutOfWork
from gridgen_sym.certificates.places import Place, Rule, box_of, overlap
from gridgen_sym.certificates.search import find_conflict


def assert_places_hold(grid):
    """Check that nothing proves a valid grid impossible, and that each of its nodes is inside its place; exactly."""
    ni, nj = grid.shape
    network = Network(grid, [(i, j) for i in range(ni - 1) for j in range(nj - 1)], work=2000)
    places = network.start.copy()
    try:
        assert network.contract(places) is None
        assert network.divide(places) is None
        assert _contradiction(network, places) is None
    except OutOfWork:
        pass
    assert len(network.free) == (ni - 2) * (nj - 2)
    for node in network.free:
        point = tuple(
            (Fraction(float(value)) - zero) * network.lattice.scale
            for value, zero in zip(grid.xy[node], network.lattice.origin, strict=True)
        )
        assert any(inside(part, point, strictly=True) for part in places[node].parts)


@settings(max_examples=20)
@given(valid_grids())
def test_the_nodes_of_a_valid_grid_are_where_they_can_be(grid):
    assert_places_hold(grid)
    places = contracted_places(grid, work=500)
    assert not isinstance(places, Conflict)
    assert all(len(part) >= 3 for parts in places.values() for part in parts)


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("make", [lambda *a: star_polygon(*a, 1e-6), lambda *a: flat_polygon(*a, 1e-2)])
def test_the_nodes_of_an_untangled_grid_are_where_they_can_be(make, seed):
    """There is hardly a choice for the nodes of these."""
    start = grid_of_ring(make(seed, 14), 5, 4)
    result = gg.untangle(start)
    if result.converged:
        assert_places_hold(result.grid)
    else:
        assert result.certificates


#: Boundaries of grids (ni, nj) without a valid grid, and how many cells are left of what conflicts, at most.
IMPOSSIBLE = {
    "a long neck": (grid_of_ring(smooth_curve(3211, 12, 0.6), 5, 3), 8),
    "a wave": (grid_of_ring(smooth_curve(2741, 16, 0.6), 5, 5), 2),
    "a band": (grid_of_ring(flat_polygon(9, 12, 1e-2), 3, 5), 3),
    "a band that only cases decide": (grid_of_ring(flat_polygon(416, 20, 1e-2), 4, 8), 20),
    "a bent band that only parts of places decide": (grid_of_ring(flat_polygon(89, 28, 1e-2), 9, 7), 30),
    "a bay that only sight decides": (grid_of_ring(smooth_curve(906, 20, 0.6), 7, 5), 6),
}


@pytest.mark.parametrize(("start", "most"), IMPOSSIBLE.values(), ids=IMPOSSIBLE)
def test_cells_that_conflict_are_found(start, most):
    assert gg.certificates(start) == ()
    found = find_conflict(start, WORK)
    assert isinstance(found, Conflict)
    assert 0 < len(found.cells) <= most
    # The proof needs no other cells.
    again = contracted_places(start, found.cells, WORK)
    assert isinstance(again, Conflict)
    assert set(again.cells) <= set(found.cells)


@pytest.mark.parametrize("scale", [1e-9, 1e9])
@pytest.mark.parametrize("turned", [0.0, 0.7])
def test_neither_the_unit_of_length_nor_the_place_nor_the_direction_matters(scale, turned):
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


def test_what_is_learned_keeps_its_reasons():
    whole, part = (((0, 0), (4, 0), (0, 4)),), (((0, 0), (2, 0), (0, 2)),)
    places = {(1, 1): Place.of(whole, 1), (1, 2): Place.of(whole, 8)}
    _learn(places, {**places, (1, 1): Place.of(part, 3)}, 4)
    assert places == {(1, 1): Place.of(part, 7), (1, 2): Place.of(whole, 8)}


def test_what_a_rule_says_follows_from_its_cell_and_from_the_places_of_its_nodes():
    place = (((0, 0), (4, 0), (0, 4)),)
    places = {(1, k): Place.of(place, 1 << k) for k in range(4)}
    assert Rule((1, 0), ((1, 1), (1, 2)), (), 1 << 5).reasons(places) == 0b100111


def units(*points):
    return tuple((x << 20, y << 20) for x, y in points)


@pytest.mark.parametrize("order", [1, -1])
def test_a_node_may_see_any_part_of_the_place_of_another(order):
    """From above an obstacle the upper part of what is behind it is seen, and from below the lower."""
    wall = units((0, 0), (8, 0), (8, 8), (0, 8))
    behind = units((9, -6), (14, 4), (9, 14))
    above, below, before = (units((-3, y), (-2, y), (-2, y + 1)) for y in (20, -12, 3))
    rule = Rule((1, 1), ((1, 2),), ((wall, box_of(wall)),), 1)

    def left(*parts):
        return rule.left({(1, 1): Place.of((behind,), 0), (1, 2): Place.of(parts[::order], 0)})[0]

    assert left(before) == ()
    for parts in ((above,), (before, above)):
        (upper,) = left(*parts)
        assert [inside(upper, point) for point in behind] == [False, True, True]
    (whole,) = left(above, below)
    assert all(inside(whole, point) for point in behind)


def test_each_part_of_a_place_is_contracted():
    left, right, middle = (
        units((-4, 0), (-2, 0), (-2, 2)),
        units((2, 0), (4, 0), (4, 2)),
        units((-1, 0), (1, 0), (0, 3)),
    )
    line = (units((0, 0)), units((0, 1)))
    places = {(0, k): Place.of((end,), 0) for k, end in enumerate(line)}
    place = places[1, 1] = Place.of((left, right, middle), 0)
    assert all(inside(place.hull, point) for part in place.parts for point in part)
    assert place.box == box_of(left + right + middle)
    assert place.area == sum(map(doubled_area, place.parts))
    parts, _ = Rule((1, 1), ((0, 0), (0, 1)), (), 1).left(places)
    assert len(parts) == 2
    assert parts[0] == left
    assert [inside(parts[1], point) for point in middle] == [True, False, True]


def test_a_place_is_divided_into_what_is_inside_the_boundary():
    """Of a place without such a part the reasons are those of a conflict."""
    ring = np.array([(0, 0), (1, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2), (0, 1)], dtype=float)
    network = Network(grid_of_ring(ring, 3, 3), [(0, 0)], 100)

    def place(*points):
        return Place.of((convex_hull(network.lattice.points(np.array(points))),), 0b1000)

    notch, across = place((1.2, 1.2), (1.6, 1.2), (1.2, 1.6)), place((0.2, 1.8), (1.8, 0.2), (1.5, 1.5))
    assert network.divide({**network.start, (1, 1): notch}) == 0b1000
    places = {**network.start, (1, 1): across}
    network._rules.clear()
    assert network.divide(places) is None
    assert places[1, 1].cells == 0b1000
    assert len(places[1, 1].parts) > 1
    assert places[1, 1].area < 0.8 * across.area
    for x, y in ((0.3, 1.75), (1.75, 0.3), (0.98, 1.1), (1.1, 0.98)):
        assert any(inside(part, *network.lattice.points(np.array([(x, y)]))) for part in places[1, 1].parts)


def test_boxes_overlap_by_more_than_a_side():
    box = (0, 4, 0, 4)
    assert all(overlap(box, (x, x + 4, y, y + 4)) for x in (-3, 0, 3) for y in (-3, 0, 3))
    assert not any(overlap(box, (x, x + 4, y, y + 4)) for x, y in ((-4, 0), (4, 0), (0, -4), (0, 4), (4, 4)))


def test_bits_stand_for_cells():
    network = Network(gg.domain("square", 3, 3), [(1, 1), (0, 1), (0, 0), (1, 0)], 100)
    assert network.named(0b0101) == ((0, 0), (1, 0))
    assert {rule.cell for rule in network._rules} == {1, 2, 4, 8}


class Answers:
    """A network that answers to each question what it is told, and remembers the questions."""

    hull = ((0, 0), (64, 0), (64, 64), (0, 64))

    def __init__(self, *answers, free=((1, 1),)):
        self.answers, self.free, self.asked = list(answers), free, []

    def contract(self, case, node):
        self.asked.append(case[node].cells)
        return self.answers.pop(0)


def test_the_reasons_of_all_cases_are_those_of_a_conflict():
    places = {(1, 1): Place.of((Answers.hull,), 1)}
    both = Answers(2, 4)
    assert _contradiction(both, places.copy()) == 6
    assert both.asked == [1, 3]  # What excludes one half is a reason for the other.
    # Of the first question one half is left, and then each of two, which have no place.
    network, known = Answers(2, None, None, None, 8, 16, 32, 64), places.copy()
    assert _contradiction(network, known) == 120
    assert network.asked == [1, 3, 3, 3, 3, 11, 3, 35]
    assert known[1, 1].cells == 3
    # The second half may be excluded, too.
    network, known = Answers(None, 2, 4, 8), places.copy()
    assert _contradiction(network, known) == 12
    assert network.asked == [1, 1, 3, 7]
    assert not network.answers


def test_what_cannot_be_told_apart_is_no_proof():
    places = {(1, 1): Place.of((Answers.hull,), 1)}
    assert _contradiction(Answers(free=()), places) is None
    thin = {(1, 1): Place.of((((0, 0), (64, 64)),), 1)}
    assert _contradiction(Answers(*[None] * 4), thin) is None


def test_out_of_work_is_no_proof():
    start, _ = IMPOSSIBLE["a band"]
    assert find_conflict(start, work=5) is None
    assert gg.certificates(start, search=True, work=5) == ()
    assert gg.certificates(start, search=True, work=5000)


@pytest.mark.parametrize("work", [0, -3, 2.5, True, "long"])
def test_work_must_be_a_number_of_steps(work):
    with pytest.raises(gg.GridgenError, match=f"work must be a whole number of steps, at least 1; came {work!r}"):
        gg.certificates(gg.domain("square", 5, 5), search=True, work=work)


def test_what_the_check_raises_ends_the_search():
    start, _ = IMPOSSIBLE["a band that only cases decide"]
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


@pytest.mark.parametrize("thickness", [1e-6, 1e-9, 1e-12])
def test_a_thin_inclined_band_is_searched(thickness):
    """Rounding makes the moments of its hull singular; where places are cut is free, and so is nothing else."""
    s, t = np.meshgrid(np.linspace(0, 1, 20), thickness * np.linspace(-0.5, 0.5, 10), indexing="ij")
    planes = np.stack((np.cos(0.5) * s - np.sin(0.5) * t, np.sin(0.5) * s + np.cos(0.5) * t))
    planes[:, [10, 11], 5] = planes[:, [11, 10], 5]
    assert all(proof.kind != "conflict" for proof in gg.certificates(gg.Grid.from_planes(*planes), search=True))


def test_coordinates_of_very_different_sizes_are_searched():
    s = np.linspace(0, 1, 12)
    planes = np.stack(np.meshgrid(s, s, indexing="ij"))
    planes[:, 4:8, 4:8] = planes[:, 4:8, 4:8][:, ::-1].copy()
    planes[1, 3, 0], planes[0, 0, 4] = 1e-200, -1e-200
    assert gg.certificates(gg.Grid.from_planes(*planes), search=True) == ()
