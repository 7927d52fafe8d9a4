"""Walls: how the cells at a side of a block should be, its first heights and how they grow."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
import numpy.typing as npt

from ..arrays import Array, real_array
from ..errors import GridgenError, quoted
from ..grids import Grid
from .laws import geometric, growing, hyperbolic_sine, hyperbolic_tangent
from .sides import Sides

Law = Literal["geometric", "tanh", "sinh"]
#: Heights have this many rounding errors of the coordinates at least.
_REPRESENTED = 16.0
_LAWS = {"geometric": geometric, "tanh": hyperbolic_tangent, "sinh": hyperbolic_sine}


@dataclass(frozen=True, slots=True, eq=False)
class Wall:
    """What is asked of the cells at a wall, a side of a block.

    Attributes:
        first: height of the first cell: a number, or an array with one value per node of the side (or per node of
            `nodes`).
        growth: factor from one height to the next, a number or such an array. Without one the heights follow `law`, as
            far as the opposite side.
        law: `geometric`, `tanh` or `sinh`; see `boundary.laws`. Where the opposite side is a wall, too, heights follow
            Vinokur's law of two ends, whatever is said here, unless both have a growth.
        layers: how many cells grow by `growth` where all that do so do not reach the opposite side; by default half.
        share: the same as a share of the cells between 0 and 1.
        orthogonal: whether cells at the wall, and above it, should have right angles; else they keep those that
            transfinite interpolation gives them.
        nodes: the first node of the side that belongs to the wall, and the one after the last; by default the whole
            side is a wall. Beside it first heights pass over smoothly to those at the ends of the side.
    """

    first: Any
    growth: Any = None
    law: Law = "geometric"
    layers: int | None = None
    share: float | None = None
    orthogonal: bool = True
    nodes: tuple[int, int] | None = None

    def __post_init__(self) -> None:
        """Check what can be checked without a grid."""
        first = real_array(self.first, "first of the wall")
        if not (np.isfinite(first).all() and (first > 0).all()):
            raise GridgenError(f"first of the wall must be a positive height; came {quoted(self.first)}")
        if self.growth is not None:
            growth = real_array(self.growth, "growth of the wall")
            if not (np.isfinite(growth).all() and (growth > 0).all()):
                raise GridgenError(
                    f"growth of the wall must be a positive factor, such as 1.2; came {quoted(self.growth)}"
                )
            if (growth < 1).any():
                raise GridgenError(
                    "growth of the wall must be 1 or more, since cells that shrink do not reach the opposite side; "
                    f"came {quoted(self.growth)}. Without a growth cells grow, or shrink, as far as that side"
                )
        if self.law not in get_args(Law):
            raise GridgenError(
                f"the law of the wall must be one of {', '.join(get_args(Law))}; came {quoted(self.law)}"
            )
        if self.layers is not None and self.share is not None:
            raise GridgenError("layers and share of the wall say the same thing: give one of them")
        if (self.layers is not None or self.share is not None) and self.growth is None:
            raise GridgenError(
                "layers and share of the wall belong to a growth: give growth, such as 1.2, or drop them"
            )
        if self.share is not None and not (_is_number(self.share) and 0 < self.share <= 1):
            raise GridgenError(f"share of the wall must be between 0 and 1; came {quoted(self.share)}")
        if self.layers is not None and not (_is_whole(self.layers) and self.layers >= 0):
            raise GridgenError(f"layers of the wall must be a whole number of cells; came {quoted(self.layers)}")
        pair = isinstance(self.nodes, (tuple, list)) and len(self.nodes) == 2 and all(map(_is_whole, self.nodes))
        if self.nodes is not None and not pair:
            raise GridgenError(f"nodes of the wall must be two numbers of nodes; came {quoted(self.nodes)}")

    def kept_layers(self, cells: int) -> int | None:
        """Return how many cells grow by `growth` at least, of so many; None for the default."""
        return self.layers if self.share is None else max(1, round(self.share * cells))

    def fractions(self, length: Array, first: Array, growth: Array | None, cells: int) -> Array:
        """Return the fractions of lines of a length (m,) at their nodes, (m, cells + 1), for one wall."""
        if growth is not None:
            return growing(first / length, growth, cells, self.kept_layers(cells))
        return _LAWS[self.law](first / length, cells)

    def along(self, values: npt.ArrayLike, count: int, name: str) -> tuple[npt.NDArray[np.intp], Array]:
        """Return the indices of the wall's nodes on a side of `count` nodes, and values at these."""
        begin, end = (0, count) if self.nodes is None else self.nodes
        if not (0 <= begin < end <= count):
            raise GridgenError(
                f"nodes of the wall must be two numbers of nodes with 0 <= first < last <= {count}; came {self.nodes}"
            )
        index = np.arange(begin, end, dtype=np.intp)
        given = real_array(values, f"{name} of the wall")
        if given.shape == (count,):
            given = given[begin:end]
        if given.shape not in ((), index.shape):
            raise GridgenError(
                f"{name} of the wall must be a number or have one value per node, shape ({len(index)},); "
                f"came {given.shape}"
            )
        return index, np.broadcast_to(given, index.shape)


def _is_number(value: object) -> bool:
    return isinstance(value, (int, float, np.number)) and not isinstance(value, bool)


def _is_whole(value: object) -> bool:
    return isinstance(value, (int, np.integer)) and not isinstance(value, bool)


#: Nothing is asked of any side.
NO_WALLS: Sides[Wall | None] = Sides(None, None, None, None)


def walls_by_side(walls: object) -> Sides[Wall | None]:
    """Return the walls of all sides.

    Args:
        walls: a mapping from `bottom`, `right`, `top` and `left` to `Wall`.

    Raises:
        GridgenError: for another side, or what is no `Wall`.
    """
    if not isinstance(walls, Mapping):
        raise GridgenError(f"walls must map sides to walls, such as {{'bottom': Wall(1e-5)}}; came {quoted(walls)}")
    for side, wall in walls.items():
        if side not in Sides._fields:
            raise GridgenError(f"unknown side {quoted(side)} in walls: the sides are {', '.join(Sides._fields)}")
        if not isinstance(wall, Wall):
            raise GridgenError(f"the wall of the side {side} must be a Wall, such as Wall(1e-5); came {quoted(wall)}")
    return Sides(*(walls.get(side) for side in Sides._fields))


def asked_heights(walls: Sides[Wall | None], shape: tuple[int, int]) -> dict[str, Array]:
    """Return the first heights that walls ask for, by side: one per node of the side, NaN where none is asked for."""
    asked = {}
    for side, wall, count in zip(Sides._fields, walls, (*shape, *shape), strict=True):
        if wall is not None:
            asked[side] = np.full(count, np.nan)
            index, first = wall.along(wall.first, count, "first")
            asked[side][index] = first
    return asked


def check_heights(walls: Sides[Wall | None], grid: Grid) -> None:
    """Raise a `GridgenError` where first heights are below the rounding errors of a grid's coordinates."""
    least = _REPRESENTED * float(np.finfo(float).eps) * float(np.abs(grid.planes).max())
    for side, wall in zip(Sides._fields, walls, strict=True):
        if wall is not None and float(np.min(wall.first)) < least:
            raise GridgenError(
                f"first of the wall at {side} is {float(np.min(wall.first)):.3g}, but coordinates of this size are "
                f"rounded: take at least {least:.2g}, or move the grid to the origin"
            )


def first_height(reynolds: float, yplus: float = 1.0, length: float = 1.0) -> float:
    """Return the height of a first cell that is to have a given y+ in a turbulent boundary layer.

    From the local skin friction of a smooth flat plate, c_f = 0.027/Re^(1/7), and u_tau = U sqrt(c_f/2):
    first = y+ length/(Re sqrt(c_f/2)) (F. M. White, Fluid Mechanics, flat plate, turbulent). It is an estimate for
    the downstream end of a body; near a stagnation point y+ is another.

    Args:
        reynolds: Reynolds number of the length.
        yplus: distance from the wall in wall units.
        length: of the body, in the unit of the grid.

    Raises:
        GridgenError: for numbers that are not positive.
    """
    for name, value in (("reynolds", reynolds), ("yplus", yplus), ("length", length)):
        if not (np.isscalar(value) and np.isreal(value) and 0 < float(value) < np.inf):  # type: ignore[arg-type]
            raise GridgenError(f"{name} must be a positive number; came {quoted(value)}")
    friction = 0.027 / float(reynolds) ** (1 / 7)
    return float(yplus) * float(length) / (float(reynolds) * float(np.sqrt(friction / 2)))
