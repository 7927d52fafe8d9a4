"""Extend values at the sides of a grid into it, by Laplace's equation in the indices."""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..runtime import threads_for

#: The sides of a grid (2, ni, nj): the first and the last i, the first and the last j.
SIDES = np.s_[:, 0], np.s_[:, -1], np.s_[:, :, 0], np.s_[:, :, -1]

#: Up to this many nodes a transform is a product with its matrix: loading scipy.fft takes longer than a small grid.
_SMALL = 128


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
    waves = [np.pi * np.arange(1, count + 1) / (count + 1) for count in (first_j.shape[1], first_i.shape[1])]
    sine_i, sine_j = (2 * np.sin(wave) for wave in waves)
    odd_i, odd_j = (np.resize([1.0, -1.0], len(wave)) for wave in waves)
    along_j, along_i = ((_transform(first), _transform(last)) for first, last in ((first_i, last_i), (first_j, last_j)))
    spectrum = sine_i[:, None] * along_j[0][:, None] + (odd_i * sine_i)[:, None] * along_j[1][:, None]
    spectrum += along_i[0][:, :, None] * sine_j + along_i[1][:, :, None] * (odd_j * sine_j)
    spectrum /= (4 - 2 * np.cos(waves[0]))[:, None] - 2 * np.cos(waves[1])
    return _back(spectrum)


def _transform(values: Array) -> Array:
    """Return the sine transform (DST-I) along the last axis."""
    if values.shape[-1] <= _SMALL:
        return np.asarray(values @ _sines(values.shape[-1]))
    from scipy.fft import dst

    return np.asarray(dst(values, type=1))


def _back(spectrum: Array) -> Array:
    """Return the inverse sine transform along the last two axes; the spectrum is overwritten."""
    _, rows, columns = spectrum.shape
    if max(rows, columns) <= _SMALL:
        return np.asarray(_sines(rows) @ spectrum @ _sines(columns) / (4 * (rows + 1) * (columns + 1)))
    from scipy.fft import idstn

    return np.asarray(idstn(spectrum, type=1, axes=(1, 2), overwrite_x=True, workers=threads_for(spectrum.size)))


def _sines(count: int) -> Array:
    """Return the matrix of the sine transform, which is symmetric."""
    number = np.arange(1, count + 1)
    # The angle is taken modulo a turn before it is rounded.
    return np.asarray(2 * np.sin(np.pi * (np.outer(number, number) % (2 * (count + 1))) / (count + 1)))
