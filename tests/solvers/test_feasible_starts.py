"""Folds that stay in every other way: nodes around them start in the middle of their feasible regions."""

from __future__ import annotations

import numpy as np
import pytest
from support_boundaries import flat_polygon, grid_of_ring, smooth_curve
from support_solvers import BARRIER, edges

import gridgen_sym as gg
from gridgen_sym.certificates.branching import DEFAULT_BUDGET
from gridgen_sym.functionals.registry import functional
from gridgen_sym.grids import corner_jacobians
from gridgen_sym.solvers.binding import make_problem
from gridgen_sym.solvers.run.deadline import Deadline, StopRequest
from gridgen_sym.solvers.run.progress import Progress
from gridgen_sym.solvers.untangling.affine_maps import stretched_maps
from gridgen_sym.solvers.untangling.feasible_starts import FeasibleStarts, feasible_starts
from gridgen_sym.solvers.untangling.strategies import begin_search


def band(seed, ni, nj, thickness):
    """The transfinite grid of a random band."""
    return grid_of_ring(flat_polygon(seed, 2 * (ni + nj) - 4, thickness), ni, nj)


def neck():
    """A boundary of which no grid is valid, with room for all cells but two."""
    return grid_of_ring(smooth_curve(3211, 12, 0.6), 5, 3)


#: Seed, shape and thickness of bands that minima of a regularized barrier do not lead to a valid grid of.
BANDS = [(20111, 6, 7, 3e-2), (20304, 8, 7, 3e-2), (907, 8, 5, 1e-2), (732, 9, 8, 1e-2)]


@pytest.mark.slow
@pytest.mark.parametrize("name", BARRIER)
def test_a_band_is_gridded(name):
    start = band(*BANDS[1])
    result = gg.untangle(start, name)
    assert result.converged, result.message
    assert np.array_equal(edges(result.grid.xy), edges(start.xy))


def unfold(start, fixed=None, stop_at=None):
    """Return the coordinates that `FeasibleStarts` makes of a grid, and whether it says that they are valid."""
    place, problem = start.planes.copy(), make_problem(start, "winslow", fixed=fixed)

    def stop(step):
        nonlocal stop_at
        stop_at = stop_at and stop_at - 1
        if stop_at == 0:
            raise StopIteration

    with Progress("unfold", stop, show=False) as report:
        search = begin_search(problem, functional("winslow"), place, None, report)
        try:
            return place, search.run_into(place, [FeasibleStarts(DEFAULT_BUDGET)])
        except StopRequest:
            return place, False


@pytest.mark.slow
@pytest.mark.parametrize("number", range(len(BANDS)))
def test_transfinite_grids_of_bands_become_valid(number):
    place, valid = unfold(band(*BANDS[number]))
    assert valid
    assert corner_jacobians(*place).min() > 0


@pytest.mark.slow
def test_bands_at_any_size_place_and_angle_become_valid():
    turn = np.array([[np.cos(1.0), np.sin(1.0)], [-np.sin(1.0), np.cos(1.0)]])
    start = band(*BANDS[1]).xy
    for moved in (1e-9 * start, start @ turn + 1e3):
        assert unfold(gg.Grid(moved))[1]


@pytest.mark.slow
def test_a_fold_in_a_large_grid_is_unfolded_by_the_nodes_round_it():
    xy = gg.domain("square", 41, 41).xy
    xy[20, 20] += 0.11, 0.07
    place, valid = unfold(gg.Grid(xy))
    assert valid
    assert corner_jacobians(*place).min() > 0
    moved = np.argwhere((place != gg.Grid(xy).planes).any(axis=0))
    assert len(moved) > 1
    assert (abs(moved - 20) <= 4).all()


def test_all_starts_leave_fixed_nodes_where_they_are():
    grid = band(*BANDS[1])
    window, free = grid.planes.copy(), np.zeros(grid.shape, dtype=bool)
    free[1:-1, 1:-1] = True
    free[3, 3] = False
    window[:, 3, 3] += 1e-3
    window[:, free] = np.random.default_rng(0).normal(size=(2, free.sum()))
    *middles, even = feasible_starts(window, free, Deadline(), 1000)
    assert len(middles) > 1
    for start in (*middles, even):
        assert np.array_equal(start[:, ~free], window[:, ~free])
    assert np.array_equal(even[:, free], grid.planes[:, free])
    low, high = grid.planes.min(axis=(1, 2)), grid.planes.max(axis=(1, 2))
    for start in middles:
        assert (start[:, free].min(axis=1) > low).all()
        assert (start[:, free].max(axis=1) < high).all()


@pytest.mark.slow
def test_there_is_a_start_for_every_share_that_is_not_excluded():
    """Of the square none of five is, of a band the largest three; of a boundary without a valid grid all are."""

    def count(grid):
        free = np.zeros(grid.shape, dtype=bool)
        free[1:-1, 1:-1] = True
        return len(list(feasible_starts(grid.planes, free, Deadline(), 4000)))

    assert count(gg.domain("square", 6, 6)) == 5 + 1
    assert count(grid_of_ring(flat_polygon(1055, 24, 1e-2), 6, 8)) == 2 + 1
    assert count(neck()) == 0


def test_fixed_inner_nodes_stay():
    start, fixed = band(*BANDS[1]), np.zeros((8, 7), dtype=bool)
    xy, fixed[2:5, 2:5] = start.xy, True
    xy[fixed] = unfold(start)[0][:, fixed].T
    place, valid = unfold(gg.Grid(xy), fixed)
    assert valid
    assert np.array_equal(place[:, fixed].T, xy[fixed])


def test_a_window_with_a_side_without_length_stays_as_it_is():
    """Below the free nodes fixed ones are one point: all cells there are folded, whatever is done."""
    xy, fixed = gg.domain("square", 12, 12).xy, np.ones((12, 12), dtype=bool)
    fixed[6:9, 4:8] = False
    xy[5, 2:10] = xy[5, 5]
    start = gg.Grid(xy)
    place, valid = unfold(start, fixed)
    assert not valid
    assert gg.quality(gg.Grid.from_planes(*place)).folded_cells <= gg.quality(start).folded_cells


def test_nothing_gets_worse_where_no_grid_is_valid():
    least = gg.untangle(neck()).grid
    place, valid = unfold(least)
    assert not valid
    assert gg.quality(gg.Grid.from_planes(*place)).folded_cells <= gg.quality(least).folded_cells


@pytest.mark.parametrize("steps", [1, 2, 6])
def test_whoever_stops_it_has_the_least_folded_grid_so_far(steps):
    start = band(*BANDS[1])
    place, valid = unfold(start, stop_at=steps)
    assert not valid
    assert np.isfinite(place).all()
    assert gg.quality(gg.Grid.from_planes(*place)).folded_cells <= gg.quality(start).folded_cells


def test_frames_are_affine_maps_of_all_shapes_that_keep_areas():
    start = band(*BANDS[0])
    frames = list(stretched_maps(start.planes))
    boundary = start.planes.copy()
    spreads = []
    for frame in frames:
        there = frame.apply(boundary)
        assert corner_jacobians(*there) == pytest.approx(corner_jacobians(*boundary), rel=1e-6, abs=1e-12)
        assert frame.invert(there, np.zeros_like(there), np.zeros(start.shape)) == pytest.approx(boundary, abs=1e-12)
        sides = np.concatenate((there[:, :, 0], there[:, :, -1], there[:, 0], there[:, -1]), axis=1)
        spreads.append(np.linalg.eigvalsh(np.cov(sides)))
    ratios = [np.sqrt(largest / smallest) for smallest, largest in spreads]
    assert ratios[0] == pytest.approx(1.0)
    assert ratios[1:] == pytest.approx([3.0] * 4 + [10.0] * 4)
    assert len({frame.matrix.round(6).tobytes() for frame in frames}) == len(frames)


def test_a_line_has_no_frames():
    x, y = np.meshgrid(np.arange(4.0), np.arange(3.0), indexing="ij")
    assert list(stretched_maps(np.stack((x + y, np.zeros_like(x))))) == []
