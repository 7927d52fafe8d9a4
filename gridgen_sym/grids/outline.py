"""Boundaries from files: a closed curve with four corners, checked, and the grid inside it."""

from __future__ import annotations

import os
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gridgen_sym.errors import GridgenError

from ..atomic import read_bytes, write_bytes
from .grid import FloatArray, Grid, check_counts, real_array
from .outline_file import parse_outline
from .polygon import first_crossing, first_repeated, is_clockwise
from .transfinite import transfinite

Corners = tuple[int, int, int, int]


@dataclass(frozen=True, slots=True, init=False, eq=False)
class Outline:
    """A closed curve with four corners: a simple polygon that runs counter-clockwise.

    With the corners c0 = 0 < c1 < c2 < c3, bottom is points c0..c1, right c1..c2, top c2..c3 (from right to
    left) and left c3..N, 0 (downwards).

    Attributes:
        points: the vertices, shape (N, 2), read-only; the last is not a copy of the first.
        corners: the indices of the four corners.
        name: what to call it in messages.
    """

    points: FloatArray
    corners: Corners
    name: str

    def __init__(self, points: ArrayLike, corners: ArrayLike, name: str = "outline", *, reorient: bool = False) -> None:
        """Copy and check an outline.

        Args:
            points: shape (N, 2), N >= 4, finite, no two in succession equal, not crossing itself.
            corners: four increasing indices, the first 0.
            name: what to call it in messages.
            reorient: accept a clockwise curve, by running it backwards from its second corner: bottom and top
                stay on their curves, left and right change places.

        Raises:
            GridgenError: naming the outline, the fault, its place and the repair.
        """
        array = _checked_points(points, name)
        checked = _checked_corners(corners, len(array), name)
        crossing = first_crossing(array)
        if crossing is not None:
            raise GridgenError(f"the outline '{name}' crosses or touches itself: {_crossing_text(array, crossing)}")
        clockwise = is_clockwise(array)
        if clockwise and not reorient:
            raise GridgenError(
                f"the outline '{name}' runs clockwise; expected counter-clockwise: pass reorient=True, which "
                "runs it backwards from corner 1, so that bottom and top stay where they are, and left and "
                "right change places"
            )
        if clockwise:
            array, checked = _reversed(array, checked)
        array.setflags(write=False)
        for field, value in (("points", array), ("corners", checked), ("name", name)):
            object.__setattr__(self, field, value)

    @classmethod
    def read(cls, path: str | os.PathLike[str], *, reorient: bool = False) -> Outline:
        """Read an outline from a CSV file.

        The file has comment lines (``# name: NAME`` and ``# corners: c0 c1 c2 c3``; others are ignored), the
        header ``x,y``, and one line for each point.

        Args:
            path: the file.
            reorient: as for `Outline`.

        Raises:
            GridgenError: if the file is missing or malformed (with the line's number), or its curve is no
                outline.
        """
        text = read_bytes(path).decode("utf-8-sig", errors="replace")
        name, corners, points = parse_outline(text, path)
        try:
            return cls(points, corners, name or Path(path).stem, reorient=reorient)
        except GridgenError as error:
            raise GridgenError(f"cannot use {path}: {error}") from error

    def write(self, path: str | os.PathLike[str]) -> None:
        """Write the outline in the format that `read` reads, with 17 significant digits.

        Raises:
            GridgenError: if no file can be written there.
        """
        head = [
            f"# name: {' '.join(self.name.split())}",
            f"# corners: {' '.join(map(str, self.corners))}",
            "x,y",
        ]
        lines = [*head, *(f"{x:.17g},{y:.17g}" for x, y in self.points.tolist()), ""]
        write_bytes(path, "\n".join(lines).encode())

    def sides(self, ni: int, nj: int) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Sample bottom, top, shape (ni, 2), and left, right, shape (nj, 2), at equal arc lengths.

        They run as the sides of a grid do. Arc length is that of the polygon. Corners are kept bit by bit.

        Raises:
            GridgenError: for fewer than 3 nodes.
        """
        check_counts(ni, nj)
        closed = np.concatenate((self.points, self.points[:1]))
        ends = (*self.corners, len(self.points))
        pieces = (closed[first : last + 1] for first, last in pairwise(ends))
        bottom, right, top, left = (
            _sampled(piece, count) for piece, count in zip(pieces, (ni, nj, ni, nj), strict=True)
        )
        return bottom, top[::-1], left[::-1], right

    def grid(self, ni: int, nj: int) -> Grid:
        """Return the transfinite grid of ni x nj nodes, at equal arc length on each side of the outline.

        Raises:
            GridgenError: for too few nodes, or when the polygon of the sampled nodes crosses itself, so that
                no valid grid can exist.
        """
        bottom, top, left, right = self.sides(ni, nj)
        ring = np.concatenate((bottom[:-1], right[:-1], top[:0:-1], left[:0:-1]))
        crossing = first_crossing(ring)
        if crossing is not None:
            raise GridgenError(
                f"with {ni} x {nj} nodes the sampled boundary of '{self.name}' crosses itself, so that no "
                f"valid grid exists: {_crossing_text(ring, crossing)} (counted along the sampled boundary); "
                "take more nodes"
            )
        return transfinite(bottom, top, left, right)

    def __eq__(self, other: object) -> bool:
        """Whether `other` has the same points and corners; names do not matter."""
        if not isinstance(other, Outline):
            return NotImplemented
        return self.corners == other.corners and np.array_equal(self.points, other.points)

    def __hash__(self) -> int:
        """Agree with `==`."""
        return hash((self.corners, (self.points + 0.0).tobytes()))


def _checked_points(points: ArrayLike, name: str) -> FloatArray:
    """Return a copy of the vertices: finite, enough of them, none repeated at once."""
    array = real_array(points, f"the points of the outline '{name}'").copy()
    if array.ndim != 2 or array.shape[1] != 2 or len(array) < 4:
        raise GridgenError(
            f"the outline '{name}' needs points of shape (N, 2) with N >= 4, but came with {array.shape}"
        )
    bad = ~np.isfinite(array).all(axis=1)
    if bad.any():
        k = int(bad.argmax())
        raise GridgenError(f"every point of the outline '{name}' must be finite, but point {k} is {array[k].tolist()}")
    repeated = first_repeated(array)
    if repeated is not None:
        closing = " (a closed curve does not repeat its first point)" if repeated == len(array) - 1 else ""
        following = (repeated + 1) % len(array)
        raise GridgenError(
            f"the outline '{name}' repeats a point: {repeated} and {following} are both "
            f"{array[repeated].tolist()}; "
            f"remove point {max(repeated, following)}{closing}"
        )
    return array


def _checked_corners(corners: ArrayLike, count: int, name: str) -> Corners:
    """Return the corners as four whole numbers: 0 < c1 < c2 < c3 < count."""
    values = real_array(corners, f"the corners of the outline '{name}'")
    listed = values.tolist()
    whole = values.shape == (4,) and np.isfinite(values).all() and (values % 1 == 0).all()
    if not whole or values[0] != 0 or not (np.diff(values) > 0).all() or not values[-1] < count:
        raise GridgenError(
            f"the corners of the outline '{name}' must be four increasing indices from 0 to {count - 1}, "
            f"the first 0, but are {listed}: roll the points so that the first corner comes first"
        )
    c0, c1, c2, c3 = (int(value) for value in values)
    return c0, c1, c2, c3


def _reversed(points: FloatArray, corners: Corners) -> tuple[FloatArray, Corners]:
    """Run a curve backwards from its corner 1, so that bottom and top stay on their curves."""
    count, (_, c1, c2, c3) = len(points), corners
    order: NDArray[np.intp] = (c1 - np.arange(count)) % count
    return np.ascontiguousarray(points[order]), (0, c1, c1 + count - c3, c1 + count - c2)


def _sampled(piece: FloatArray, count: int) -> FloatArray:
    """Return `count` points at equal arc length on an open polyline, with its ends kept exactly."""
    scaled = piece / np.abs(piece).max()  # Lengths of huge coordinates must not overflow.
    length = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(scaled, axis=0).T))))
    at = np.linspace(0.0, length[-1], count)
    side = np.stack([np.interp(at, length, piece[:, axis]) for axis in (0, 1)], axis=-1)
    side[0], side[-1] = piece[0], piece[-1]
    return side


def _crossing_text(points: FloatArray, crossing: tuple[int, int]) -> str:
    """Say which two edges meet, and where."""
    edges = [f"edge {k} from {points[k].tolist()} to {points[(k + 1) % len(points)].tolist()}" for k in crossing]
    return f"{edges[0]} meets {edges[1]}"
