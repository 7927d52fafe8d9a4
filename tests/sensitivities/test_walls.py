"""The derivatives of the cells that walls ask for, of every law, against differences."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import gridgen_sym as gg
from gridgen_sym.boundary.wall import walls_by_side
from gridgen_sym.fields.wall_cells import wall_cells
from gridgen_sym.sensitivities.wall_lines import difference, laws_of
from gridgen_sym.sensitivities.walls import in_wall_cells

Wall = gg.Wall
SHAPE = 13, 11


def start() -> np.ndarray:
    """Return the nodes (2, ni, nj) of a block with four different sides."""
    s, t = np.linspace(0, 1, SHAPE[0]), np.linspace(0, 1, SHAPE[1])[:, None]
    bottom = np.stack((3 * s**1.1, 0.2 * np.sin(3 * s)), axis=-1)
    top = np.stack((3.3 * s**1.1, 2 + 0.3 * np.cos(3 * s)), axis=-1)
    left, right = (bottom[k] + (top[k] - bottom[k]) * t**power for k, power in ((0, 1.5), (-1, 1.4)))
    return gg.transfinite(bottom, top, left, right).planes


CASES = {
    "geometric": {"bottom": Wall(0.02)},
    "growth": {"bottom": Wall(0.02, growth=1.3)},
    "tanh_not_orthogonal": {"bottom": Wall(0.02 * np.ones(13), law="tanh", orthogonal=False)},
    "vinokur": {"bottom": Wall(0.02), "top": Wall(0.03)},
    "both_grow": {"bottom": Wall(0.05, growth=1.6), "top": Wall(0.06, growth=1.6)},
    "three_sides": {"left": Wall(0.05, law="sinh"), "right": Wall(0.04), "bottom": Wall(0.02)},
    "part_of_a_side": {"bottom": Wall(0.02, nodes=(3, 9))},
    "part_with_growth": {"top": Wall(0.02 * np.ones(6), growth=1.3 * np.ones(6), nodes=(7, 13))},
}


@pytest.mark.parametrize("walls", CASES.values(), ids=CASES)
def test_derivatives_of_the_cells_that_walls_ask_for(walls):
    """In first heights, growth and the boundary together, of random numbers times lengths and angles."""
    random, place = np.random.default_rng(0), start()
    cotangent = random.standard_normal((3, 4, SHAPE[0] - 1, SHAPE[1] - 1))
    moved = 0.1 * random.standard_normal(place.shape)
    change = {
        side: (
            random.standard_normal(np.shape(wall.first)) * wall.first,
            None if wall.growth is None else 0.1 * random.standard_normal(np.shape(wall.growth)),
        )
        for side, wall in walls.items()
    }

    def cells(t: float) -> np.ndarray:
        there = {
            side: replace(
                wall,
                first=wall.first + t * change[side][0],
                growth=None if change[side][1] is None else wall.growth + t * change[side][1],
            )
            for side, wall in walls.items()
        }
        found = wall_cells(walls_by_side(there), place + t * moved, SHAPE)
        return np.stack((found.along_xi, found.along_eta, found.angle))

    expected = float((cotangent * difference(cells, 1e-3)).sum())
    in_walls, in_place = in_wall_cells(laws_of(walls_by_side(walls), place), place, *cotangent)
    found = float((in_place * moved).sum())
    for side, (first, growth) in change.items():
        one = getattr(in_walls, side)
        found += float((one.first * np.broadcast_to(first, one.first.shape)).sum())
        if growth is not None:
            found += float((one.growth * np.broadcast_to(growth, one.growth.shape)).sum())
    assert found == pytest.approx(expected, rel=1e-8)
