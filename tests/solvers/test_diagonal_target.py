"""Targets of given edge lengths: what kernels make of them, and how folds are measured."""

from __future__ import annotations

import numpy as np
import pytest
from support import random_grid

import gridgen_sym as gg
from gridgen_sym.certificates.expected_jacobians import expected_edges
from gridgen_sym.functionals import functional
from gridgen_sym.grids import corner_jacobians
from gridgen_sym.resources import resource_folder
from gridgen_sym.solvers.binding import make_problem
from gridgen_sym.solvers.untangling.diagonal_target import DiagonalTarget
from gridgen_sym.solvers.untangling.expected_spacing import FUNCTIONAL
from gridgen_sym.solvers.untangling.regularization import regularized

SHAPE, EPSILON = (6, 5), 0.3


@pytest.fixture
def lengths():
    return np.random.default_rng(3).uniform(0.5, 2.0, (2, 4, SHAPE[0] - 1, SHAPE[1] - 1))


def squared_edges(xy):
    """The squared lengths of the edges along xi, and along eta, at every corner, in the order of `corner_jacobians`."""
    along_xi, along_eta = ((np.diff(xy, axis=axis) ** 2).sum(axis=0) for axis in (1, 2))
    near, far = along_eta[:-1], along_eta[1:]
    low, high = along_xi[:, :-1], along_xi[:, 1:]
    return np.stack([low, low, high, high]), np.stack([near, far, far, near])


@pytest.mark.parametrize("backend", ["numpy", None])
def test_every_corner_has_its_own_target(lengths, backend):
    """Against the bare formula: |T|²/chi(det T), with T the edges over their lengths."""
    xy = random_grid(*SHAPE, noise=0.4)
    problem = make_problem(gg.Grid.from_planes(*xy), FUNCTIONAL, backend=backend)
    regular = regularized(problem, functional(FUNCTIONAL), None, EPSILON, DiagonalTarget.of_edges(*lengths))
    norm = sum(edges / length**2 for edges, length in zip(squared_edges(xy), lengths, strict=True))
    determinant = corner_jacobians(*xy) / lengths.prod(axis=0)
    assert determinant.min() < 0
    chi = (determinant + np.hypot(determinant, EPSILON)) / 2
    assert regular.energy(xy)[0] == pytest.approx((norm / chi).sum(), rel=1e-12)


def test_relative_to_the_expected_lengths_all_corners_of_an_uneven_rectangle_are_the_same():
    x, y = np.meshgrid([0, 1e-3, 0.5, 0.6, 3], [0, 0.1, 0.7, 0.8], indexing="ij")
    target = DiagonalTarget.of_edges(*expected_edges(gg.Grid.from_planes(x, y)))
    relative = corner_jacobians(x, y) * target.determinants
    assert np.ptp(relative) < 1e-12 * relative.max()
    assert target.mean_jacobian(np.stack((x, y))) == pytest.approx(relative[0, 0, 0])


def test_folds_are_measured_relative_to_the_target_and_counted_if_they_can_be_mended(lengths):
    xy = random_grid(*SHAPE, noise=0.4)
    xy[:, 0, 0] = 3.0  # The deepest fold is at a corner of three fixed nodes.
    target, fixed = DiagonalTarget.of_edges(*lengths), make_problem(gg.Grid.from_planes(*xy), FUNCTIONAL).fixed
    jacobians = corner_jacobians(*xy)
    assert jacobians[0, 0, 0] < 0
    jacobians[0, 0, 0], jacobians[1, -1, 0], jacobians[2, -1, -1], jacobians[3, 0, -1] = 1e3, 1e3, 1e3, 1e3
    folds = target.folds(xy, fixed)
    assert folds.cells == (jacobians <= 0).any(axis=0).sum() > 0
    assert folds.depth == pytest.approx(-(jacobians / lengths.prod(axis=0)).min())


def test_the_kernels_that_untangling_follows_are_committed():
    assert (resource_folder("generated") / "facts" / f"{FUNCTIONAL}_target_regularized.json").exists()
