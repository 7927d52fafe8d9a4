"""Springs between the nodes of a sliding side: they space it as something else than the functional wants.

The energy is half the sum over the edges of a side of a weight times the square of the length. At its minimum alone the
weight times the length is the same for every edge between two nodes that stay: de Boor's equidistribution.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...arrays import Array
from .side import ALONG_XI, Index
from .slide import Slide

#: The first plane of the coupling with the next node along xi, and along eta, in the stored half of a Hessian.
NEXT = {True: 3, False: 7}


def _sprung(slide: Slide | None) -> Iterator[tuple[Index, Array, int]]:
    """Yield for every side with springs its nodes, their weights, and the first plane of the coupling along it."""
    for side in slide.sides if slide is not None else ():
        weights = side.springs
        if weights is not None:
            yield side.index, weights, NEXT[side.name in ALONG_XI]


def spring_energy(slide: Slide | None, coordinates: Array) -> float:
    """Return the energy of the springs in coordinates (2, ni, nj); zero without any."""
    total = 0.0
    for index, weights, _ in _sprung(slide):
        edges = np.diff(coordinates[:, *index], axis=1)
        total += 0.5 * float(np.einsum("k,ck,ck->", weights, edges, edges))
    return total


def add_spring_gradient(slide: Slide | None, coordinates: Array, gradient: Array) -> None:
    """Add the gradient of the springs to one in all nodes (2, ni, nj), in place."""
    for index, weights, _ in _sprung(slide):
        pull = weights * np.diff(coordinates[:, *index], axis=1)
        gradient[:, *(part[1:] for part in index)] += pull
        gradient[:, *(part[:-1] for part in index)] -= pull


def add_spring_hessian(slide: Slide | None, planes: Array) -> None:
    """Add the Hessian of the springs to the stored half of one in all nodes (19, ni, nj), in place."""
    for (i, j), weights, first in _sprung(slide):
        add_couplings(planes, (i[:-1], j[:-1]), (i[1:], j[1:]), weights, first)


def add_couplings(planes: Array, low: Index, high: Index, weights: Array, first: int) -> None:
    """Add the Hessians of springs between nodes and the next ones, whose coupling has this first plane, in place."""
    for entry in (0, 2):
        planes[entry, *low] += weights
        planes[entry, *high] += weights
    for entry in (first, first + 3):
        planes[entry, *low] -= weights
