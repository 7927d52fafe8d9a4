"""The order of the sides: bottom, right, top, left, each as a grid's runs."""

from __future__ import annotations

import numpy as np
import pytest

from gridgen_sym.boundary import domain, domain_names
from gridgen_sym.boundary.sides import Sides, grid_of_sides, ring_of_sides, sides_of_ring
from gridgen_sym.grids import boundary_indices

SWAN = domain("swan", 6, 4)
SIDES = Sides(bottom=SWAN.xy[:, 0], right=SWAN.xy[-1], top=SWAN.xy[:, -1], left=SWAN.xy[0])


def test_the_ring_is_that_of_the_boundary_indices():
    i, j = boundary_indices(6, 4).T
    assert np.array_equal(ring_of_sides(SIDES), SWAN.xy[i, j])


def test_a_ring_cut_in_four_gives_the_sides():
    ring = np.concatenate((ring_of_sides(SIDES), SWAN.xy[:1, 0]))
    found = sides_of_ring(ring[first : last + 1] for first, last in ((0, 5), (5, 8), (8, 13), (13, 16)))
    assert all(np.array_equal(one, other) for one, other in zip(found, SIDES, strict=True))


@pytest.mark.parametrize("name", domain_names())
def test_the_grid_of_a_grids_sides_has_these(name):
    given = domain(name, 7, 5)
    sides = Sides(given.xy[:, 0], given.xy[-1], given.xy[:, -1], given.xy[0])
    assert grid_of_sides(sides).xy == pytest.approx(given.xy, abs=1e-12)
