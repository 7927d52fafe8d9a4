"""Kernels on several blocks in one call give what they give on each, bit by bit, with any number of threads."""

from __future__ import annotations

import numpy as np
import pytest

import gridgen_sym as gg
from gridgen_sym.runtime import BlockKernels, Values, find_compiler, kernels, threads

SHAPES = [(4, 7), (4, 7), (33, 9), (5, 5)]
STEPS = [(0.5, 0.25), (0.5, 0.25), (1.0, 1.0), (0.1, 2.0)]
BACKENDS = ["numpy", *(["c"] if find_compiler() else [])]


@pytest.mark.parametrize("weighted", [False, True], ids=["plain", "weighted"])
@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("count", ["1", "3", "8"])
def test_blocks_are_as_each_of_them(backend, count, weighted, monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", count)
    monkeypatch.setattr(threads, "_NODES_PER_THREAD", 16)
    own = kernels(gg.functional("area_winslow"), "frozen" if weighted else "plain", backend=backend)
    places = [gg.domain("wavy", *shape).planes for shape in SHAPES]
    values = [Values.of([1 + place[0] ** 2], place.shape[1:]) if weighted else None for place in places]
    joined = np.concatenate([place.ravel() for place in places])
    each = list(zip(places, values, STEPS, strict=True))
    blocks = BlockKernels(own, SHAPES, STEPS)
    found = [own.energy_gradient(*given) for given in each]
    gradient = np.empty_like(joined)
    energy, smallest = blocks.energy_gradient(joined, values, gradient)
    assert energy == pytest.approx(sum(one[0] for one in found), rel=1e-15)
    assert smallest == min(one[1] for one in found)
    assert np.array_equal(gradient, np.concatenate([one[2].ravel() for one in found]))
    assert blocks.energy(joined, values) == pytest.approx((energy, smallest), rel=1e-15)
    rows = np.concatenate([own.smallest_jacobians(place) for place in places])
    assert np.array_equal(blocks.smallest_jacobians(joined), rows)
    for semidefinite in (False, True):
        expected = [own.hessian(*given, semidefinite=semidefinite) for given in each]
        planes = blocks.hessian(joined, values, semidefinite=semidefinite, out=None)
        assert blocks.hessian(joined, values, semidefinite=semidefinite, out=planes) is planes
        assert all(np.array_equal(a, b) for a, b in zip(planes, expected, strict=True))


def test_values_of_another_shape_are_refused():
    own = kernels(gg.functional("area_winslow"), "frozen", backend=BACKENDS[-1])
    wrong = [Values.of([np.ones((4, 6))], (4, 6))]
    with pytest.raises(gg.GridgenError, match="must have the shape"):
        BlockKernels(own, SHAPES[:1], STEPS[:1]).energy(gg.domain("wavy", *SHAPES[0]).planes.ravel(), wrong)
