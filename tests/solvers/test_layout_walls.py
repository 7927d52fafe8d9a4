"""Walls in a grid of several blocks."""

from __future__ import annotations

import numpy as np
import pytest
from layouts import cut
from support import NO_SHARED, SHARED

import gridgen_sym as gg

NASA = SHARED / "nasa" / "n0012_113-33.p2dfmt"


def heights(grid):
    """The heights of the first cells at the bottom."""
    return np.hypot(*(grid.planes[:, :, 1] - grid.planes[:, :, 0]))


def test_a_wall_goes_on_through_a_connection():
    start = gg.domain("wavy", 33, 17)
    lines = (0, 12, 32), (0, 16)
    wall = gg.Wall(first=2e-3, growth=1.25)
    found = gg.optimize(cut(start, *lines), "winslow", walls={name: {"bottom": wall} for name in ("0-0", "1-0")})
    assert found.converged, found.message
    assert found.quality.valid
    # Beside the two ends, whose own nodes stay where they are.
    assert heights(found.grid["0-0"])[1:] == pytest.approx(2e-3, rel=0.01)
    assert heights(found.grid["1-0"])[:-2] == pytest.approx(2e-3, rel=0.01)
    assert np.abs(found.grid["0-0"].planes[:, -1, 1:-1] - start.planes[:, 12, 1:-1]).max() > 1e-2  # It has moved.


def test_a_block_without_a_wall_keeps_the_size_of_its_cells():
    start = cut(gg.domain("square", 17, 17), (0, 16), (0, 8, 16))
    found = gg.optimize(start, "winslow", walls={"0-0": {"bottom": gg.Wall(first=5e-3, growth=1.3)}})
    assert found.converged, found.message
    assert heights(found.grid["0-0"])[1:-1] == pytest.approx(5e-3, rel=0.01)
    assert np.diff(found.grid["0-1"].y[8]) == pytest.approx(1 / 16, rel=0.2)


def test_a_wall_may_end_at_a_connection():
    """The block behind has no wall: its cells pass from those of the wall to its own."""
    start = cut(gg.domain("wavy", 33, 17), (0, 12, 32), (0, 16))
    found = gg.optimize(start, "winslow", walls={"0-0": {"bottom": gg.Wall(first=2e-3, growth=1.25)}})
    assert found.converged, found.message
    assert found.quality.valid
    assert heights(found.grid["0-0"])[1:] == pytest.approx(2e-3, rel=0.01)
    assert heights(found.grid["1-0"])[10] > 0.01


def test_walls_that_meet_at_a_reentrant_corner():
    """At the corners of a T, three blocks meet at the walls' end; that in the middle has a wall at its bottom only."""
    start = gg.layout("tee", across=8)
    found = gg.optimize(start, "winslow", walls={"wall": gg.Wall(first=0.03)})
    assert found.converged, found.message
    assert found.quality.valid
    for name in ("junction", "upstream", "downstream"):
        own = {"junction": slice(None), "upstream": slice(1, None), "downstream": slice(-1)}[name]
        assert heights(found.grid[name])[own] == pytest.approx(0.03, rel=0.01)
    planes = found.grid["branch"].planes
    assert np.hypot(*(planes[:, 1] - planes[:, 0]))[:-1] == pytest.approx(0.03, rel=0.01)


@pytest.mark.skipif(not NASA.is_file(), reason=NO_SHARED.format("nasa"))
def test_a_c_grid_with_walls_and_a_free_cut():
    file = gg.read(NASA)
    first = heights(file)[24:89]
    start = gg.transfinite(file.xy[:, 0], file.xy[:, -1], file.xy[0], file.xy[-1])
    found = gg.optimize(gg.MultiBlock([start]), "winslow", walls={"bottom": gg.Wall(first=first, nodes=(24, 89))})
    assert found.converged, found.message
    assert found.quality.valid
    ratio = heights(found.grid.blocks[0])[24:89] / first
    assert np.quantile(np.abs(ratio[1:-1] - 1), 0.95) < 0.01
    planes = found.grid.blocks[0].planes
    assert np.array_equal(planes[:, :25, 0], planes[:, 112:87:-1, 0])


def test_walls_may_be_given_by_the_name_of_a_boundary():
    start, wall = gg.layout("pipe", across=6, outwards=6), gg.Wall(first=0.05)
    found = gg.optimize(start, "winslow", walls={"wall": wall})
    blocks = ("south", "east", "north", "west")
    same = gg.optimize(start, "winslow", walls={name: {"bottom": wall} for name in blocks})
    assert all(a == b for a, b in zip(found.grid.blocks, same.grid.blocks, strict=True))
    assert heights(found.grid["south"]) == pytest.approx(0.05, rel=0.01)
    told = {
        "has two walls, of which one is wall": {"south": {"bottom": wall}, "wall": wall},
        "has its own nodes": {"wall": gg.Wall(first=0.05, nodes=(0, 3))},
        "unknown boundary 'wal' in walls; the boundaries are: wall": {"wal": wall},
    }
    for match, walls in told.items():
        with pytest.raises(gg.GridgenError, match=match):
            gg.optimize(start, "winslow", walls=walls)


def test_a_wall_that_is_a_part_of_a_side():
    start = gg.layout("airfoil_c", around=16, outwards=8, wake=8, first=0.02, far=2.0)
    (part,) = start.boundaries["wall"]
    found = gg.optimize(start, "winslow", walls={"wall": gg.Wall(first=0.02)})
    assert found.quality.valid
    assert heights(found.grid["airfoil"])[part.first + 2 : part.last - 1] == pytest.approx(0.02, rel=0.1)


def test_wrong_walls_are_told():
    start = cut(gg.domain("square", 9, 9), (0, 4, 8), (0, 8))
    wall = gg.Wall(first=1e-2)
    for walls, told in (
        ({"bottom": wall}, "unknown boundary 'bottom' in walls; the boundaries are: none has a name"),
        ({"0-0": 3}, "are given by block and side"),
        (wall, "are given by block and side"),
        ({"2": {"bottom": wall}}, "unknown block '2'"),
        (
            {"0-0": {"right": wall}},
            "right of block 0-0 lies on a connection, right of block 0-0, nodes 0 to 8",
        ),
    ):
        with pytest.raises(gg.GridgenError, match=told):
            gg.optimize(start, "winslow", walls=walls)
    with pytest.raises(gg.GridgenError, match="give walls or a target, not both"):
        gg.optimize(start, "winslow", walls={"0-0": {"bottom": wall}}, target=start)
