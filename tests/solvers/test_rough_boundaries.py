"""Boundaries of strongly deformed grids that are known to be valid: from the boundary alone a valid grid is found."""

from __future__ import annotations

import time

import numpy as np
import pytest

import gridgen_sym as gg
from gridgen_sym.functionals import functional
from gridgen_sym.grids import corner_jacobians
from gridgen_sym.solvers.binding import make_problem
from gridgen_sym.solvers.run.progress import Progress
from gridgen_sym.solvers.untangling.all_nodes import AllNodes
from gridgen_sym.solvers.untangling.expected_spacing import ExpectedSpacing, PowersOfSpacing
from gridgen_sym.solvers.untangling.strategies import begin_search

#: Nodes, and the scaled Jacobian that no corner falls below.
SHAPE, QUALITY = (11, 15), 0.01


def good_cells(xy):
    """Whether all scaled Jacobians of each cell exceed the limit; (2, ni, nj) to (ni - 1, nj - 1)."""
    along_i, along_j = (np.hypot(*np.diff(xy, axis=axis)) for axis in (1, 2))
    near, far = along_i[:, :-1], along_i[:, 1:]
    sizes = np.stack([near * along_j[:-1], near * along_j[1:], far * along_j[1:], far * along_j[:-1]])
    return (corner_jacobians(*xy) > QUALITY * sizes).all(axis=0)


def base(kind, random):
    """A square or a part of a ring, with even or uneven spacing."""
    u, v = (np.linspace(0, 1, count) for count in SHAPE)
    if kind in (1, 3):
        u, v = (np.cumsum(np.r_[0, np.exp(random.normal(0, 1.2, count - 1))]) for count in SHAPE)
    s, t = np.meshgrid(u / u[-1], v / v[-1], indexing="ij")
    xy = np.stack((s, t * random.choice([1, 0.1, 5])))
    if kind >= 2:
        angle = random.uniform(0.5, 1.9) * np.pi
        radius = 1 + t * random.uniform(0.3, 3)
        xy = np.stack((radius * np.cos(-angle * s), radius * np.sin(-angle * s)))
    return xy


def longest_edges(xy):
    """The longest edge at each node, (ni, nj)."""
    edges = np.zeros(SHAPE)
    along_i, along_j = (np.hypot(*np.diff(xy, axis=axis)) for axis in (1, 2))
    edges[:-1] = np.maximum(edges[:-1], along_i)
    edges[1:] = np.maximum(edges[1:], along_i)
    edges[:, :-1] = np.maximum(edges[:, :-1], along_j)
    edges[:, 1:] = np.maximum(edges[:, 1:], along_j)
    return edges


def move_at_random(xy, left, size, random):
    """Move the nodes that are left by normally distributed steps, as far as all cells stay good; return which moved."""
    move = random.standard_normal(xy.shape) * size * left
    for _ in range(8):
        bad = ~good_cells(xy + move)
        if not bad.any():
            break
        nodes = np.zeros(SHAPE, dtype=bool)
        for i, j in ((0, 0), (1, 0), (0, 1), (1, 1)):
            nodes[i : i + SHAPE[0] - 1, j : j + SHAPE[1] - 1] |= bad
        move[:, nodes] = 0
    if not good_cells(xy + move).all():
        move[...] = 0
    xy += move
    return (move != 0).any(axis=0)


def deformed(seed):
    """A valid grid (2, ni, nj) whose nodes, those of the boundary too, have been moved at random, sweep after sweep.

    None if the undeformed grid is not good enough.
    """
    random = np.random.default_rng(seed)
    xy = base(seed % 4, random)
    if not good_cells(xy).all():
        return None
    reach, longest = random.choice([1.0, 3.0]), np.ptp(xy) * random.choice([0.5, 1, 2]) / 12
    for _ in range(int(random.choice([5, 30, 150]))):
        for first_i in range(2):
            for first_j in range(2):
                left = np.zeros(SHAPE, dtype=bool)
                left[first_i::2, first_j::2] = True
                edges = np.minimum(longest_edges(xy), longest)
                for halvings in range(6):
                    left &= ~move_at_random(xy, left, edges * reach / 2**halvings, random)
    return xy


def seconds_to_valid(seed):
    """Return the processor time in which a valid grid is found from the boundary alone.

    It is infinite if none is found, and None if there is no grid of this seed.
    """
    known = deformed(seed)
    if known is None:
        return None
    assert gg.quality(gg.Grid.from_planes(*known)).valid
    xy = known.transpose(1, 2, 0)
    start, begin = gg.transfinite(xy[:, 0], xy[:, -1], xy[0], xy[-1]), time.process_time()
    result = gg.untangle(start, time_limit=60)
    return time.process_time() - begin if result.quality.valid else np.inf


def search_of(seed):
    """Return a search that begins at the transfinite grid of a rough boundary."""
    xy = deformed(seed).transpose(1, 2, 0)
    start = gg.transfinite(xy[:, 0], xy[:, -1], xy[0], xy[-1])
    problem = make_problem(start, "winslow")
    return begin_search(problem, functional("winslow"), start.planes, None, Progress("rough", show=False))


@pytest.mark.slow
@pytest.mark.parametrize(("strategy", "seed"), [(ExpectedSpacing(), 74), (PowersOfSpacing(16, 165), 14)])
def test_relative_to_the_expected_spacing_all_cells_unfold_together(strategy, seed):
    """One epsilon for all cells leaves folds of these."""
    search = search_of(seed)
    search.run([AllNodes()])
    assert not search.valid
    folds = search.best.folds
    search.run([PowersOfSpacing(16, 164)])
    assert search.best.folds == folds
    search.run([strategy])
    assert search.valid
    assert search.untangled_by == strategy.name


def test_where_boundary_nodes_coincide_nothing_is_expected():
    planes = gg.domain("square", 5, 5).planes.copy()
    planes[:, 1, 0] = planes[:, 2, 0]
    problem = make_problem(gg.Grid.from_planes(*planes), "winslow")
    search = begin_search(problem, functional("winslow"), planes, None, Progress("square", show=False))
    search.run([ExpectedSpacing(), PowersOfSpacing(2, 25)])
    assert not search.progress.history


@pytest.mark.slow
@pytest.mark.parametrize("seed", [74, 82, 1087])
def test_a_rough_boundary_gets_its_grid(seed):
    """Of these the barrier of winslow leaves a fold."""
    assert seconds_to_valid(seed) < 5


@pytest.mark.slow
def test_rough_boundaries_get_their_grids_nearly_all_at_once():
    seconds = [found for seed in range(20) if (found := seconds_to_valid(seed)) is not None]
    assert len(seconds) > 11
    assert np.quantile(seconds, 0.9) < 2
    assert max(seconds) < 20
