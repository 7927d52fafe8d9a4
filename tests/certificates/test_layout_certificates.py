"""Certificates of several blocks: where the boundary of a block stays, and nowhere else."""

from __future__ import annotations

import numpy as np
from layouts import butterfly, cut

import gridgen_sym as gg


def grid_of(x, y):
    return gg.Grid.from_planes(*np.broadcast_arrays(x, y))


XI, ETA = np.linspace(0, 1, 9)[:, None], np.linspace(0, 1, 9)


def test_a_block_by_itself_has_all_proofs():
    crossed = grid_of(XI, ETA * (1 - 2 * XI))
    layout = gg.MultiBlock({"good": grid_of(XI + 5, ETA), "crossed": crossed}, [])
    assert gg.certificates(layout) == {"crossed": gg.certificates(crossed)}


def test_blocks_that_make_up_a_plain_grid_have_its_proofs():
    """A clockwise boundary is proved by no single block of it: each could be reached by another."""
    whole = grid_of(-XI, ETA)
    found = gg.certificates(cut(whole, (0, 4, 8), (0, 8)))
    assert list(found) == ["0-0 + 1-0"]
    (proof,) = found["0-0 + 1-0"]
    assert proof.kind == "clockwise"
    assert "one block of 9 x 9 nodes, which 2 blocks make up" in proof.message


def pinched(corner):
    """A pipe of five blocks of which the south one has a folded corner: on the wall, or on the core's."""
    layout = butterfly(8, 6)
    blocks = dict(zip(layout.names, (np.array(block.planes) for block in layout.blocks), strict=True))
    j = 0 if corner == "wall" else -1
    middle = blocks["south"][:, 4, j].copy()
    if corner == "wall":
        blocks["south"][:, 4, j] = blocks["south"][:, 2, j]  # The wall runs back on itself.
    else:
        blocks["south"][:, 4, j] = blocks["core"][:, 4, 0] = middle - np.array((0, 0.65))
    return gg.MultiBlock({name: gg.Grid.from_planes(*planes) for name, planes in blocks.items()}, layout_bonds(layout))


def layout_bonds(layout):
    return [
        gg.Connection((b.one.block, b.one.side, (b.one.first, b.one.last)), (b.other.block, b.other.side))
        for b in layout.bonds
    ]


def test_of_a_connected_block_the_outer_boundary_proves_something():
    found = gg.certificates(pinched("wall"))
    assert list(found) == ["south"]
    assert {proof.kind for proof in found["south"]} == {"spike"}
    solved = gg.optimize(pinched("wall"), "winslow")
    assert solved.status is gg.Status.IMPOSSIBLE
    assert gg.untangle(pinched("wall")).status is gg.Status.IMPOSSIBLE
    assert "south" in solved.certificates
    assert "no valid grid exists: at node" in solved.message


def test_connections_prove_nothing_since_their_nodes_move():
    """The core and the south block are folded along their connection, and a valid grid exists."""
    folded = pinched("core")
    assert not gg.quality(folded).valid
    assert gg.certificates(folded["south"])
    assert gg.certificates(folded, search=True) == {}
    solved = gg.optimize(folded, "winslow")
    assert solved.quality.valid
    assert solved.certificates == {}


def l_shape():
    """Three squares: the second on the right of the first, the third above it."""
    planes = [np.stack(np.broadcast_arrays(XI + a, ETA + b)).copy() for a, b in ((0, 0), (1, 0), (0, 1))]
    return planes, [gg.Connection((0, "right"), (1, "left")), gg.Connection((0, "top"), (2, "bottom"))]


def proved(planes, bonds):
    found = gg.certificates(gg.MultiBlock([gg.Grid.from_planes(*one) for one in planes], bonds), search=True)
    return [(name, one.kind, one.nodes[-1]) for name, proofs in found.items() for one in proofs]


def test_edges_without_length_are_proved_on_the_outer_boundary():
    planes, bonds = l_shape()
    planes[1][:, -1, 3] = planes[1][:, -1, 2]
    assert proved(planes, bonds) == [("1", "coincident", (8, 3))]
    planes, bonds = l_shape()
    planes[0][:, 3, -1] = planes[2][:, 3, 0] = planes[0][:, 2, -1]
    assert proved(planes, bonds) == []


def test_corners_that_turn_wrong_are_proved_on_the_outer_boundary():
    planes, bonds = l_shape()
    planes[1][:, -1, 0] = (1.9, 0.2)
    assert proved(planes, bonds) == [("1", "corner", (8, 1))]
    planes, bonds = l_shape()
    planes[0][:, -1, -2] = planes[1][:, 0, -2] = (1.2, 1.2)  # A corner of the first block, inside of the L.
    assert proved(planes, bonds) == []
