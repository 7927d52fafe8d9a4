"""Values per node, per cell and per corner: each reaches the corner that it belongs to, on every backend."""

from __future__ import annotations

import numpy as np
import pytest
from support import kernel_set

import gridgen_sym as gg
from gridgen_sym.grids import corner_jacobians
from gridgen_sym.runtime import Values

SHAPE = (6, 70)
CELLS = (SHAPE[0] - 1, SHAPE[1] - 1)
RANDOM = np.random.default_rng(3)
PLANES = {
    "node": RANDOM.uniform(1, 2, SHAPE),
    "cell": RANDOM.uniform(1, 2, CELLS),
    "corner": RANDOM.uniform(1, 2, (4, *CELLS)),
}
each_place = pytest.mark.parametrize("plane", PLANES.values(), ids=PLANES)


def at_corners(plane):
    """The values at the corners (4, ni-1, nj-1), counter-clockwise, by indices alone."""
    if plane.shape == SHAPE:
        return np.stack([plane[:-1, :-1], plane[1:, :-1], plane[1:, 1:], plane[:-1, 1:]])
    return np.broadcast_to(plane, (4, *CELLS))


def coordinates():
    planes = gg.domain("wavy", *SHAPE).planes.copy()
    planes[:, 1:-1, 1:-1] += 1e-3 * RANDOM.uniform(-1, 1, (2, SHAPE[0] - 2, SHAPE[1] - 2))
    return planes


@each_place
def test_the_energy_is_the_sum_over_the_corners(plane, backend):
    place = coordinates()
    energy, _ = kernel_set("area", "frozen", backend).energy(place, Values.of([plane], SHAPE))
    # The corner energy of `area` is s J².
    expected = (at_corners(plane) * corner_jacobians(*place) ** 2).sum()
    assert energy == pytest.approx(expected, rel=1e-13)


@each_place
def test_gradient_and_sweep_see_the_values_of_their_corners(plane, backend):
    place, values, kernels = coordinates(), Values.of([plane], SHAPE), kernel_set("area_winslow", "frozen", backend)
    gradient, step = kernels.energy_gradient(place, values)[2], 1e-6
    fixed = np.ones(SHAPE, dtype=np.uint8)
    for i, j in ((1, 1), (3, 65), (4, 2)):
        for c in range(2):
            energies = []
            for sign in (1, -1):
                moved = place.copy()
                moved[c, i, j] += sign * step
                energies.append(kernels.energy(moved, values)[0])
            difference = (energies[0] - energies[1]) / (2 * step)
            assert gradient[c, i, j] == pytest.approx(difference, rel=1e-6, abs=1e-6 * abs(gradient).max())
        # A sweep over this node alone, again and again, ends where its own gradient vanishes.
        swept, alone = place.copy(), fixed.copy()
        alone[i, j] = 0
        for _ in range(30):
            kernels.sweep(swept, values, alone, i % 2 + 2 * (j % 2), floor=0.0)
        after = kernels.energy_gradient(swept, values)[2]
        assert np.abs(after[:, i, j]).max() < 1e-6 * max(np.abs(gradient[:, i, j]).max(), 1e-3)


def test_values_at_nodes_are_not_copied_and_others_are_means():
    node = Values.of([PLANES["node"]], SHAPE)
    assert np.shares_memory(node.nodes[0], PLANES["node"])
    assert np.shares_memory(node.corners[0][3], PLANES["node"])
    assert node.at_nodes() is node
    corner = Values.of([PLANES["corner"]], SHAPE).at_nodes()
    near, far = PLANES["corner"][0], PLANES["corner"][2]
    assert corner.nodes[0][0, 0] == near[0, 0]
    assert corner.nodes[0][-1, -1] == far[-1, -1]
    right, left = PLANES["corner"][1], PLANES["corner"][3]
    mean = (near[1, 1] + far[0, 0] + right[0, 1] + left[1, 0]) / 4
    assert corner.nodes[0][1, 1] == pytest.approx(mean, rel=1e-15)
    np.testing.assert_array_equal(corner.corners[0][0], corner.nodes[0][:-1, :-1])


@pytest.mark.parametrize("shape", [(70, 6), (3, *CELLS), (6,), (5, 70)])
def test_a_plane_of_another_shape_is_refused(shape):
    with pytest.raises(gg.GridgenError, match=r"one per cell, shape \(5, 69\), or one per corner"):
        Values.of([np.ones(shape)], SHAPE)
