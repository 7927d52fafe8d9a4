"""How far a grid is from orthogonal, and how its cells begin at each side: heights, growth, angles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from .grid import Grid

#: The sides of a block, in the order of the whole package.
SIDES = ("bottom", "right", "top", "left")


@dataclass(frozen=True, slots=True)
class Deviation:
    """Angles off 90 degrees.

    Attributes:
        mean: in degrees.
        percentile_95: 95 % of the angles are off by this or less.
        largest: the greatest one; 90 where an edge has no length.
    """

    mean: float
    percentile_95: float
    largest: float

    @classmethod
    def of(cls, degrees: Array) -> Deviation:
        """Return the measures of deviations in degrees."""
        return cls(float(degrees.mean()), float(np.percentile(degrees, 95)), float(degrees.max()))


@dataclass(frozen=True, slots=True)
class SideQuality:
    """How the cells at one side of a block begin, over the nodes between its corners.

    Attributes:
        side: `bottom`, `right`, `top` or `left`.
        first_heights: the least, the median and the greatest distance from a node of the side to the next one on its
            line.
        growth: the same of the second distance over the first.
        non_orthogonality: of the lines that meet the side, with its tangent.
    """

    side: str
    first_heights: tuple[float, float, float]
    growth: tuple[float, float, float]
    non_orthogonality: Deviation


def side_qualities(grid: Grid) -> dict[str, SideQuality]:
    """Return how the cells at each side begin, by the name of the side."""
    planes = grid.planes
    # From each side inwards along the last axis.
    inwards = (planes, planes[:, ::-1].transpose(0, 2, 1), planes[:, :, ::-1], planes.transpose(0, 2, 1))
    return {side: _side(side, lines) for side, lines in zip(SIDES, inwards, strict=True)}


def _side(side: str, lines: Array) -> SideQuality:
    step = np.diff(lines[:, 1:-1, :3], axis=2)
    first, second = np.hypot(*step[:, :, 0]), np.hypot(*step[:, :, 1])
    with np.errstate(all="ignore"):
        growth = np.where(first > 0, second / first, np.inf)
    tangent = lines[:, 2:, 0] - lines[:, :-2, 0]
    return SideQuality(side, _spread(first), _spread(growth), Deviation.of(_off(tangent, step[:, :, 0])))


def _spread(values: Array) -> tuple[float, float, float]:
    return float(values.min()), float(np.median(values)), float(values.max())


def _off(first: Array, second: Array) -> Array:
    """Return by how many degrees the angle of two fields of vectors (2, ...) is off 90; 90 where one has no length."""
    along = np.abs((first * second).sum(axis=0))
    across = np.abs(first[0] * second[1] - first[1] * second[0])
    return np.asarray(np.where(along + across > 0, np.degrees(np.arctan2(along, across)), 90.0))
