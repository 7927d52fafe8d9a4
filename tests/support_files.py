"""Grids and layouts with every kind of connection and name, for the tests of files."""

from __future__ import annotations

import numpy as np
from layouts import butterfly, cut, ring

import gridgen_sym as gg

SWAN = gg.domain("swan", 5, 4)


def turned():
    """Two blocks, the second of which is turned by a quarter; a wall on both, and a name on a part of a side."""
    square = gg.domain("square", 5, 7)
    right = np.array(square.planes)
    right[0] += 1
    second = np.ascontiguousarray(right.transpose(0, 2, 1)[:, ::-1])
    names = {"wall": [(0, "bottom", (0, 2)), (0, "left")], "far": [(0, "bottom", (2, 4)), (1, "top")]}
    return gg.MultiBlock({"a": square, "b": gg.Grid.from_planes(*second)}, boundaries=names)


def cascade():
    """A passage between two blades: periodic before and behind them."""
    x, y = np.meshgrid(np.linspace(0, 3, 7), np.linspace(0, 1, 4), indexing="ij")
    parts = [gg.Connection((0, "top", at), (0, "bottom", at), translation=(0, -1.0)) for at in ((0, 2), (4, 6))]
    blade = {"blade": [(0, "top", (2, 4)), (0, "bottom", (2, 4))]}
    return gg.MultiBlock([gg.Grid.from_planes(x, y + 0.1 * np.sin(x))], parts, boundaries=blade)


def sector():
    angles = np.linspace(0, 2 * np.pi / 7, 5)
    return gg.MultiBlock([ring(angles, 1.0, 3.0, 9)], [gg.Connection((0, "left"), (0, "right"), rotation=-360 / 7)])


LAYOUTS = {
    "turned": turned,
    "cascade": cascade,
    "sector": sector,
    "ring": lambda: gg.MultiBlock([ring(np.linspace(0, 2 * np.pi, 25), 1.0, 2.0, 5)]),
    "pipe": lambda: butterfly(4, 3),
    "cut": lambda: cut(gg.domain("wavy", 9, 9), (0, 4, 8), (0, 2, 8)),
    "grid": lambda: SWAN,
    "clockwise": lambda: gg.Grid(SWAN.xy[::-1]),
}
