"""Random boundaries for property-based tests: smooth curves, polygons, near-degenerate ones, at any scale and place."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

import gridgen_sym as gg

SIZES = st.tuples(st.integers(3, 9), st.integers(3, 9))
#: As many points as the boundaries of these grids have.
COUNTS = SIZES.map(lambda size: 2 * sum(size) - 4)
#: (scale, shift): from 1e-9 to 1e9, and moved by up to a million times the size.
PLACES = st.tuples(st.sampled_from([1e-9, 1e-3, 1.0, 1e3, 1e9]), st.sampled_from([0.0, 1.0, 1e3, 1e6]))
SEEDS = st.integers(0, 2**32 - 1)


def smooth_curve(seed, count, wiggle):
    """A closed curve (count, 2) of a circle and a few random waves: it may cross itself for a large `wiggle`."""
    random = np.random.default_rng(seed)
    angle = 2 * np.pi * np.arange(count) / count
    points = np.stack((np.cos(angle), np.sin(angle)), axis=-1)
    for wave in range(2, 6):
        phase = 2 * np.pi * random.random(2)
        size = wiggle * random.standard_normal(2) / wave
        points = points + size * np.cos(wave * angle[:, None] + phase)
    return points


def star_polygon(seed, count, flatness):
    """A star-shaped polygon (count, 2), which never crosses itself; its radii fall to `flatness`."""
    random = np.random.default_rng(seed)
    step = 0.2 + random.random(count)
    angle = 2 * np.pi * np.cumsum(step) / step.sum()
    radius = flatness + (1 - flatness) * random.random(count)
    return radius[:, None] * np.stack((np.cos(angle), np.sin(angle)), axis=-1)


def flat_polygon(seed, count, thickness):
    """A band of random thickness around a random line: nearly without area."""
    random = np.random.default_rng(seed)
    half = count // 2
    x = np.sort(random.random(half))
    middle = 0.3 * random.random() * x**2
    below = np.stack((x, middle), axis=-1)
    above = np.stack((x, middle + thickness * (0.1 + random.random(half))), axis=-1)
    return np.concatenate((below, above[::-1]))


def grid_of_ring(ring, ni, nj):
    """The transfinite grid whose boundary nodes are 2 (ni + nj) - 4 points, counter-clockwise from corner (0, 0)."""
    closed = np.concatenate((ring, ring[:1]))
    a, b, c = ni - 1, ni + nj - 2, 2 * ni + nj - 3
    return gg.transfinite(closed[: a + 1], closed[b : c + 1][::-1], closed[c:][::-1], closed[a : b + 1])


@st.composite
def closed_curves(draw, counts=COUNTS):
    """Any of the curves, of a number of points from `counts`, at any scale and place."""
    count, seed = draw(counts), draw(SEEDS)
    make = draw(
        st.sampled_from(
            [
                lambda: smooth_curve(seed, count, 0.1),
                lambda: smooth_curve(seed, count, 0.6),
                lambda: star_polygon(seed, count, 0.3),
                lambda: star_polygon(seed, count, 1e-6),
                lambda: flat_polygon(seed, count, 1e-2),
                lambda: flat_polygon(seed, count, 1e-12),
            ]
        )
    )
    scale, shift = draw(PLACES)
    return scale * (make() + shift)


@st.composite
def boundary_grids(draw):
    """Transfinite grids of random boundaries; many of these have no valid grid."""
    ni, nj = draw(SIZES)
    return grid_of_ring(draw(closed_curves(st.just(2 * (ni + nj) - 4))), ni, nj)


@st.composite
def valid_grids(draw):
    """Random valid grids: squares, rings or waves whose nodes are moved as far as no cell folds, at any scale."""
    ni, nj = draw(SIZES)
    random = np.random.default_rng(draw(SEEDS))
    s, t = np.meshgrid(np.linspace(0, 1, ni), np.linspace(0, 1, nj), indexing="ij")
    around = draw(st.sampled_from([0.0, 0.5, 1.7, 2.5]))  # Times pi: the last is a spiral that overlaps itself.
    x, y = (s, t) if around == 0 else ((1 + t) * np.cos(-around * np.pi * s), (1 + t) * np.sin(-around * np.pi * s))
    start = np.stack((x, y), axis=-1)
    moves = random.standard_normal(start.shape)
    scale, shift = draw(PLACES)
    step = 0.5
    while True:
        grid = gg.Grid(scale * (start + step * moves + shift))
        if gg.quality(grid).valid:
            return grid
        if step < 1e-9:
            return gg.Grid(scale * (np.stack((s, t), axis=-1) + shift))  # Too few cells for the ring.
        step /= 2
