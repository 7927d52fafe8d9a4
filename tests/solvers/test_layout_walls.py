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
    assert heights(found.grid["0-0"])[2:] == pytest.approx(2e-3, rel=0.06)
    assert heights(found.grid["1-0"])[:-2] == pytest.approx(2e-3, rel=0.06)
    assert np.abs(found.grid["0-0"].planes[:, -1, 1:-1] - start.planes[:, 12, 1:-1]).max() > 1e-2  # It has moved.


def test_a_block_without_a_wall_keeps_the_size_of_its_cells():
    start = cut(gg.domain("square", 17, 17), (0, 16), (0, 8, 16))
    found = gg.optimize(start, "winslow", walls={"0-0": {"bottom": gg.Wall(first=5e-3, growth=1.3)}})
    assert found.converged, found.message
    assert heights(found.grid["0-0"])[1:-1] == pytest.approx(5e-3, rel=0.05)
    assert np.diff(found.grid["0-1"].y[8]) == pytest.approx(1 / 16, rel=0.2)


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


def test_wrong_walls_are_told():
    start = cut(gg.domain("square", 9, 9), (0, 4, 8), (0, 8))
    wall = gg.Wall(first=1e-2)
    for walls, told in (
        ({"bottom": wall}, "are given by block and side"),
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
