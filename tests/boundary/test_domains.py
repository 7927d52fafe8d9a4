"""The classical domains."""

from __future__ import annotations

import numpy as np
import pytest

from gridgen_sym.boundary import domain, domain_description, domain_names
from gridgen_sym.errors import GridgenError
from gridgen_sym.grids import quality

# The areas of the curved regions, exactly.
AREAS = {
    "annulus": 3 * np.pi,
    "chevron": 1.0,
    "horseshoe": np.pi * (8 - 2) / 2,
    "horseshoe_map": np.pi * (2 * 9 - 1) / 2,
    "indented_square": 1 - 1 / np.pi,
    "naca": np.pi * 4 - 0.08221,  # Less the section, integrated by hand.
    "quarter_annulus": 0.75 * np.pi,
    "square": 1.0,
    "swan": 5 / 6,
    "wavy": 1.0,
    "zee": 1.4,
}
FOLDED_AT_40_CELLS = {"swan": 57, "zee": 800}


def test_every_domain_is_known_here():
    assert domain_names() == sorted(AREAS)


@pytest.mark.parametrize("name", sorted(AREAS))
def test_area_orientation_and_folds(name):
    report = quality(domain(name, 41, 41))
    assert report.mean_jacobian > 0
    assert report.folded_cells == FOLDED_AT_40_CELLS.get(name, 0)
    fine = quality(domain(name, 401, 41))
    assert fine.mean_jacobian * fine.cells == pytest.approx(AREAS[name], rel=3e-4)
    assert domain_description(name)


def test_formulas_at_chosen_points():
    swan = domain("swan", 5, 5).xy
    assert swan[2, -1] == pytest.approx([0.5, 0.25])
    assert swan[-1, 2] == pytest.approx([1.5, 0.5])
    chevron = domain("chevron", 5, 5).xy
    assert chevron[2, 0] == pytest.approx([0.5, -0.5])
    assert chevron[1, -1] == pytest.approx([0.25, 0.75])
    horseshoe = domain("horseshoe", 5, 5).xy
    assert horseshoe[2, 0] == pytest.approx([2, 0])
    assert horseshoe[2, -1] == pytest.approx([4, 0])
    assert horseshoe[0, 2] == pytest.approx([0, 1.5])
    wavy = domain("wavy", 5, 5).xy
    assert wavy[1, 0] == pytest.approx([0.25, 0.35])
    assert wavy[1, -1] == pytest.approx([0.25, 1 + 0.35 * np.cos(0.5)])
    assert domain("indented_square", 5, 5).xy[0, 2] == pytest.approx([0.5, 0.5])
    zee = domain("zee", 5, 9).xy
    assert zee[0, 2] == pytest.approx([0, 1])
    assert zee[-1, 6] == pytest.approx([1.6, 0.4])


@pytest.mark.parametrize("R", [2.0, 4.5])
def test_the_horseshoe_map_is_the_map(R):
    xi, eta = np.meshgrid(np.linspace(0, 1, 9), np.linspace(0, 1, 7), indexing="ij")
    grid = domain("horseshoe_map", 9, 7, R=R)
    assert grid.x == pytest.approx(-(1 + eta) * np.cos(np.pi * xi), abs=1e-14)
    assert grid.y == pytest.approx((1 + (2 * R - 1) * eta) * np.sin(np.pi * xi), abs=1e-13)


def test_the_naca_section():
    xy = domain("naca", 81, 5).xy
    assert xy[0, 0] == pytest.approx([1, 0], abs=1e-15)
    assert xy[40, 0] == pytest.approx([0, 0], abs=1e-15)
    assert xy[:, 0, 1].max() == pytest.approx(0.06, abs=5e-5)  # Half of 12 % of the chord.
    assert np.hypot(xy[:, -1, 0] - 0.5, xy[:, -1, 1]) == pytest.approx(2.0)
    assert xy[0] == pytest.approx(xy[-1], abs=1e-14)  # Both banks of the cut.


def test_an_unknown_name_tells_the_closest():
    with pytest.raises(GridgenError, match=r"'swam'.*did you mean 'swan'"):
        domain("swam", 5, 5)
    with pytest.raises(GridgenError, match="Known: annulus, chevron"):
        domain("???", 5, 5)


@pytest.mark.parametrize(("ni", "nj"), [(2, 5), (5, 2), (-3, 5), (5.0, 5), ("5", 5)])
def test_counts_must_be_whole_and_enough(ni, nj):
    with pytest.raises(GridgenError, match="at least 3"):
        domain("square", ni, nj)


def test_parameters_are_checked():
    with pytest.raises(GridgenError, match=r"'swan' has no parameter 'R'; it takes: none"):
        domain("swan", 5, 5, R=2.0)
    with pytest.raises(GridgenError, match="R of the domain 'horseshoe_map' must be finite"):
        domain("horseshoe_map", 5, 5, R=np.nan)
