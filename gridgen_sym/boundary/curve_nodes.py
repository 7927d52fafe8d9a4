"""Nodes on curves, placed by arc length: at equal lengths, or by a spacing law."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..arrays import Array
from .curves import Side
from .sampling import sample
from .side_spacing import fractions_of, spaced

#: Makes the nodes (cells + 1, 2) of a curve, from its first end to its last.
Nodes = Callable[[int], Array]
#: Samples of a curve that its arc length is measured with.
_SAMPLES = 2001


def straight(start: Array, end: Array, spacing: str | None = None) -> Nodes:
    """Return the nodes of a straight line; see `nodes_on`."""

    def nodes(cells: int) -> Array:
        length = float(np.hypot(*(end - start)))
        at = np.linspace(0, 1, cells + 1) if spacing is None else fractions_of(spacing, length, cells + 1)
        return (1 - at)[:, None] * start + at[:, None] * end

    return nodes


def nodes_on(shape: Side, spacing: str | None = None) -> Nodes:
    """Return the nodes of a curve; they lie on it, whatever their number.

    Args:
        shape: a function of a parameter from 0 to 1.
        spacing: a law as of `spaced`; equal lengths without one.
    """
    parameter = np.linspace(0, 1, _SAMPLES)
    length = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(shape(parameter), axis=0).T))))

    def nodes(cells: int) -> Array:
        at = fractions_of("equal" if spacing is None else spacing, float(length[-1]), cells + 1)
        return shape(np.interp(at * length[-1], length, parameter))

    return nodes


def nodes_on_polyline(line: Array, spacing: str | None = None) -> Nodes:
    """Return the nodes of a polyline (n, 2); without a law its sharp turns are nodes where they can be."""

    def nodes(cells: int) -> Array:
        return sample(line, cells + 1, "features") if spacing is None else spaced(line, cells + 1, spacing)

    return nodes
