"""Parts of the sides of blocks, and connections between them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..boundary.sides import Sides
from ..errors import GridgenError, quoted
from ..grids import Grid

#: What a user may say of a part: a block and a side, by name or number, and the first and the last node along the side.
PartLike = Sequence[object]


@dataclass(frozen=True, slots=True, order=True)
class SidePart:
    """Consecutive nodes of a side of a block.

    Attributes:
        block: the number of the block.
        side: `bottom`, `right`, `top` or `left`.
        first, last: of the nodes along the side, both included; these are counted along increasing xi or eta.
    """

    block: int
    side: str
    first: int
    last: int

    @property
    def count(self) -> int:
        """The number of nodes."""
        return self.last - self.first + 1

    @property
    def axis(self) -> int:
        """The axis that the side runs along: 0 for xi, 1 for eta."""
        return 0 if self.side in ("bottom", "top") else 1

    @property
    def counterclockwise(self) -> bool:
        """Whether a block lies on the left of someone who walks along its side."""
        return self.side in ("bottom", "right")

    def indices(self, shape: tuple[int, int]) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]:
        """Return the indices i and j of the nodes in a block of a shape (ni, nj)."""
        along = np.arange(self.first, self.last + 1, dtype=np.intp)
        across = 0 if self.side in ("bottom", "left") else shape[1 - self.axis] - 1
        at = np.full_like(along, across)
        return (along, at) if self.axis == 0 else (at, along)

    def nodes(self, blocks: Sequence[Grid]) -> Array:
        """Return the positions of the nodes, (count, 2)."""
        grid = blocks[self.block]
        i, j = self.indices(grid.shape)
        return np.ascontiguousarray(grid.planes[:, i, j].T)

    def described(self, names: Sequence[str]) -> str:
        """Return the part in words for a message."""
        return f"{self.side} of block {names[self.block]}, nodes {self.first} to {self.last}"


@dataclass(frozen=True, slots=True)
class Motion:
    """A rotation about the origin, then a translation: how a copy of a node lies to another.

    Attributes:
        angle: in degrees, counter-clockwise.
        shift: the translation.
    """

    angle: float = 0.0
    shift: tuple[float, float] = (0.0, 0.0)

    @property
    def matrix(self) -> Array:
        """The rotation, (2, 2)."""
        turn = np.radians(self.angle)
        return np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])

    def apply(self, points: Array) -> Array:
        """Return moved points (n, 2)."""
        if self.angle == 0:
            return np.asarray(points + np.array(self.shift))
        return np.asarray(points @ self.matrix.T + np.array(self.shift))


IDENTITY = Motion()


class Connection:
    """Two parts of sides whose nodes are the same, up to a translation and a rotation.

    Attributes:
        one, other: the parts as they were given: a block (name or number), a side, and a pair of the first and the last
            node along it, or the whole side where no pair is given.
        translation: of the nodes of `other` relative to those of `one`, for periodic layouts such as cascades.
        rotation: in degrees about `center`, before the translation, for sectors.
        center: of the rotation.
    """

    __slots__ = ("motion", "one", "other")

    def __init__(
        self,
        one: PartLike,
        other: PartLike,
        *,
        translation: tuple[float, float] = (0.0, 0.0),
        rotation: float = 0.0,
        center: tuple[float, float] = (0.0, 0.0),
    ) -> None:
        """Connect; see `Connection`.

        Raises:
            GridgenError: for parts that are no sequences, and a translation, rotation or center that are no finite
                numbers.
        """
        for part in (one, other):
            if isinstance(part, str) or not isinstance(part, Sequence):
                raise GridgenError(f"a connected part is a block and a side, such as ('a', 'top'); came {quoted(part)}")
        try:
            numbers = np.array([*translation, rotation, *center], dtype=float)
        except (TypeError, ValueError):
            numbers = np.empty(0)
        if numbers.shape != (5,) or not np.isfinite(numbers).all():
            raise GridgenError(
                "translation and center are pairs of finite numbers, rotation is an angle in degrees; came "
                f"{quoted((translation, rotation, center))}"
            )
        self.one, self.other = tuple(one), tuple(other)
        middle = np.array(center, dtype=float)
        moved = middle - Motion(rotation).apply(middle[None])[0] + np.array(translation, dtype=float)
        self.motion = Motion(float(rotation), (float(moved[0]), float(moved[1])))

    def __repr__(self) -> str:
        """Return the parts."""
        return f"Connection({self.one!r}, {self.other!r})"


def side_part(given: PartLike, names: Mapping[str, int], shapes: Sequence[tuple[int, int]]) -> SidePart:
    """Return a part of a side from what a user says.

    Raises:
        GridgenError: for an unknown block or side, or nodes that the side does not have.
    """
    if isinstance(given, str) or not isinstance(given, Sequence) or len(given) not in (2, 3):
        raise GridgenError(
            "a part of a side is a block, a side and, where it is not the whole, the first and the last node, such as "
            f"('a', 'bottom', (0, 24)); came {quoted(given)}"
        )
    block, side = _block_number(given[0], names), given[1]
    if side not in Sides._fields:
        raise GridgenError(f"unknown side {quoted(side)}: the sides are {', '.join(Sides._fields)}")
    count = shapes[block][0 if side in ("bottom", "top") else 1]
    first, last = _range(given[2] if len(given) == 3 else (0, count - 1), count, f"{side} of block {quoted(given[0])}")
    return SidePart(block, str(side), first, last)


def _block_number(given: object, names: Mapping[str, int]) -> int:
    if isinstance(given, str) and given in names:
        return names[given]
    if isinstance(given, int | np.integer) and not isinstance(given, bool) and 0 <= given < len(names):
        return int(given)
    raise GridgenError(f"unknown block {quoted(given)}: the blocks are {', '.join(names)}, or 0 to {len(names) - 1}")


def _range(given: object, count: int, where: str) -> tuple[int, int]:
    pair = np.asarray(given).ravel()
    if pair.size != 2 or pair.dtype.kind not in "iu" or not 0 <= pair[0] < pair[1] < count:
        raise GridgenError(
            f"a part of {where} is given by its first and last node, 0 <= first < last <= {count - 1}; came "
            f"{quoted(given)}"
        )
    return int(pair[0]), int(pair[1])
