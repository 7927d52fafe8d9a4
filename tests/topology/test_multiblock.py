"""Layouts: which nodes are the same, what is refused, and the steps of the logical coordinates."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from layouts import butterfly, cut, ring
from support import NO_SHARED, SHARED

import gridgen_sym as gg
from gridgen_sym.topology.steps import unit_steps

WAVY = gg.domain("wavy", 13, 17)
SQUARE = gg.domain("square", 5, 7)


def test_blocks_that_touch_are_connected():
    layout = cut(WAVY, (0, 4, 12), (0, 6, 10, 16))
    assert len(layout) == 6
    assert layout.node_count == 13 * 17
    assert len(layout.bonds) == 7
    assert all(not bond.reversed for bond in layout.bonds)
    assert layout["1-2"] == gg.Grid.from_planes(*WAVY.planes[:, 4:, 10:])
    # Four blocks meet at two nodes.
    assert sorted(layout.copies.counts.tolist())[-3:] == [2, 4, 4]
    assert sum(int(mask.sum()) for mask in layout.outer) == 2 * (13 + 17) - 4 + 2 * 3
    # It selects nodes, as a mask of NumPy does.
    assert len(layout.blocks[0].xy[layout.outer[0]]) == layout.outer[0].sum()


def test_blocks_may_be_turned():
    """The second block is turned by a quarter: its bottom lies at the right of the first."""
    first, second = WAVY.planes[:, :5], WAVY.planes[:, 4:]
    turned = gg.Grid.from_planes(*np.ascontiguousarray(second.transpose(0, 2, 1)[:, ::-1]))
    layout = gg.MultiBlock([gg.Grid.from_planes(*first), turned])
    (bond,) = layout.bonds
    assert (bond.one.side, bond.other.side, bond.reversed) == ("right", "bottom", True)
    assert layout.node_count == 13 * 17


def test_a_side_may_be_connected_with_itself_in_part():
    nodes = ring(np.linspace(0, 2 * np.pi, 25), 1.0, 2.0, 5)
    (bond,) = gg.MultiBlock([nodes]).bonds
    assert {bond.one.side, bond.other.side} == {"left", "right"}
    # The bottom runs in along the x axis, round a disk of no height, and back.
    x = np.abs(np.linspace(-2, 2, 17))
    c_grid = gg.Grid.from_planes(*np.meshgrid(np.zeros(17), np.zeros(4), indexing="ij"))
    planes = np.array(c_grid.planes)
    planes[0], planes[1] = x[:, None] + 0.0, np.sign(np.linspace(-1, 1, 17))[:, None] * np.linspace(0, 1, 4)
    planes[1, 8] = 0.0
    planes[0, 8] = -np.linspace(0, 1, 4)
    (bond,) = gg.MultiBlock([gg.Grid.from_planes(*planes)]).bonds
    assert (bond.one.first, bond.one.last, bond.other.first, bond.other.last) == (0, 8, 8, 16)


@pytest.mark.skipif(not (SHARED / "nasa").is_dir(), reason=NO_SHARED.format("nasa"))
def test_the_cut_of_a_c_grid_is_found():
    layout = gg.MultiBlock([gg.read(SHARED / "nasa" / "n0012_113-33.p2dfmt")])
    (bond,) = layout.bonds
    assert (bond.one.first, bond.one.last, bond.other.first, bond.other.last) == (0, 24, 88, 112)
    assert not layout.outer[0][1:24, 0].any()
    assert layout.outer[0][24:89, 0].all()


def test_nodes_are_the_same_up_to_a_motion():
    layout = gg.MultiBlock([SQUARE], [gg.Connection((0, "bottom"), (0, "top"), translation=(0, 1))])
    assert layout.node_count == 5 * 6
    angle = np.pi / 2 * np.linspace(0, 1, 7)
    sector = ring(angle, 1.0, 2.0, 5)
    layout = gg.MultiBlock({"a": sector}, [gg.Connection(("a", "left"), ("a", "right"), rotation=-90)])
    assert layout.copies.turn[:, 1] == pytest.approx([0, -1], abs=1e-15)


@pytest.mark.parametrize(
    ("connections", "told"),
    [
        ([gg.Connection((0, "right"), (1, "bottom"))], "have 7 and bottom of block 1"),
        ([gg.Connection((0, "right"), (1, "right"))], r"lies 1.41 away from where node \(4, [0-6]\) of block 0 is"),
        ([gg.Connection((0, "right"), (1, "left")), gg.Connection((0, "right"), (1, "right"))], "connected twice"),
        ([gg.Connection((0, "right"), (2, "left"))], "unknown block 2: the blocks are 0, 1, or 0 to 1"),
        ([gg.Connection((0, "rihgt"), (1, "left"))], "unknown side 'rihgt'"),
        ([gg.Connection((0, "right", (0, 7)), (1, "left"))], "0 <= first < last <= 6; came"),
        ("atuo", "connections are 'auto'"),
        (["auto", 3], "a connection is a Connection or 'auto'; came 3"),
    ],
)
def test_wrong_connections_are_told(connections, told):
    right = gg.Grid.from_planes(SQUARE.x + 1, SQUARE.y)
    with pytest.raises(gg.GridgenError, match=told):
        gg.MultiBlock([SQUARE, right], connections)


@pytest.mark.parametrize(
    ("boundaries", "told"),
    [
        ([(0, "top")], "boundaries map names to parts of sides"),
        ({"wall": None}, "the boundary 'wall' is a list of parts of sides"),
        ({"wall": (0, "top")}, "a part of a side is a block, a side"),
        ({"wall": [(0, "right")]}, "they are connected"),
    ],
)
def test_wrong_boundaries_are_told(boundaries, told):
    right = gg.Grid.from_planes(SQUARE.x + 1, SQUARE.y)
    with pytest.raises(gg.GridgenError, match=told):
        gg.MultiBlock([SQUARE, right], boundaries=boundaries)


def test_two_blocks_of_one_name_are_told():
    with pytest.raises(gg.GridgenError, match="blocks have different names, as text; came \\[1, '1'\\]"):
        gg.MultiBlock({1: SQUARE, "1": SQUARE}, [])


def test_three_blocks_at_one_edge_are_told():
    right = gg.Grid.from_planes(SQUARE.x + 1, SQUARE.y)
    with pytest.raises(gg.GridgenError, match="3 edges of sides lie at one place"):
        gg.MultiBlock([SQUARE, right, right])


def test_a_loop_that_leads_elsewhere_is_told():
    """The two ends of a strip, moved and turned: no free node may be its own neighbor, turned."""
    bonds = [
        gg.Connection((0, "right"), (1, "left")),
        gg.Connection((0, "bottom"), (0, "top"), translation=(0, 1)),
        gg.Connection((1, "bottom"), (1, "top"), translation=(0, 1.0)),
    ]
    right = gg.Grid.from_planes(SQUARE.x + 1, SQUARE.y)
    gg.MultiBlock([SQUARE, right], bonds)
    angle = 2 * np.pi / 3 * np.linspace(0, 1, 7)
    sector = ring(angle, 1e-30, 2.0, 5)
    pole = np.array(sector.planes)
    pole[:, :, 0] = 0.0
    with pytest.raises(gg.GridgenError, match="do not lead back to it"):
        gg.MultiBlock(
            [gg.Grid.from_planes(*pole)],
            [
                gg.Connection((0, "left"), (0, "right"), rotation=-120),
                gg.Connection((0, "bottom", (0, 3)), (0, "bottom", (3, 6))),
            ],
        )


def test_boundaries_have_names():
    layout = gg.MultiBlock({"a": SQUARE}, boundaries={"wall": [("a", "bottom"), ("a", "top", (2, 4))]})
    assert [(part.side, part.first, part.last) for part in layout.boundaries["wall"]] == [
        ("bottom", 0, 4),
        ("top", 2, 4),
    ]
    right = gg.Grid.from_planes(SQUARE.x + 1, SQUARE.y)
    with pytest.raises(gg.GridgenError, match="cannot be the boundary 'wall': they are connected"):
        gg.MultiBlock([SQUARE, right], boundaries={"wall": [(0, "right")]})


def test_steps_are_those_of_the_uncut_block():
    for columns, rows in (((0, 12), (0, 16)), ((0, 4, 12), (0, 6, 10, 16))):
        assert set(unit_steps(cut(WAVY, columns, rows))) == {(1 / 12, 1 / 16)}


def test_a_direction_that_closes_has_the_steps_of_the_others():
    nodes = ring(np.linspace(0, 2 * np.pi, 25), 1.0, 2.0, 5)
    assert unit_steps(gg.MultiBlock([nodes])) == [(1 / 4, 1 / 4)]
    pitch = gg.MultiBlock([SQUARE], [gg.Connection((0, "bottom"), (0, "top"), translation=(0, 1))])
    assert unit_steps(pitch) == [(1 / 4, 1 / 4)]


def test_where_directions_meet_at_a_singular_node_all_steps_are_one():
    assert len({step for steps in unit_steps(butterfly(4, 3)) for step in steps}) == 1


def test_layouts_are_values():
    layout, same = (cut(WAVY, (0, 4, 12), (0, 6, 16)) for _ in range(2))
    assert layout == same == pickle.loads(pickle.dumps(layout))
    assert hash(layout) == hash(same)
    assert layout != cut(WAVY, (0, 6, 12), (0, 6, 16))
    assert layout != 1


def test_quality_is_of_all_blocks():
    layout, whole = cut(WAVY, (0, 4, 12), (0, 6, 16)), gg.quality(WAVY)
    found = gg.quality(layout)
    assert (found.cells, found.folded_cells, found.valid) == (whole.cells, 0, True)
    for name in ("min_jacobian", "max_jacobian", "mean_jacobian", "min_scaled_jacobian", "mean_condition", "min_angle"):
        assert getattr(found, name) == pytest.approx(getattr(whole, name), rel=1e-12)
    assert found.mean_non_orthogonality == pytest.approx(whole.non_orthogonality.mean)
    assert "blocks                        4" in str(found)
    folded = np.array(WAVY.planes)
    folded[:, 8, 3] = folded[:, 6, 3]
    told = str(gg.quality(cut(gg.Grid.from_planes(*folded), (0, 4, 12), (0, 6, 16))))
    assert "cells are folded" in told
    assert "block 1-0: not valid" in told
