"""Functionals of the literature at a solve: those with a barrier make valid grids, those with a target reach it."""

from __future__ import annotations

import numpy as np
import pytest

import gridgen_sym as gg

pytestmark = pytest.mark.slow

#: One of each family with a barrier: a metric of a target, one of its components, a monitor, a material.
WITH_BARRIER = {
    "tmop_80": {},
    "tmop_98": {},
    "dvinsky": {"fields": {"M": ("1 + x**2", "0.2*x", "1 + 0.5*y**2")}},
    "garanzha": {},
}


@pytest.mark.slow
@pytest.mark.parametrize("name", WITH_BARRIER)
@pytest.mark.parametrize("domain", ["swan", "annulus"])
def test_a_barrier_makes_a_valid_grid(name, domain):
    result = gg.optimize(gg.domain(domain, 25, 21), name, progress=False, backend="numpy", **WITH_BARRIER[name])
    assert result.converged, result
    assert result.quality.folded_cells == 0


#: Zero for the target and for nothing else with the same boundary.
SLOW = [pytest.param(name, marks=pytest.mark.slow) for name in ("tmop_7", "tmop_98", "garanzha")]


@pytest.mark.parametrize("name", ["tmop_14", *SLOW])
def test_the_minimum_is_the_reference_grid(name):
    start = gg.domain("quarter_annulus", 13, 11)
    random = np.random.default_rng(3)
    xy = start.xy.copy()
    xy[1:-1, 1:-1] += 0.02 * random.normal(size=xy[1:-1, 1:-1].shape)
    reference = gg.Grid(xy)
    assert gg.quality(reference).folded_cells == 0
    result = gg.optimize(start, name, target=gg.Target.of(reference), progress=False, backend="numpy")
    assert result.converged, result
    assert np.abs(result.grid.xy - reference.xy).max() < 1e-9


def test_components_and_invariants_of_a_target_are_those_of_t():
    """At half the target's size T is I/2, whichever way a metric is written."""
    grid = gg.domain("square", 5, 5)
    names = ("tmop_14", "tmop_55", "tmop_1")
    fit, area, length = (gg.energy(grid, name, target=gg.Target(0.5, 0.5), backend="numpy") for name in names)
    assert fit / length == pytest.approx(2 * (1 / 2 - 1) ** 2 / (2 / 4))
    assert area / length == pytest.approx((1 / 4 - 1) ** 2 / (2 / 4))
