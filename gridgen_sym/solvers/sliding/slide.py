"""The boundary nodes that slide: where they are on their curves, and what of a gradient and a Hessian they feel.

A node on a curve c(t) has one unknown. Systems keep two components per node: what is normal to the curve is taken out
of the gradient, and in the Hessian it is a diagonal entry of its own. The tangential entry has the second derivative
along the curve, t^T H t + g . c'', with c'' per length and without its tangential part.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ...arrays import Array, Mask
from ...boundary.sides import Sides
from ...boundary.slide_curve import SlideCurve, slide_curve
from ...errors import GridgenError, quoted
from ...grids import Grid

#: Corners must be so near to the ends of a curve, and nodes to it, over the extent of the grid.
_NEAR_END, _NEAR = 1e-6, 0.05
#: An edge cuts off a bend where its middle is this part of its length away from the curve, as of an arc of 87 degrees.
_CUT = 0.2
#: The couplings that the stored half of a Hessian holds: the shift of the neighbor and the first plane.
_COUPLINGS = (((1, 0), 3), ((0, 1), 7), ((1, 1), 11), ((1, -1), 15))


@dataclass(slots=True, eq=False)
class _Side:
    """The sliding nodes of one side: its name, indices, curve, parameters, and the curve's corners around each."""

    name: str
    index: tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]
    curve: SlideCurve
    at: Array
    low: Array
    high: Array


class Slide:
    """The sliding nodes of a grid."""

    __slots__ = ("_sides", "shape", "tangents")

    def __init__(self, sides: list[_Side], shape: tuple[int, int]) -> None:
        """Take the sides; `tangents` (2, ni, nj) are those at the sliding nodes, zero elsewhere."""
        self._sides, self.shape = sides, shape
        self.tangents = np.zeros((2, *shape))
        self._set_tangents()

    def mask(self, fixed: Mask) -> Mask:
        """Return the mask of nodes without any unknown: the fixed ones that do not slide."""
        free = fixed.copy()
        for side in self._sides:
            free[side.index] = 0
        return free

    def retract(self, coordinates: Array, *, trial: bool = False) -> None:
        """Put the sliding nodes of coordinates (2, ni, nj) back on their curves, in place, near where they are now.

        Args:
            coordinates: changed in place.
            trial: do not remember where, because the step may be refused.
        """
        for side in self._sides:
            at = np.clip(side.curve.nearest(coordinates[:, *side.index].T, side.at), side.low, side.high)
            coordinates[:, *side.index] = side.curve.point(at).T
            side.at = side.at if trial else at
        if not trial:
            self._set_tangents()

    def caution(self, coordinates: Array) -> str:
        """Return a remark on sides whose edges cut off much of their curve, with a leading blank, or nothing.

        Few nodes may crowd at the ends of a curve, and one edge span the rest: that grid is one of another domain.
        """
        cut = []
        for side in self._sides:
            line = coordinates[:, *_side_nodes(side.name, self.shape)]
            edge = np.hypot(*np.diff(line, axis=1))
            middle = (line[:, 1:] + line[:, :-1]).T / 2
            away = np.hypot(*(side.curve.point(side.curve.nearest(middle)) - middle).T)
            if (away > _CUT * edge).any():
                cut.append(side.name)
        if not cut:
            return ""
        return f" Edges at {' and '.join(cut)} cut off bends of the curve: take more nodes, or let fewer sides slide."

    def _set_tangents(self) -> None:
        for side in self._sides:
            slope = side.curve.first(side.at)
            self.tangents[:, *side.index] = (slope / np.hypot(*slope.T)[:, None]).T

    def project(self, field: Array) -> Array:
        """Return the tangential part of a field (2, ni, nj) at the sliding nodes, zero elsewhere."""
        return np.asarray(self.tangents * (self.tangents * field).sum(axis=0))

    def constrain(self, planes: Array, gradient: Array, *, semidefinite: bool) -> None:
        """Make the stored half of a Hessian (19, ni, nj) that of the tangential unknowns, in place.

        Args:
            planes: of the Hessian in all nodes.
            gradient: (2, ni, nj) in all nodes, not projected.
            semidefinite: leave out what the curves' bends would take away, so that a semidefinite Hessian stays so.
        """
        tangent, shape = self.tangents, self.shape
        slides = np.zeros(shape, dtype=bool)
        for side in self._sides:
            slides[side.index] = True
        projector = np.einsum("aij,bij->abij", tangent, tangent)
        projector[:, :, ~slides] = np.eye(2)[:, :, None]
        for (di, dj), first in _COUPLINGS:
            here, there = _shifted(shape, di, dj)
            touched = np.argwhere(slides[here] | slides[there]).T
            a, b = (tuple(touched + np.array([[s[0].start], [s[1].start]])) for s in (here, there))
            block = planes[first : first + 4, *a].reshape(2, 2, -1)
            block = np.einsum("abn,bcn,cdn->adn", projector[:, :, *a], block, projector[:, :, *b])
            planes[first : first + 4, *a] = block.reshape(4, -1)
        for side in self._sides:
            self._own_blocks(planes, gradient, side, least=0.0 if semidefinite else -np.inf)

    def _own_blocks(self, planes: Array, gradient: Array, side: _Side, *, least: float) -> None:
        """Replace the diagonal blocks of a side's nodes."""
        xx, xy, yy = planes[:3, *side.index]
        tx, ty = self.tangents[:, *side.index]
        slope, bend = side.curve.first(side.at).T, side.curve.second(side.at).T
        square = (slope**2).sum(axis=0)
        normal_bend = bend - slope * ((bend * slope).sum(axis=0) / square)
        curvature = (gradient[:, *side.index] * normal_bend).sum(axis=0) / square
        curvature = np.maximum(curvature, least)
        size = 0.5 * (np.abs(xx) + np.abs(yy))
        along = xx * tx * tx + 2 * xy * tx * ty + yy * ty * ty + curvature
        planes[0, *side.index] = along * tx * tx + size * ty * ty
        planes[1, *side.index] = (along - size) * tx * ty
        planes[2, *side.index] = along * ty * ty + size * tx * tx


def _shifted(shape: tuple[int, int], di: int, dj: int) -> tuple[tuple[slice, slice], tuple[slice, slice]]:
    """Return the slices of all nodes that have a neighbor at a shift, and of these neighbors."""
    ni, nj = shape
    here = slice(0, ni - di), slice(max(0, -dj), nj - max(0, dj))
    there = slice(di, ni), slice(max(0, dj), nj + min(0, dj))
    return here, there


def make_slide(grid: Grid, slide: object, fixed: Mask) -> Slide:
    """Return the sliding nodes of a grid.

    Args:
        grid: whose boundary nodes begin where they are.
        slide: `"all"`, the name of a side, several names, or a mapping from sides to curves (None for that of the
            side's own nodes: splines between sharp turns, whose nodes stay).
        fixed: (ni, nj), of the nodes that do not move.

    Raises:
        GridgenError: for an unknown side, or a curve that does not belong to its side.
    """
    sides = []
    extent = float(np.ptp(grid.xy.reshape(-1, 2), axis=0).max())
    for name, given in _curves(slide).items():
        index = _side_nodes(name, grid.shape)
        nodes = grid.xy[index]
        curve = SlideCurve.of_points(nodes) if given is None else slide_curve(given)
        at = _placed(name, curve, nodes, extent, own=given is None)
        # Nodes at corners of the curve stay, and none passes one.
        piece = np.clip(np.searchsorted(curve.corners, at, side="right") - 1, 0, len(curve.corners) - 2)
        low, high = curve.corners[piece], curve.corners[piece + 1]
        apart = np.minimum(np.abs(at - low), np.abs(at - high))
        free = apart > 1e-9
        free[[0, -1]] = False
        inner = tuple(part[free] for part in index)
        sides.append(_Side(name, (inner[0], inner[1]), curve, at[free], low[free], high[free]))
    return Slide(sides, grid.shape)


def _curves(slide: object) -> dict[str, object]:
    """Return what was said of the curve of every sliding side."""
    if slide == "all":
        return dict.fromkeys(Sides._fields)
    if isinstance(slide, str):
        slide = (slide,)
    if not isinstance(slide, (Mapping, tuple, list, set, frozenset)):
        raise GridgenError(f"slide must be 'all', sides, or a mapping from sides to curves; came {quoted(slide)}")
    for side in slide:
        if side not in Sides._fields:
            raise GridgenError(
                f"unknown side {quoted(side)} in slide: the sides are {', '.join(Sides._fields)}, or 'all'"
            )
    return dict(slide) if isinstance(slide, Mapping) else dict.fromkeys(slide)


def _side_nodes(side: str, shape: tuple[int, int]) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]:
    ni, nj = shape
    count, of_i = (ni, True) if side in ("bottom", "top") else (nj, False)
    along = np.arange(count, dtype=np.intp)
    across = np.full(count, 0 if side in ("bottom", "left") else (nj if of_i else ni) - 1, dtype=np.intp)
    return (along, across) if of_i else (across, along)


def _placed(name: str, curve: SlideCurve, nodes: Array, extent: float, *, own: bool) -> Array:
    """Return the parameters of the nodes of a side on its curve; the curve may run either way."""
    at = curve.nearest(nodes)
    if own:
        return at
    ends = curve.point(np.array([0.0, 1.0]))
    wrong = min(np.abs(ends - nodes[[0, -1]]).max(), np.abs(ends[::-1] - nodes[[0, -1]]).max())
    if wrong > _NEAR_END * extent:
        raise GridgenError(
            f"the curve of the side {name} must begin and end at the corners of the grid; an end is {wrong:.3g} away: "
            "move the corners of the start onto it, or extend or cut the curve"
        )
    away = float(np.hypot(*(curve.point(at) - nodes).T).max())
    if away > _NEAR * extent:
        raise GridgenError(
            f"the nodes of the side {name} must lie on its curve; one is {away:.3g} away: sample the side on the curve"
        )
    return at
