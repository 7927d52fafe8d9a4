"""Prolongation of grids with walls: nodes are interpolated in the fractions of the walls' laws, not in the index.

Along a line the nodes are spaced by a law that is known on every grid, and the line's shape is smooth in the fraction
of its length: so a finer grid has the heights that were asked for at once.
"""

from __future__ import annotations

import numpy as np

from ...arrays import Array
from ...fields.wall_cells import WallCells
from .prolongation import resample


def finer_grid(coarse: Array, coarse_cells: WallCells, boundary: Array, cells: WallCells) -> Array:
    """Return a start on a finer grid.

    Args:
        coarse: (2, ni, nj), solved on a coarser grid.
        coarse_cells: what walls ask for there.
        boundary: (2, ni, nj) of the finer grid, of which the boundary is used.
        cells: what walls ask for on the finer grid.
    """
    _, ni, nj = boundary.shape
    found = _along_eta(coarse, coarse_cells.eta, cells.eta, nj)
    turned = _along_eta(
        found.transpose(0, 2, 1),
        None if coarse_cells.xi is None else resampled_rows(coarse_cells.xi.T, nj),
        None if cells.xi is None else cells.xi.T,
        ni,
    )
    found = turned.transpose(0, 2, 1).copy()
    # What the finer side adds to a curve is carried along the lines that meet it, where these are dense; at other sides
    # it stays: nodes are spaced otherwise there, and carried along the walls that would fold the thin cells.
    if cells.eta is not None:
        low, high = boundary[:, :, :1] - found[:, :, :1], boundary[:, :, -1:] - found[:, :, -1:]
        found += low * (1 - cells.eta) + high * cells.eta
    if cells.xi is not None:
        left, right = boundary[:, :1] - found[:, :1], boundary[:, -1:] - found[:, -1:]
        found += left * (1 - cells.xi) + right * cells.xi
    for side in (np.s_[:, 0], np.s_[:, -1], np.s_[:, :, 0], np.s_[:, :, -1]):
        found[side] = boundary[side]
    return found


def _along_eta(field: Array, coarse: Array | None, fine: Array | None, count: int) -> Array:
    """Interpolate lines along the last axis to so many nodes: in their fractions, or where there are none by index."""
    if coarse is None or fine is None:
        return resample(field, (field.shape[1], count), linear=False)
    lines = resampled_rows(fine, field.shape[1])
    found = np.empty((2, field.shape[1], count))
    for row in range(field.shape[1]):
        for component in range(2):
            found[component, row] = np.interp(lines[row], coarse[row], field[component, row])
    return found


def resampled_rows(fractions: Array, count: int) -> Array:
    """Return fractions (ni, nj) on another number of lines."""
    if len(fractions) == count:
        return fractions
    both: Array = resample(np.stack((fractions, fractions)), (count, fractions.shape[1]), linear=True)
    return np.asarray(both[0])
