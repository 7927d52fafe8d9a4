"""What a wall adds to the control functions, so that its first heights and right angles come out.

A. Hilgenstock, A fast method for the elliptic generation of three-dimensional grids with full boundary control, in
Numerical Grid Generation in Computational Fluid Mechanics '88 (1988), and J. A. White, Elliptic grid generation with
orthogonality and spacing control on an arbitrary number of boundaries, AIAA 90-1568 (1990): from one solution to the
next the control functions at a wall change by what its heights and angles are off, and less with the distance from it.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from ...arrays import Array, Mask
from ...boundary.sides import Sides
from ...boundary.wall import Wall
from ...fields.wall_cells import WallCells

#: Control across a wall falls by e in this part of the block; that along it, in this number of cells' lengths.
_DEPTH, _REACH = 0.3, 5.0
#: An error, the logarithm of a height's factor or an angle in radians, counts for no more than this.
_LARGEST_ERROR = 0.5
#: The first factor of an update, the least and the greatest one.
_FIRST_FACTOR, _LEAST_FACTOR, _GREATEST_FACTOR = 0.7, 0.2, 4.0
#: Angles pass from those of the block's corners to right ones within this number of cells' lengths.
_PASSAGE = 2.0


@dataclass(slots=True)
class Relaxed:
    """Values that are changed against errors until these vanish, by Aitken's factors.

    B. M. Irons and R. C. Tuck, A version of the Aitken accelerator for computer iteration, Int. J. Numer. Methods Eng.
    1 (1969) 275-277.

    Attributes:
        values: (m,), of the control function at the wall's nodes.
        gain: how much control makes up for an error of 1 in the model of straight lines.
        factor: of the next update.
        change: (m,), the next update.
    """

    values: Array
    gain: float
    factor: float = _FIRST_FACTOR
    change: Array = field(default_factory=lambda: np.zeros(0))
    _last: Array | None = None

    def aim(self, errors: Array, *, accelerate: bool) -> None:
        """Take errors (m,), and prepare the next update."""
        errors = np.clip(errors, -_LARGEST_ERROR, _LARGEST_ERROR)
        if accelerate and self._last is not None:
            difference = errors - self._last
            square = float(difference @ difference)
            if square > 0:
                factor = -self.factor * float(self._last @ difference) / square
                self.factor = float(np.clip(factor, _LEAST_FACTOR, _GREATEST_FACTOR))
        self._last, self.change = errors, -self.factor * self.gain * errors

    def at(self, part: float) -> Array:
        """Return the values after a part of the next update."""
        return np.asarray(self.values + part * self.change)

    def accept(self, part: float) -> None:
        """Take a part of the next update."""
        self.values = self.at(part)


@dataclass(slots=True)
class WallControls:
    """The control functions of one wall.

    Attributes:
        side: its name.
        index: (m,), its nodes on the side, without the ends of the side and those above which a node is fixed.
        first: (m,), the heights that are asked for.
        tilt: (m,), the angles off the normal that are asked for: those of the block's corners near these, else zero.
        tangents: (2, m), unit vectors along the side.
        across: (m, n), how control across the wall decays inwards.
        along: (m, n), how control along the wall does.
        heights: the control across it.
        angles: the control along it; None where the wall is not to be orthogonal.
    """

    side: str
    index: npt.NDArray[np.intp]
    first: Array
    tilt: Array
    tangents: Array
    across: Array
    along: Array
    heights: Relaxed
    angles: Relaxed | None

    @classmethod
    def of(
        cls, side: str, wall: Wall, coordinates: Array, cells: WallCells, steps: tuple[float, float], fixed: Mask
    ) -> WallControls:
        """Return the control functions of a wall, zero to begin with.

        Args:
            side: where it is.
            wall: what is asked for.
            coordinates: (2, ni, nj), of which the boundary is used.
            cells: what walls ask for there.
            steps: of the logical coordinates.
            fixed: (ni, nj), nodes that do not move.
        """
        seen = seen_from(side, coordinates)
        index, first = wall.along(wall.first, seen.shape[1], "first")
        free = seen_from(side, np.asarray(fixed))[index, 1] == 0
        index, first = index[free], first[free]
        chords = seen[:, 2:, 0] - seen[:, :-2, 0]
        spacing = np.hypot(*chords) / 2
        fractions = cells.eta if side in ("bottom", "top") else cells.xi
        assert fractions is not None
        behind = seen_from(side, fractions if side in ("bottom", "left") else 1 - fractions)[index]
        distance = behind * np.hypot(*(seen[:, index, -1] - seen[:, index, 0]))[:, None]
        step_along, step_across = steps if side in ("bottom", "top") else steps[::-1]
        cells_across = seen.shape[2] - 1
        zero = np.zeros(len(index))
        return cls(
            side=side,
            index=index,
            first=first,
            tilt=_tilt_asked(seen, spacing)[index],
            tangents=(chords / (2 * spacing))[:, index - 1],
            across=np.broadcast_to(np.exp(-np.linspace(0, 1, cells_across + 1) / _DEPTH), behind.shape),
            along=np.exp(-distance / (_REACH * spacing[index - 1])[:, None]),
            heights=Relaxed(zero, 1 / (_DEPTH * cells_across * step_across)),
            angles=Relaxed(zero, 1 / (_REACH * step_along)) if wall.orthogonal else None,
        )

    def errors(self, coordinates: Array) -> tuple[Array, Array]:
        """Return the logarithms of heights over those asked for, and the angles off those asked for in radians, (m,).

        An angle is positive where a line leans toward larger xi, or eta, as it leaves the wall.
        """
        seen = seen_from(self.side, coordinates)
        up = seen[:, self.index, 1] - seen[:, self.index, 0]
        height = np.hypot(*up)
        angle = np.arcsin(np.clip((up * self.tangents).sum(axis=0) / height, -1, 1))
        return np.log(height / self.first), (angle - self.tilt if self.angles else np.zeros_like(height))

    def aim(self, coordinates: Array, *, accelerate: bool) -> None:
        """Prepare the next update, against the errors of a grid."""
        height, angle = self.errors(coordinates)
        self.heights.aim(height, accelerate=accelerate)
        if self.angles:
            self.angles.aim(angle, accelerate=accelerate)

    def add_to(self, planes: Array, part: float) -> None:
        """Add these control functions, after a part of the next update, to P and Q (2, ni, nj), in place."""
        across, along = planes[::-1] if self.side in ("bottom", "top") else planes
        # Lines are drawn to the wall by control toward it: to smaller xi or eta at bottom and left.
        toward = 1.0 if self.side in ("bottom", "left") else -1.0
        seen_from(self.side, across)[self.index] += toward * self.heights.at(part)[:, None] * self.across
        if self.angles:
            seen_from(self.side, along)[self.index] += self.angles.at(part)[:, None] * self.along

    def accept(self, part: float) -> None:
        """Take a part of the next update."""
        self.heights.accept(part)
        if self.angles:
            self.angles.accept(part)


def wall_controls(
    walls: Sides[Wall | None], coordinates: Array, cells: WallCells, steps: tuple[float, float], fixed: Mask
) -> tuple[WallControls, ...]:
    """Return the control functions of all walls; see `WallControls.of`."""
    named = zip(Sides._fields, walls, strict=True)
    return tuple(WallControls.of(side, wall, coordinates, cells, steps, fixed) for side, wall in named if wall)


def seen_from(side: str, array: Array) -> Array:
    """Return a view of an array (..., ni, nj) whose last axes run along a side, and inwards from it."""
    if side in ("bottom", "top"):
        return array if side == "bottom" else array[..., ::-1]
    turned = np.swapaxes(array, -1, -2)
    return turned if side == "left" else turned[..., ::-1]


def _tilt_asked(seen: Array, spacing: Array) -> Array:
    """Return the angles off the normal that pass from those of a side's ends to zero, at its nodes (n,)."""
    side = seen[:, :, 0]
    arc = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(side, axis=1)))))
    tilt = np.zeros(len(arc))
    for end, inner, sign in ((0, 1, 1.0), (-1, -2, -1.0)):
        up, tangent = seen[:, end, 1] - seen[:, end, 0], sign * (side[:, inner] - side[:, end])
        lean = np.arcsin(np.clip(up @ tangent / (np.hypot(*up) * np.hypot(*tangent)), -1, 1))
        tilt += lean * np.exp(-np.abs(arc - arc[end]) / (_PASSAGE * spacing[end]))
    return tilt
