"""Extend values at the sides of a grid into it, by Laplace's equation in the indices."""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..runtime import threads_for

#: The sides of a grid (2, ni, nj): the first and the last i, the first and the last j.
SIDES = np.s_[:, 0], np.s_[:, -1], np.s_[:, :, 0], np.s_[:, :, -1]


def move_sides(coordinates: Array, boundary: Array) -> Array:
    """Return a grid (2, ni, nj) with its sides moved to those of `boundary`; inner nodes follow harmonically."""
    moved = coordinates.copy()
    sides = [boundary[side] - coordinates[side] for side in SIDES]
    moved[:, 1:-1, 1:-1] += harmonic_extension(*(side[:, 1:-1] for side in sides))
    for side in SIDES:
        moved[side] = boundary[side]  # Bit by bit.
    return moved


def harmonic_extension(first_i: Array, last_i: Array, first_j: Array, last_j: Array) -> Array:
    """Return the solution of Laplace's equation on the 5-point stencil, at the inner nodes, from values at the sides.

    By sine transforms, which diagonalize the stencil. The contribution of the sides needs one transform along each
    side only.
    """
    from scipy.fft import dst, idstn

    waves = [np.pi * np.arange(1, count + 1) / (count + 1) for count in (first_j.shape[1], first_i.shape[1])]
    sine_i, sine_j = (2 * np.sin(wave) for wave in waves)
    odd_i, odd_j = (np.resize([1.0, -1.0], len(wave)) for wave in waves)
    along_j, along_i = (
        (dst(first, type=1), dst(last, type=1)) for first, last in ((first_i, last_i), (first_j, last_j))
    )
    spectrum = sine_i[:, None] * along_j[0][:, None] + (odd_i * sine_i)[:, None] * along_j[1][:, None]
    spectrum += along_i[0][:, :, None] * sine_j + along_i[1][:, :, None] * (odd_j * sine_j)
    spectrum /= (4 - 2 * np.cos(waves[0]))[:, None] - 2 * np.cos(waves[1])
    return np.asarray(idstn(spectrum, type=1, axes=(1, 2), overwrite_x=True, workers=threads_for(spectrum.size)))
