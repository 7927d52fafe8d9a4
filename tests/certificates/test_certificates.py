"""Certificates: each kind, where it is, that none is false, and that it is exact."""

from __future__ import annotations

from fractions import Fraction
from functools import partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support import NO_SHARED, SHARED
from support_boundaries import boundary_grids, closed_curves, grid_of_ring, valid_grids

import gridgen_sym as gg
from gridgen_sym.boundary.polygon import proper_crossings, winding_number
from gridgen_sym.boundary.predicates import area_sign, orientation
from gridgen_sym.certificates.certificate import Numbers
from gridgen_sym.certificates.node_constraints import _contradict, infeasible_nodes
from gridgen_sym.certificates.proofs import _cells_text
from gridgen_sym.grids import corner_jacobians
from gridgen_sym.grids.grid import boundary_indices

DOMAINS = SHARED / "domains"


def kinds(grid):
    return [found.kind for found in gg.certificates(grid)]


def square_sides(n=5):
    s = np.linspace(0, 1, n)
    zero = np.zeros(n)
    return [np.stack(side, axis=-1) for side in ((s, zero), (s, zero + 1), (zero, s), (zero + 1, s))]


def test_the_ring_runs_round_the_boundary():
    assert boundary_indices(3, 4).tolist() == [
        [0, 0], [1, 0], [2, 0], [2, 1], [2, 2], [2, 3], [1, 3], [0, 3], [0, 2], [0, 1],
    ]  # fmt: skip


@pytest.mark.parametrize("name", gg.domain_names())
@pytest.mark.parametrize("nodes", [5, 6, 41])
def test_the_classical_domains_have_none(name, nodes):
    assert gg.certificates(gg.domain(name, nodes, nodes)) == ()


@settings(max_examples=30)
@given(valid_grids())
def test_a_valid_grid_has_none(grid):
    assert gg.quality(grid).valid
    assert gg.certificates(grid) == ()


@pytest.mark.parametrize("spacing", [[0, 1e-200, 1, 1e200], [-1.7e308, 0, 5e-324, 1e-300, 1.7e308]], ids=["far", "all"])
def test_a_valid_grid_of_very_different_sizes_has_none(spacing):
    """Products of its lengths overflow, and vanish."""
    xy = np.stack(np.meshgrid(spacing, spacing, indexing="ij"), axis=-1)
    assert gg.certificates(gg.Grid(xy)) == ()
    xy[1:-1, 1:-1] = xy[1, 0]
    assert gg.certificates(gg.Grid(xy), search=True, budget=200) == ()


@settings(max_examples=50)
@given(boundary_grids())
def test_any_boundary_is_answered_with_finite_numbers(grid):
    for found in gg.certificates(grid):
        assert np.isfinite([*found.point, *found.numbers.values()]).all()
        assert found.message.startswith("no valid grid exists")
        assert str(found) == found.message
        assert all(0 <= i < grid.shape[0] and 0 <= j < grid.shape[1] for i, j in found.nodes)


@pytest.mark.parametrize("scale", [1e-300, 1e-9, 1.0, 1e9, 1e300])
def test_a_wrong_corner_is_named_with_its_angle(scale):
    sides = square_sides()
    sides[3][-2] = 1.25, 1.25
    (found,) = gg.certificates(gg.transfinite(*(scale * side for side in sides)))
    assert found.kind == "corner"
    assert found.numbers == {"corner": 2, "angle": pytest.approx(225)}
    assert found.nodes == ((4, 3), (4, 4), (3, 4))
    assert found.point == (scale, scale)
    assert "corner 2, node (4, 4)" in found.message
    assert "225 degrees" in found.message


@given(st.floats(-1e-12, 1e-12), st.floats(0.1, 0.9), st.floats(-10, 10))
def test_a_nearly_straight_corner_is_decided_exactly(offset, part, shift):
    bottom, top, left, right = (side + shift for side in square_sides())
    # The corner (0, 0) stands between its neighbors, off their line by less than rounding.
    bottom[1], left[1] = bottom[0] + [0.2, 0.2], bottom[0] - [0.2 * part, 0.2 * part + offset]
    straight = orientation(left[1], bottom[0], bottom[1])[0] > 0
    found = [c for c in gg.certificates(gg.transfinite(bottom, top, left, right)) if c.kind == "corner"]
    assert bool(found) is not bool(straight)


@pytest.mark.parametrize("prove", [partial(gg.certificates, search=True), gg.sliver_certificate])
def test_the_old_name_of_a_budget_works_with_a_warning(prove):
    grid = gg.domain("square", 5, 5)
    with pytest.warns(DeprecationWarning, match=r"work=.*budget"):
        assert not prove(grid, work=7)
    with (
        pytest.warns(DeprecationWarning, match="budget"),
        pytest.raises(gg.GridgenError, match=r"^budget must .* came 0$"),
    ):
        prove(grid, work=0)


def test_the_old_name_of_a_fraction_works_with_a_warning():
    numbers = Numbers(cells=2, jacobian_fraction=0.1)
    with pytest.warns(DeprecationWarning, match="'share' is called 'jacobian_fraction' now"):
        assert numbers["share"] == 0.1
    for name, absent in (("share", Numbers(cells=2)), ("angle", numbers)):
        with pytest.raises(KeyError, match=name):
            absent[name]


@pytest.mark.parametrize("measure", [gg.certificates, gg.quality])
@pytest.mark.parametrize("grid", [gg.domain("square", 5, 5).xy, None, "swan"], ids=["array", "none", "text"])
def test_what_is_no_grid_is_refused(measure, grid):
    with pytest.raises(gg.GridgenError, match=r"expected a Grid, came .*gridgen_sym.Grid\(xy\)"):
        measure(grid)


def test_coincident_neighbors():
    bottom, top, left, right = square_sides()
    bottom[2] = bottom[1]
    (found,) = gg.certificates(gg.transfinite(bottom, top, left, right))
    assert (found.kind, found.nodes) == ("coincident", ((1, 0), (2, 0)))


@pytest.mark.parametrize("shift", [0.0, 1e6])
def test_a_clockwise_boundary_and_its_repair(shift):
    grid = gg.Grid(gg.domain("swan", 9, 7).xy[::-1] + shift)
    assert kinds(grid) == ["clockwise"]
    assert gg.certificates(gg.Grid(grid.xy[::-1])) == ()


def test_a_boundary_without_area():
    i, j = np.meshgrid(np.arange(4.0), np.arange(4.0), indexing="ij")
    assert kinds(gg.Grid(np.stack((i + 0.1 * j, 0 * i), axis=-1))) == ["clockwise"]


def assert_edges_cross(grid, nodes):
    """Check that four nodes are the ends of two edges of the boundary, and that these cross."""
    assert proper_crossings(np.array([grid.xy[node] for node in nodes])) == [(0, 2)]
    for (i, j), (k, m) in (nodes[:2], nodes[2:]):
        assert abs(i - k) + abs(j - m) == 1


def test_banks_that_cross_are_certified_by_a_point_that_is_wound_backwards():
    bottom, top, left, right = square_sides(9)
    bottom[4, 1] = 1.1  # The bottom reaches over the top.
    grid = gg.transfinite(bottom, top, left, right)
    (found,) = gg.certificates(grid)
    assert found.kind == "crossing"
    assert found.numbers["winding"] == -1
    assert found.numbers["crossings"] == 2
    assert found.point[1] == pytest.approx(1.0)
    assert_edges_cross(grid, found.nodes)
    # Counted anew, by angles.
    index = boundary_indices(*grid.shape)
    away = grid.xy[index[:, 0], index[:, 1]] - [found.numbers["x"], found.numbers["y"]]
    turn = np.angle(np.roll(away @ [1, 1j], -1) / (away @ [1, 1j])).sum()
    assert turn / (2 * np.pi) == pytest.approx(-1)


def test_a_loop_is_certified_by_its_turn():
    s = 2 * np.pi * np.arange(40) / 40
    limacon = (1 + 2 * np.cos(s))[:, None] * np.stack((np.cos(s), np.sin(s)), axis=-1)  # Winds twice in its loop.
    limacon_grid = grid_of_ring(limacon + np.array([1e-3, 0]), 11, 11)
    (found,) = [c for c in gg.certificates(limacon_grid) if c.kind == "crossing"]
    assert found.numbers["turn"] == 720
    assert_edges_cross(limacon_grid, found.nodes)


def test_a_spiral_that_overlaps_itself_has_a_valid_grid_and_no_certificate():
    s, t = np.meshgrid(np.linspace(0, 1, 61), np.linspace(0, 1, 5), indexing="ij")
    angle = -2.5 * np.pi * s
    spiral = gg.Grid(np.stack(((1 + t) * np.cos(angle), (1 + t) * np.sin(angle)), axis=-1))
    assert gg.quality(spiral).valid
    index = boundary_indices(*spiral.shape)
    assert proper_crossings(spiral.xy[index[:, 0], index[:, 1]])
    assert gg.certificates(spiral) == ()


def test_a_spike_is_no_turn_of_a_boundary_that_overlaps_itself():
    """Where it runs back its turn is not known, so that no sum of turns proves anything."""
    s, t = np.meshgrid(np.linspace(0, 1, 61), np.linspace(0, 1, 5), indexing="ij")
    xy = np.stack(((1 + t) * np.cos(-2.5 * np.pi * s), (1 + t) * np.sin(-2.5 * np.pi * s)), axis=-1)
    xy[31, 0] = xy[30, 0] - (xy[30, 0] - xy[29, 0]) / 2
    assert kinds(gg.Grid(xy)) == ["spike"]


def test_a_spike():
    bottom, top, left, right = square_sides(7)
    bottom[3] = 0.5, 0.75
    bottom[2] = bottom[4] = 0.5, 0.25
    (found,) = gg.certificates(gg.transfinite(bottom, top, left, right))
    assert (found.kind, found.nodes, found.numbers) == ("spike", ((2, 0), (3, 0), (4, 0)), {"angle": 0})
    bottom[4, 0] += 1e-9
    assert kinds(gg.transfinite(bottom, top, left, right)) == []


def test_a_spike_at_a_corner_is_told_once():
    xy = gg.domain("square", 5, 5).xy
    xy[1, 0] = 0, 0.1
    (found,) = gg.certificates(gg.Grid(xy))
    assert (found.kind, found.nodes[1], found.numbers["angle"]) == ("corner", (0, 0), 0)


def neck(lean):
    """A channel of one inner row whose sides push teeth at its middle, which lean away from each other."""
    x = np.arange(7.0)
    zero = np.zeros(7)
    bottom, top = np.stack((x, zero), axis=-1), np.stack((x, zero + 2), axis=-1)
    bottom[3], top[3] = (3 - lean, 0.5), (3 + lean, 1.5)
    ends = np.array([[0, 0], [0, 1], [0, 2.0]])
    return gg.transfinite(bottom, top, ends, ends + np.array([6, 0]))


def test_a_neck_without_a_position_for_its_node():
    assert kinds(neck(0.0)) == []
    assert gg.optimize(neck(0.0), "winslow").quality.valid
    (found, *_) = gg.certificates(neck(0.8))
    assert found.kind == "neck"
    node, *ends = found.nodes
    # No point of a fine lattice lies to the left of all lines.
    xy = neck(0.8).xy
    x, y = np.meshgrid(np.linspace(-2, 8, 201), np.linspace(-2, 4, 201))
    free = np.ones_like(x, dtype=bool)
    for s, t in zip(ends[::2], ends[1::2], strict=True):
        (sx, sy), (tx, ty) = xy[s], xy[t]
        free &= (tx - sx) * (y - sy) - (ty - sy) * (x - sx) > 0
    assert not free.any()
    assert node[1] == 1


@settings(max_examples=25)
@given(st.integers(0, 10**6), st.floats(0.1, 0.6))
def test_of_3_x_3_nodes_there_is_a_certificate_or_a_valid_grid(seed, noise):
    """Every Jacobian is affine in the one inner node: a linear program says whether a position makes all positive."""
    from scipy.optimize import linprog

    xy = gg.domain("square", 3, 3).xy
    xy += noise * np.random.default_rng(seed).normal(size=xy.shape)

    def jacobians(x, y):
        xy[1, 1] = x, y
        return corner_jacobians(xy[..., 0], xy[..., 1]).ravel()

    at_0 = jacobians(0, 0)
    slopes = np.stack([jacobians(1, 0) - at_0, jacobians(0, 1) - at_0], axis=-1)
    # The largest margin by which all corners are positive, in a box that is large beside the boundary.
    answer = linprog([0, 0, -1], A_ub=np.c_[-slopes, np.ones(16)], b_ub=at_0, bounds=[(-1e3, 1e3)] * 2 + [(None, 1)])
    if abs(answer.fun) > 1e-9:
        assert bool(gg.certificates(gg.Grid(xy))) == (answer.fun > 0)
        if answer.fun < 0:
            assert (jacobians(*answer.x[:2]) > 0).all()


@pytest.mark.parametrize("shape", [(3, 3), (3, 7), (7, 3), (5, 6)])
def test_many_parallel_half_planes_are_no_contradiction(shape):
    """All boundary edges of a rectangle are parallel in pairs; its inner nodes are folded, so that a proof is tried."""
    i, j = np.meshgrid(*map(np.arange, shape), indexing="ij")
    xy = np.stack((i, 2 * j), axis=-1).astype(float)
    xy[1:-1, 1:-1] = xy[0, 0]
    assert gg.certificates(gg.Grid(xy)) == ()


@pytest.mark.parametrize(
    ("planes", "expected"),
    [
        ([(1, 0, 0), (2, 0, 1), (3, 0, 5)], False),  # x > 0, x > 1/2, x > 5/3.
        ([(1, 0, 0), (-1, 0, -1)], False),  # 0 < x < 1.
        ([(1, 0, 0), (-1, 0, 0)], True),  # 0 < x < 0.
        ([(1, 0, 1), (-2, 0, -1)], True),  # 1 < x < 1/2.
        ([(1, 0, 0), (0, 1, 0)], False),
        ([(1, 0, 0), (0, 1, 0), (-1, -1, -1)], False),  # A triangle.
        ([(1, 0, 0), (0, 1, 0), (-1, -1, 0)], True),  # A point.
        ([(-1, -1, 1), (0, 1, 0), (1, 0, 0)], True),
        ([(0, 0, 0)], True),
        ([(1, 0, 0)], False),
    ],
)
def test_half_planes_contradict_if_they_have_no_common_point(planes, expected):
    exact = [tuple(map(Fraction, plane)) for plane in planes]
    assert _contradict(exact) is expected
    assert _contradict(exact[::-1]) is expected


@settings(max_examples=25)
@given(st.integers(0, 10**6))
def test_necks_agree_with_linear_programming(seed):
    from scipy.optimize import linprog

    from gridgen_sym.certificates.node_constraints import _constraints

    random = np.random.default_rng(seed)
    grid = gg.Grid(random.random((3, 4, 2)))
    found = {node for node, _ in infeasible_nodes(grid)}
    for node in ((1, 1), (1, 2)):
        rows, sides = [], []
        for s, t in _constraints(node, 3, 4):
            (sx, sy), (tx, ty) = grid.xy[s], grid.xy[t]
            normal = np.array([sy - ty, tx - sx])
            rows.append([*-normal, 1.0])
            sides.append(-normal @ [sx, sy])
        # The largest margin; bounded so that it is attained.
        answer = linprog([0, 0, -1], A_ub=rows, b_ub=sides, bounds=[(-1e3, 1e3), (-1e3, 1e3), (None, 1)])
        assert (node in found) == (-answer.fun < 1e-12)


def test_orientation_is_exact_where_rounding_is_not():
    p, q = np.array([0.1, 0.1]), np.array([0.3, 0.3])
    above = np.nextafter(0.2, 1)
    assert orientation(p, q, np.array([0.2, above]))[0] == 1
    assert orientation(p, q, np.array([0.2, 0.2]))[0] == 0
    assert orientation(p, q, np.array([above, 0.2]))[0] == -1
    # L. Kettner et al., Classroom examples of robustness problems (2008): rounded signs are wrong near this line.
    near = 0.5 + 2.0**-53 * np.stack(np.meshgrid(np.arange(64), np.arange(64), indexing="ij"), axis=-1).reshape(-1, 2)
    line = np.array([12.0, 12.0]), np.array([24.0, 24.0])
    u, v = line[0] - near, line[1] - near
    assert (np.sign(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) != np.sign(near[:, 1] - near[:, 0])).any()
    assert np.array_equal(orientation(near, *line), np.sign(near[:, 1] - near[:, 0]))
    many = orientation(1e6 + p, 1e6 + q, 1e6 + np.array([[0.2, 0.25], [0.25, 0.2]]))
    assert many.tolist() == [1, -1]


@given(closed_curves())
def test_areas_and_windings_agree_when_run_backwards(points):
    assert area_sign(points) == -area_sign(points[::-1])
    at = points.mean(axis=0)
    winding = winding_number(points, at)
    assert winding is None or winding == -(winding_number(points[::-1], at) or 0)


@settings(max_examples=40)
@given(closed_curves(st.integers(5, 24)))
def test_the_sweep_finds_what_all_pairs_hold(points):
    count = len(points)
    end = np.roll(points, -1, axis=0)
    crossings = []
    for a in range(count):
        for b in range(a + 2, count - (a == 0)):
            one = orientation(points[a], end[a], points[[b, (b + 1) % count]])
            other = orientation(points[b], end[b], points[[a, (a + 1) % count]])
            if one.prod() < 0 and other.prod() < 0:
                crossings.append((a, b))
    assert proper_crossings(points) == crossings


@pytest.mark.skipif(not DOMAINS.is_dir(), reason=NO_SHARED.format("domains"))
def test_outlines_at_equal_arc_length():
    expected = {"australia": [2], "lake_victoria": [1, 2]}
    for path in sorted((DOMAINS / "outlines").glob("*.csv")):
        if path.stem != "index":
            outline = gg.Outline.read(path)
            found = gg.certificates(outline.grid(65, 65, corners=outline.corners, sampling="equal"))
            assert [c.numbers["corner"] for c in found] == expected.get(path.stem, []), path.stem


@pytest.mark.skipif(not DOMAINS.is_dir(), reason=NO_SHARED.format("domains"))
def test_the_regions_have_none():
    paths = sorted((DOMAINS / "regions").glob("*.npz"))
    assert len(paths) == 27
    for path in paths:
        assert gg.certificates(gg.Grid(np.load(path)["xy"])) == (), path.stem


@pytest.mark.parametrize(
    ("count", "text"),
    [
        (1, "the cell (0, 1)"),
        (2, "the 2 cells (0, 1), (1, 2)"),
        (6, "the 6 cells (0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 6)"),
        (7, "the 7 cells (0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 6) and 1 more"),
    ],
)
def test_a_message_counts_cells_and_names_the_first(count, text):
    assert _cells_text(tuple((k, k + 1) for k in range(count))) == text
