"""Folded starts whose boundary nodes slide, and the local method with sliding nodes."""

import numpy as np
import pytest

import gridgen_sym as gg
from gridgen_sym.solvers.binding import make_problem
from gridgen_sym.solvers.sliding.relaxation import relax_sliding

BEND = 1.5 * np.pi


def arc(radius):
    return lambda t: radius * np.stack([np.cos(BEND * (1 - np.asarray(t))), np.sin(BEND * (1 - np.asarray(t)))], -1)


def bend(ni, nj, power):
    """A bend by 270 degrees, with inner nodes crowded at its beginning and outer ones at its end."""
    u, v = np.linspace(0, 1, ni), np.linspace(0, 1, nj)[:, None]
    inner, outer = arc(1)(u**power), arc(2)(1 - (1 - u) ** power)
    left, right = (inner[end] + v * (outer[end] - inner[end]) for end in (0, -1))
    return gg.transfinite(bottom=inner, top=outer, left=left, right=right)


CURVES = {"bottom": arc(1), "top": arc(2)}


def quadrilateral(corners, n):
    u = np.linspace(0, 1, n)[:, None]
    ends = {"bottom": (0, 1), "top": (3, 2), "left": (0, 3), "right": (1, 2)}
    return gg.transfinite(**{side: corners[a] + u * (corners[b] - corners[a]) for side, (a, b) in ends.items()})


@pytest.mark.parametrize("backend", ["c", pytest.param("numpy", marks=pytest.mark.slow)])
def test_boundary_nodes_that_slide_make_a_valid_grid_possible(backend):
    start = bend(9, 3, 3)
    result = gg.untangle(start, slide=CURVES, backend=backend)
    assert result.converged
    assert result.quality.valid
    assert result.certificates == ()
    for j, radius in ((0, 1), (-1, 2)):
        x, y = result.grid.xy[:, j].T
        np.testing.assert_allclose(np.hypot(x, y), radius, atol=1e-12)
        # In their order, and between the corners.
        assert (np.diff(np.unwrap(np.arctan2(y, x))) < 0).all()
    np.testing.assert_array_equal(result.grid.xy[[0, -1]][:, [0, -1]], start.xy[[0, -1]][:, [0, -1]])


@pytest.mark.slow
def test_the_same_boundary_has_no_valid_grid_where_its_nodes_stay():
    start = bend(9, 3, 3)
    assert gg.untangle(start).status is gg.Status.IMPOSSIBLE
    assert gg.optimize(start, "winslow", slide=CURVES).quality.valid


def test_boundary_nodes_stay_where_that_is_enough():
    start = bend(17, 9, 3)
    result = gg.untangle(start, slide=CURVES)
    assert result.converged
    np.testing.assert_allclose(result.grid.xy[:, [0, -1]], start.xy[:, [0, -1]], atol=1e-12)


def test_a_valid_grid_is_returned_as_it_is():
    start = gg.domain("quarter_annulus", 9, 9)
    np.testing.assert_array_equal(gg.untangle(start, slide="all").grid.xy, start.xy)


@pytest.mark.slow
def test_what_no_sliding_mends_is_said_without_a_proof():
    reflex = np.array([[0.7, 0.7], [1, 0], [1, 1], [0, 1]])
    result = gg.untangle(quadrilateral(reflex, 5), slide="all")
    assert result.status is gg.Status.FOLDED
    assert result.certificates == ()
    assert "elsewhere on these curves is not known" in result.message


@pytest.mark.parametrize("backend", ["c", pytest.param("numpy", marks=pytest.mark.slow)])
def test_the_local_method_finds_the_same_grid(backend):
    start = quadrilateral(np.array([[0.0, 0], [1, 0], [1, 2], [0, 1]]), 5)
    newton, local = (
        gg.optimize(start, "winslow", method, slide="all", backend=backend, tolerance=1e-7)
        for method in ("newton", "local")
    )
    assert local.converged
    np.testing.assert_allclose(local.grid.xy, newton.grid.xy, atol=1e-5)


def test_the_local_method_keeps_valid_and_falls_in_every_sweep():
    result = gg.optimize(gg.domain("swan", 13, 11), "modified_liao", "local", slide="all", max_iterations=30)
    energies = [step.energy for step in result.history if step.stage == "minimize"]
    assert (np.diff(energies) < 0).all()
    assert result.quality.valid


def test_a_relaxation_lowers_the_energy_and_leaves_inner_nodes():
    start = gg.domain("quarter_annulus", 7, 5)
    problem = make_problem(start, "winslow", slide="all")
    moved = start.planes.copy()
    assert relax_sliding(problem, moved, floor=0.0) > 1e-3
    assert problem.energy(moved)[0] < problem.energy(start.planes)[0]
    np.testing.assert_array_equal(moved[:, 1:-1, 1:-1], start.planes[:, 1:-1, 1:-1])
    relaxed = moved.copy()
    for _ in range(50):
        longest = relax_sliding(problem, relaxed, floor=0.0)
    assert longest < 1e-7
    # Then the derivative along every curve is zero.
    assert np.abs(problem.energy_gradient(relaxed)[2][:, *problem.slide.nodes]).max() < 1e-6


def test_a_sum_without_the_corners_of_the_boundary_cannot_slide_node_by_node():
    with pytest.raises(gg.GridgenError, match="drop interior_only, or slide"):
        gg.optimize(bend(9, 5, 1), "winslow", "local", slide=CURVES, interior_only=True)
