"""The points of Arakawa's C-grid: rho in cells, u and v on their edges, psi at the nodes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array

#: The kinds of points, as ROMS calls them.
KINDS = ("rho", "u", "v", "psi")


@dataclass(frozen=True, slots=True)
class Staggered:
    """Points of a grid with ni x nj nodes; one layer of cells lies outside, as ROMS has it.

    Attributes:
        rho: centers of cells, (ni+1, nj+1, 2); the outer ones lie outside.
        u: middles of the edges along eta, (ni, nj+1, 2).
        v: middles of the edges along xi, (ni+1, nj, 2).
        psi: the nodes, (ni, nj, 2).
        u_all: as `u`, with one more on either side, (ni+2, nj+1, 2): those around all rho points.
        v_all: as `v`, with one more on either side, (ni+1, nj+2, 2).
    """

    rho: Array
    u: Array
    v: Array
    psi: Array
    u_all: Array
    v_all: Array


def staggered(nodes: Array) -> Staggered:
    """Return the points of a grid's nodes (ni, nj, 2), continued by one layer of equal cells on all sides."""
    wide = _continued(_continued(nodes, 0), 1)
    u = (wide[:, 1:] + wide[:, :-1]) / 2
    v = (wide[1:] + wide[:-1]) / 2
    return Staggered((u[1:] + u[:-1]) / 2, u[1:-1], v[:, 1:-1], nodes, u, v)


def _continued(nodes: Array, axis: int) -> Array:
    """Return nodes with one more at either end of an axis, as far from the last one as that from the one before."""
    along = np.moveaxis(nodes, axis, 0)
    wide = np.concatenate(((2 * along[0] - along[1])[None], along, (2 * along[-1] - along[-2])[None]))
    return np.moveaxis(wide, 0, axis)


def masks(sea: Array) -> dict[str, Array]:
    """Return the masks of all points, 1 at sea, from that of the rho points: an edge or a node needs sea all around."""
    u, v = sea[1:] * sea[:-1], sea[:, 1:] * sea[:, :-1]
    return {"rho": sea, "u": u, "v": v, "psi": u[:, 1:] * u[:, :-1]}
