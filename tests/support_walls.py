"""What tests of walls share: a channel, the boundaries of NASA's grids, and heights and angles at a side."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support import NO_SHARED, SHARED

import gridgen_sym as gg
from gridgen_sym.boundary.laws import geometric

_DATA = Path(__file__).parents[1] / "benchmarks" / "data"


def channel(ni=41, nj=25, first=None):
    """A channel with a bump; `first` clusters the nodes of its two ends to the bottom."""
    s, e = np.linspace(0, 1, ni), np.linspace(0, 1, nj)
    if first is not None:
        e = geometric(first, nj - 1)[0]
    low = 0.15 * np.exp(-40 * (s - 0.5) ** 2)
    bottom, top = np.stack([3 * s, low], -1), np.stack([3 * s, np.ones(ni)], -1)
    left, right = (np.stack([np.full(nj, x), y + e * (1 - y)], -1) for x, y in ((0.0, low[0]), (3.0, low[-1])))
    return gg.transfinite(bottom, top, left, right)


def clustered(first):
    """A grid over a curved wall, the bottom, whose first cells are `first` high and 1/40 long."""
    along, off = np.meshgrid(np.linspace(0, 1, 41), geometric(first, 30)[0], indexing="ij")
    return gg.Grid(np.stack([along, 0.2 * along**2 + off * (1 + 0.1 * along)], axis=-1))


def heights(grid, side="bottom"):
    """Return the heights of the first cells over the inner nodes of a side, and their degrees off the normal."""
    xy = {"bottom": grid.xy, "top": grid.xy[:, ::-1], "left": grid.xy.swapaxes(0, 1)}[side]
    up, along = xy[1:-1, 1] - xy[1:-1, 0], xy[2:, 0] - xy[:-2, 0]
    height = np.hypot(*up.T)
    cosine = (up * along).sum(axis=1) / (height * np.hypot(*along.T))
    return height, np.degrees(np.arcsin(np.abs(cosine)))


def nasa(name):
    """Return the boundary of a grid of NASA's collection as a transfinite start, and its first heights."""
    path = _DATA / f"{name}.p2dfmt"
    if not path.exists():
        path = SHARED / "nasa" / path.name
    if not path.exists():
        pytest.skip(NO_SHARED.format(path.name))
    numbers = np.array(path.read_text().split(), dtype=float)
    ni, nj = numbers[1:3].astype(int)
    x, y = numbers[3:].reshape(2, nj, ni).transpose(0, 2, 1)
    xy = np.stack([x, y], axis=-1)
    return gg.transfinite(xy[:, 0], xy[:, -1], xy[0], xy[-1]), np.hypot(*(xy[:, 1] - xy[:, 0]).T)
