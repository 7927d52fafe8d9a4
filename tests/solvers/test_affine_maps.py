"""Affine maps: which a search uses, what they do to a boundary, and that the inverse is exact."""

from __future__ import annotations

import numpy as np
import pytest

from gridgen_sym.solvers.untangling.affine_maps import balanced_maps, stretched_maps


def rectangle(length, height, angle=0.4, size=(9, 6)):
    """A turned rectangle (2, ni, nj) away from the origin, with inner nodes anywhere."""
    s, t = np.meshgrid(np.linspace(0, length, size[0]), np.linspace(0, height, size[1]), indexing="ij")
    s[1:-1, 1:-1] = np.random.default_rng(0).normal(0.0, 100.0, s[1:-1, 1:-1].shape)
    c, d = np.cos(angle), np.sin(angle)
    return np.stack((c * s - d * t + 7.0, d * s + c * t - 3.0))


def boundary(place):
    return np.concatenate((place[:, :, 0], place[:, :, -1], place[:, 0], place[:, -1]), axis=1)


def extents(place):
    """How far a boundary extends along its axes, least first."""
    return np.sqrt(np.linalg.eigvalsh(np.cov(boundary(place))))


def test_the_first_frame_changes_nothing():
    place = rectangle(1.0, 1.0)
    (only,) = balanced_maps(place)
    there = only.apply(place)
    assert np.array_equal(there, place)
    assert not np.shares_memory(there, place)
    assert only.invert(there, place, np.ones(place.shape[1:])) is there


@pytest.mark.parametrize(("ratio", "count"), [(1.0, 1), (1.45, 1), (1.55, 2), (50.0, 2), (1e6, 2)])
def test_only_a_thin_boundary_is_stretched(ratio, count):
    """Until it is as wide as it is long; its length stays."""
    even = rectangle(1.0, 1.0, angle=0.0)
    even = np.tensordot(np.diag(1 / np.sqrt(np.diag(np.cov(boundary(even))))), even, axes=1)
    turn = np.array([[0.8, -0.6], [0.6, 0.8]])
    place = np.tensordot(turn @ np.diag([1.0, 1 / ratio]), even, axes=1) + 5.0
    found = list(balanced_maps(place))
    assert len(found) == count
    if count == 2:
        there = found[1].apply(place)
        assert extents(there) == pytest.approx([1.0, 1.0], rel=1e-3 if ratio > 1e5 else 1e-9)
        assert boundary(there).mean(axis=1) == pytest.approx([0.0, 0.0], abs=1e-9)


def test_a_line_and_a_point_are_not_stretched():
    line = np.stack(np.broadcast_arrays(np.linspace(0, 1, 5)[:, None], np.zeros((1, 4)))).astype(float)
    for place in (line, np.zeros((2, 4, 4))):
        assert len(list(balanced_maps(place))) == 1
        assert list(stretched_maps(place)) == []


@pytest.mark.parametrize("kind", [balanced_maps, stretched_maps])
def test_the_way_back_is_exact_at_fixed_nodes(kind):
    place, fixed = rectangle(9.0, 1.0), np.ones((9, 6), dtype=np.uint8)
    fixed[1:-1, 1:-1] = 0
    fixed[3, 2] = 1
    for frame in list(kind(place))[1:]:
        there = frame.apply(place)
        there[:, 4, 3] += 0.5
        back = frame.invert(there, place, fixed)
        assert np.array_equal(back[:, fixed != 0], place[:, fixed != 0])
        free = fixed == 0
        free[4, 3] = False
        assert back[:, free] == pytest.approx(place[:, free], rel=1e-10)
        moved = frame.matrix @ (back[:, 4, 3] - place[:, 4, 3])
        assert moved == pytest.approx([0.5, 0.5])
