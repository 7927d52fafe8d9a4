"""Rectilinear and bracket-like outlines with reflex turns on their sides: at every size a valid grid or a proof."""

from __future__ import annotations

from itertools import cycle

import pytest

import gridgen_sym as gg

#: Vertices, counter-clockwise, and the indices of the four corners.
_S = [(0, 0), (4, 0), (4, 3), (1, 3), (1, 4), (4, 4), (4, 5), (0, 5), (0, 2), (3, 2), (3, 1), (0, 1)]
_SLANTED_S = [(0.1, -0.1), (3.9, 0.2), (4.3, 2.8), (0.9, 2.9), (0.8, 3.9), (3.9, 3.9)]
_SLANTED_S += [(4.3, 5.1), (0.2, 5.1), (-0.2, 2.2), (3.2, 2.2), (2.9, 0.8), (0.2, 1.1)]
_FLAT_S = [(0.06, 0.85), (-0.23, -0.08), (4.2, 0), (4.27, 2.83), (0.81, 3.19), (1.01, 3.79)]
_FLAT_S += [(3.78, 4), (4.05, 5.08), (0.13, 4.87), (0.09, 1.81), (3.28, 2.27), (2.77, 1.14)]
_ZIGZAG = [(0, 0), (3, 0), (3, 3), (6, 3), (6, 0), (9, 0), (9, 1), (7, 1), (7, 4), (2, 4), (2, 1), (0, 1)]
OUTLINES = {
    "L": ([(0, 0), (4, 0), (4, 5), (3, 5), (3, 1), (0, 1)], (0, 2, 3, 5)),
    "U": ([(0, 4), (0, 0), (5, 0), (5, 4), (4, 4), (4, 1), (1, 1), (1, 4)], (0, 1, 2, 7)),
    "T": ([(0, 3), (0, 2), (2, 2), (2, 0), (3, 0), (3, 2), (5, 2), (5, 3)], (1, 6, 7, 0)),
    "E": (
        [(0, 0), (4, 0), (4, 1), (1, 1), (1, 2), (3, 2), (3, 3), (1, 3), (1, 4), (4, 4), (4, 5), (0, 5)],
        (1, 2, 9, 10),
    ),
    "comb": (
        [(0, 0), (7, 0), (7, 3), (6, 3), (6, 1), (4, 1), (4, 3), (3, 3), (3, 1), (1, 1), (1, 3), (0, 3)],
        (0, 1, 2, 11),
    ),
    "H": (
        [(0, 0), (1, 0), (1, 2), (3, 2), (3, 0), (4, 0), (4, 5), (3, 5), (3, 3), (1, 3), (1, 5), (0, 5)],
        (0, 5, 6, 11),
    ),
    "stairs": ([(0, 0), (5, 0), (5, 4), (4, 4), (4, 3), (3, 3), (3, 2), (2, 2), (2, 1), (0, 1)], (0, 1, 2, 9)),
    "slanted bracket": (
        [(0, 0), (5, -1.5), (5.3, -0.5), (1.2, 1), (1.2, 3), (5, 4.5), (4.7, 5.5), (0, 4)],
        (1, 2, 5, 6),
    ),
    "zigzag": (_ZIGZAG, (4, 6, 9, 11)),
    "S": ([_S[-1], *_S[:-1]], (0, 1, 3, 7)),
    "slanted S": ([*_SLANTED_S[5:], *_SLANTED_S[:5]], (0, 1, 3, 8)),
    "S with a side of seven turns": (_FLAT_S, (0, 1, 7, 8)),
}
SIZES = [(40, 8), (60, 12), (100, 20), (120, 24), (160, 32), (240, 48)]
SAMPLINGS = "features", "equal"
#: Those that no regularized barrier makes valid from the start that nested iteration gives.
HARD = [
    ("S", (180, 36), "equal"),
    ("slanted S", (180, 36), "features"),
]


def assert_valid_or_proved(name, cells, sampling):
    points, corners = OUTLINES[name]
    outline = gg.Outline(points, corners, name)
    start = outline.grid(cells[0] + 1, cells[1] + 1, corners=outline.corners, sampling=sampling)
    result = gg.untangle(start)
    assert result.quality.valid or any(proof.impossible for proof in result.certificates), result.message
    return result


@pytest.mark.slow
@pytest.mark.parametrize(("name", "cells", "sampling"), HARD)
def test_a_valid_coarse_grid_is_not_lost(name, cells, sampling):
    result = assert_valid_or_proved(name, cells, sampling)
    assert result.quality.valid
    assert result.untangled_by == "refined coarse grids"


@pytest.mark.parametrize("name", OUTLINES)
def test_an_outline_is_gridded(name):
    assert_valid_or_proved(name, (80, 16), "features")


@pytest.mark.slow
@pytest.mark.parametrize("name", OUTLINES)
def test_an_outline_is_gridded_at_every_size(name):
    for cells, sampling in zip(SIZES, cycle(SAMPLINGS), strict=False):
        assert_valid_or_proved(name, cells, sampling)
