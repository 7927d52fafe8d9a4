"""Layouts by name: valid, with the connections, boundaries, singular nodes and symmetries that they must have."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from layouts import valences

import gridgen_sym as gg
from gridgen_sym.solvers.layout.binding import make_layout_problem
from gridgen_sym.topology.shapes import layout_description

SMALL = {
    "airfoil_c": {"around": 16, "outwards": 6, "wake": 6, "first": 0.05, "far": 2.0},
    "airfoil_o": {"around": 16, "outwards": 6, "first": 0.05, "far": 2.0},
    "annulus": {"around": 24, "outwards": 6},
    "cascade": {"along": 8, "before": 4, "behind": 4, "across": 6},
    "channel_with_hole": {"around": 4, "outwards": 4},
    "pipe": {"across": 6, "outwards": 5},
    "sector": {"around": 6, "outwards": 6},
    "square_with_hole": {"around": 4, "outwards": 4},
    "step": {"across": 4},
    "tee": {"across": 6},
    "wye": {"across": 6},
}
#: The number of connections, and the valences other than 4 of inner nodes.
KNOWN = {
    "airfoil_c": (1, []),
    "airfoil_o": (1, []),
    "annulus": (1, []),
    "cascade": (2, []),
    "channel_with_hole": (16, [5] * 4),
    "pipe": (8, [3] * 4),
    "sector": (1, []),
    "square_with_hole": (16, [5] * 4),
    "step": (2, []),
    "tee": (3, []),
    "wye": (9, [3]),
}
BOUNDARIES = {
    "airfoil_c": {"wall", "farfield", "outlet"},
    "airfoil_o": {"wall", "farfield"},
    "annulus": {"inner", "outer"},
    "cascade": {"inlet", "outlet", "wall"},
    "channel_with_hole": {"inlet", "outlet", "wall", "hole"},
    "pipe": {"wall"},
    "sector": {"inner", "outer"},
    "square_with_hole": {"wall", "hole"},
    "step": {"inlet", "outlet", "wall"},
    "tee": {"inlet", "outlet", "branch", "wall"},
    "wye": {"inlet", "upper outlet", "lower outlet", "wall"},
}


@functools.cache
def solved(name):
    result = gg.optimize(gg.layout(name, **SMALL[name]), "winslow", tolerance=1e-11)
    assert result.converged
    assert result.quality.valid
    return result


def nodes(layout):
    return np.concatenate([block.planes.reshape(2, -1) for block in layout.blocks], axis=1).T


def same_set(first, second):
    """How far nodes lie from the nearest ones of another set."""
    from scipy.spatial import cKDTree

    return cKDTree(second).query(first)[0].max()


def test_all_shapes_are_known_here():
    assert gg.layout_names() == sorted(SMALL)
    assert all(layout_description(name) for name in SMALL)


@pytest.mark.parametrize("name", SMALL)
def test_a_shape_is_valid_and_connected_as_it_must_be(name):
    start = gg.layout(name, **SMALL[name])
    assert gg.quality(start).valid
    assert gg.quality(gg.layout(name)).valid
    assert len(start.bonds) == KNOWN[name][0]
    free = np.concatenate([mask.ravel() == 0 for mask in start.outer])
    found = np.concatenate([one.ravel() for one in valences(start)])
    # Every copy of a node has its valence.
    singular = np.flatnonzero(free & (found != 4))
    places = {tuple(place) for place in np.round(nodes(start)[singular], 9)}
    assert len(places) == len(KNOWN[name][1])
    assert set(found[singular]) == set(KNOWN[name][1])
    # Every edge of the outer boundary has one name.
    assert set(start.boundaries) == BOUNDARIES[name]
    parts = [(p.block, p.side, k) for given in start.boundaries.values() for p in given for k in range(p.first, p.last)]
    joined = [(p.block, p.side, k) for b in start.bonds for p in (b.one, b.other) for k in range(p.first, p.last)]
    edges = sum(2 * (grid.shape[0] + grid.shape[1] - 2) for grid in start.blocks)
    assert len(set(parts)) == len(parts)
    assert len(parts) + len(joined) == edges
    solved(name)


@pytest.mark.parametrize(
    ("name", "turn"),
    [
        ("pipe", 90),
        ("square_with_hole", 90),
        ("wye", 120),
        *((name, None) for name in ("airfoil_c", "airfoil_o", "annulus", "sector", "channel_with_hole", "wye")),
    ],
)
def test_a_grid_is_as_symmetric_as_its_shape(name, turn):
    """Turned by an angle, or mirrored at the x axis, it is the same grid."""
    found = nodes(solved(name).grid)
    c, s = np.cos(np.radians(turn or 0)), np.sin(np.radians(turn or 0))
    moved = found @ np.array([[c, -s], [s, c]]).T if turn else found * np.array([1, -1])
    assert same_set(moved, found) < 1e-10 * np.ptp(found)


@pytest.mark.parametrize("name", ["pipe", "square_with_hole"])
def test_a_grid_with_singular_nodes_is_the_best_of_its_neighbors(name):
    found = solved(name)
    problem = make_layout_problem(found.grid, "winslow")
    place = problem.exchange.join([block.planes for block in found.grid.blocks])
    size = np.sqrt(found.quality.mean_jacobian)
    random = np.random.default_rng(1)
    least = found.quality.min_scaled_jacobian
    print(f"{name}: smallest scaled Jacobian {least:.4f}")
    for _ in range(20):
        move = random.normal(0, 0.02 * size, place.shape)
        planes = [
            block + shift * (mask == 0)
            for block, shift, mask in zip(
                problem.exchange.views(place),
                problem.exchange.views(problem.exchange.of_first_copies(move)),
                found.grid.outer,
                strict=True,
            )
        ]
        moved = found.grid.moved(planes)
        assert gg.energy(moved, "winslow") > found.energy
        assert gg.quality(moved).min_scaled_jacobian < least


def test_a_passage_is_periodic():
    start = gg.layout("cascade", pitch=0.6, **SMALL["cascade"])
    passage = start["passage"]
    assert passage.xy[:5, -1] - passage.xy[:5, 0] == pytest.approx(np.tile([0, 0.6], (5, 1)), abs=1e-14)
    assert [bond.motion.shift for bond in start.bonds] == [(0.0, 0.6)] * 2
    moved = solved("cascade").grid["passage"]
    assert moved.xy[:5, -1] - moved.xy[:5, 0] == pytest.approx(np.tile([0, 0.8], (5, 1)), abs=1e-13)


def test_the_section_is_the_wall():
    start = gg.layout("airfoil_c", section="naca2412", **SMALL["airfoil_c"])
    (wall,) = start.boundaries["wall"]
    nose = wall.nodes(start.blocks)
    assert np.ptp(nose[:, 0]) == pytest.approx(1, abs=0.01)
    assert nose[0] == pytest.approx(nose[-1])


def test_lengths_and_cells_are_taken():
    tee = gg.layout("tee", width=2.0, branch=1.0, height=4.0, across=8)
    assert tee["branch"].shape == (5, 17)
    assert nodes(tee).max(axis=0) == pytest.approx([3, 6])
    assert gg.layout("pipe", radius=3.0, across=4)["core"].shape == (5, 5)


@pytest.mark.parametrize(
    ("name", "given", "told"),
    [
        ("pip", {}, "no layout is called 'pip': did you mean 'pipe'"),
        (3, {}, "no layout is called 3"),
        ("pipe", {"size": 3}, "has no parameter 'size'; it takes: radius, core, across, outwards"),
        ("pipe", {"across": 2.5}, "across of the layout 'pipe' must be a whole number of cells, at least 2; came 2.5"),
        ("pipe", {"across": 1}, "at least 2; came 1"),
        ("pipe", {"radius": float("nan")}, "radius of the layout 'pipe' must be a finite number; came nan"),
        ("pipe", {"radius": "1"}, "must be a finite number; came '1'"),
        ("pipe", {"core": 1.5}, "core of the layout 'pipe' does not fit: the distance of the core's corners from the"),
        ("annulus", {"inner": 3.0}, "outer of the layout 'annulus' does not fit: that of the outer circle, greater"),
        ("sector", {"angle": 270.0}, "angle of the layout 'sector' does not fit"),
        ("wye", {"across": 7}, "an even number of cells"),
        ("channel_with_hole", {"upstream": 0.5}, "more than `ring`"),
        ("airfoil_c", {"around": 17}, "an even one of at least 16"),
        ("airfoil_o", {"first": -1.0}, "first must be less than a chord over the 32 cells outwards, and positive"),
        ("cascade", {"section": "nasa"}, "four or five digits"),
    ],
)
def test_wrong_parameters_are_told(name, given, told):
    with pytest.raises(gg.GridgenError, match=told):
        gg.layout(name, **given)
