"""What solving has made worse is measured, and told in one sentence, only then."""

import numpy as np
import pytest

import gridgen_sym as gg
from gridgen_sym.boundary.laws import geometric
from gridgen_sym.grids.change import Measures


def clustered(first=1e-3, ni=21, nj=21):
    """The unit square with nodes clustered to its bottom."""
    x, y = np.meshgrid(np.linspace(0, 1, ni), geometric(np.array([first]), nj - 1)[0], indexing="ij")
    return gg.Grid.from_planes(x, y)


@pytest.mark.parametrize("name", ["swan", "chevron", "horseshoe", "wavy"])
def test_the_measures_are_those_of_quality(name):
    grid = gg.domain(name, 70, 9)
    quality, found = gg.quality(grid), Measures.of(grid)
    assert found.min_scaled_jacobian == pytest.approx(quality.min_scaled_jacobian, abs=1e-14)
    assert found.max_area_ratio == pytest.approx(quality.max_area_ratio)
    assert found.mean_non_orthogonality == pytest.approx(quality.non_orthogonality.mean, abs=1e-6)
    for side, first in found.first_heights.items():
        assert first == pytest.approx(quality.sides[side].first_heights[1])
    assert found.valid == quality.valid


def test_edges_of_no_length_are_no_accident():
    xy = clustered().xy
    xy[3, 0] = xy[4, 0]
    found = Measures.of(gg.Grid(xy))
    assert found.min_scaled_jacobian == 0
    assert not found.valid
    assert np.isfinite(found.mean_non_orthogonality)


def test_lost_first_heights_and_what_keeps_them_are_told():
    start = clustered()
    xy = start.xy
    xy[1:-1, 1:-1, 1] = np.linspace(0, 1, 21)[None, 1:-1]
    change = gg.Change(Measures.of(start), Measures.of(gg.Grid(xy)))
    assert 'the first heights at bottom from 0.001 to 0.05 (walls={"bottom": Wall(first=...)} keeps them)' in (
        change.warning
    )
    asked = gg.Change(change.before, change.after, sizes_asked=True)
    assert "first heights" not in asked.warning
    assert "area ratio" not in asked.warning


def test_walls_are_compared_with_what_they_ask_for():
    asked = {"bottom": np.full(21, 1e-3)}
    asked["bottom"][:5] = np.nan
    found = [Measures.of(clustered(first), asked) for first in (1e-3, 1.5e-3, 4e-3)]
    assert [m.wall_factors["bottom"] for m in found] == pytest.approx([1, 1.5, 4])
    assert gg.Change(found[0], found[0]).warning == ""
    assert gg.Change(found[0], found[1]).worse == ()
    assert gg.Change(found[0], found[1]).warning == (
        "First heights differ from those asked for by a factor of 1.5 at bottom."
    )
    told = "the factor between the first heights at bottom and those asked for from 1 to 4"
    assert told in gg.Change(found[0], found[2]).warning
    assert gg.Change(found[2], found[0]).warning == ""


def test_a_solver_tells_what_is_worse_and_is_quiet_otherwise():
    start = gg.domain("quarter_annulus", 21, 21)
    worse = gg.optimize(start, "length")
    assert worse.change.after.max_area_ratio == pytest.approx(worse.quality.max_area_ratio)
    assert worse.message.endswith(worse.change.warning)
    assert worse.change.warning.startswith(
        "Worse than the start: the largest area ratio of neighbors from 1.05 to 3.33"
    )
    better = gg.optimize(start, "winslow")
    assert better.change.worse == ()
    assert "Worse than" not in better.message
    back = gg.optimize(worse.grid, "winslow")
    assert back.change.before == worse.change.after
    assert "Worse than" not in back.message
    equations = gg.solve_euler_lagrange(start, "length")
    assert equations.change.warning
    assert equations.message.endswith(equations.change.warning)


def test_a_folded_start_is_compared_with_nothing():
    xy = gg.domain("quarter_annulus", 9, 9).xy
    xy[4, 4] = xy[6, 6]
    result = gg.optimize(gg.Grid(xy), "winslow")
    assert not result.change.before.valid
    assert result.change.warning == ""


@pytest.mark.slow
def test_continuation_compares_with_its_own_start():
    start = gg.domain("quarter_annulus", 13, 13)
    result = gg.continuation(start, "quasi_harmonic", "omega", [1.0, 0.1])
    assert result.change.before == Measures.of(start)
    assert result.change.after == Measures.of(result.grid)


def test_adaptation_is_asked_to_change_sizes():
    result = gg.adapt(gg.domain("square", 17, 17), lambda x, y: np.tanh(30 * (x - 0.5)), max_iterations=2)
    assert result.change.after.max_area_ratio > 2 * result.change.before.max_area_ratio or result.change.worse == ()
    assert "area ratio" not in result.message
