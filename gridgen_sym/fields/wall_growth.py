"""Growth that the cells at a wall cannot keep: numbers that programs can read, and a sentence."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..arrays import Array
from ..boundary.laws import geometric
from ..boundary.sides import Sides
from ..boundary.wall import Wall
from .wall_fractions import both_grow

#: Cells that cover this part of the distance to the opposite side grow nearly as they should.
_COVERED = 0.99
#: Cells that would reach farther than this count as that far: powers overflow.
_FAR = 1e300


@dataclass(frozen=True, slots=True)
class WallRemark:
    """What the cells at a wall cannot be, at the node where they are farthest from it.

    Attributes:
        side: of the wall.
        kind: `short`: cells that grow so do not reach the opposite side; `long`: even cells of the first height reach
            beyond it; `unused`: the opposite side is a wall, too, and lines follow the law of both first heights.
        covered: how far cells that grow so would reach, over the distance to the opposite side.
        reaching: the factor that would just reach it; below 1 where first cells are too high for growth.
        text: the same as a sentence.
    """

    side: str
    kind: Literal["short", "long", "unused"]
    covered: float
    reaching: float
    text: str

    def __str__(self) -> str:
        """Return the sentence."""
        return self.text


def wall_remarks(walls: Sides[Wall | None], coordinates: Array) -> tuple[WallRemark, ...]:
    """Return what is to be said of the growth of walls; nothing where cells keep it.

    Args:
        walls: of the four sides.
        coordinates: (2, ni, nj), of which the boundary is used.
    """
    turned = coordinates.transpose(0, 2, 1)
    seen = Sides(coordinates, turned[:, :, ::-1], coordinates[:, :, ::-1], turned)
    opposite = Sides(walls.top, walls.left, walls.bottom, walls.right)
    found = []
    for side, wall, other, planes in zip(Sides._fields, walls, opposite, seen, strict=True):
        if wall is not None and wall.growth is not None and not (other and both_grow(wall, other, planes)):
            found.append(_remark(side, wall, planes, alone=other is None))
    return tuple(remark for remark in found if remark is not None)


def _remark(side: str, wall: Wall, seen: Array, *, alone: bool) -> WallRemark | None:
    """Return what is to be said of a wall; the last axis of `seen` (2, n, m) runs inwards from it."""
    count, cells = seen.shape[1], seen.shape[2] - 1
    index, first = wall.along(wall.first, count, "first")
    growth = wall.along(wall.growth, count, "growth")[1]
    first = first / np.hypot(*(seen[:, index, -1] - seen[:, index, 0]))
    with np.errstate(over="ignore"):
        covered = np.minimum((first[:, None] * growth[:, None] ** np.arange(cells)).sum(axis=1), _FAR)
    long = alone and bool(first.max() * cells > 1 / _COVERED)
    k = int(first.argmax() if long else covered.argmin())
    if alone and not long and covered[k] >= _COVERED:
        return None
    step = np.diff(geometric(first[k : k + 1], cells)[0])
    reaching = float(step[1] / step[0])
    if not alone:
        kind: Literal["short", "long", "unused"] = "unused"
        told = f"Lines from {side} follow the law of both first heights, in which its growth has no part."
    elif long:
        kind = "long"
        told = (
            f"{cells} cells of the first height at {side} are {first[k] * cells:.3g} times the distance to the "
            "opposite side, so they are even. Without a growth they would have that height, and shrink."
        )
    else:
        kind = "short"
        own = np.diff(wall.fractions(np.ones(1), first[k : k + 1], growth[k : k + 1], cells)[0])
        stretched = own[0] > first[k] / _COVERED
        what = "all are stretched" if stretched else f"farther out they grow by {own[-1] / own[-2]:.3g}"
        told = (
            f"{cells} cells that grow by {growth[k]:.4g} at {side} cover {covered[k]:.2g} of the distance to the "
            f"opposite side: {what}. A growth of {reaching:.3g} would reach it."
        )
    return WallRemark(side, kind, float(covered[k]), reaching, told)
