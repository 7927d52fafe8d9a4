"""The outer boundary of several blocks in adaptation: lines along which nodes slide, with springs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..boundary.slide_curve import SlideCurve, chord_fractions, sharp_turns
from ..solvers.layout.slide import LayoutSlide, SlidingLine
from ..topology import MultiBlock
from ..topology.outer_lines import OuterLine, outer_edges, outer_lines
from .sides import Boundary, SideSpacing, staying


@dataclass(slots=True)
class LineSpacing:
    """How the nodes of sliding lines are spaced; see `SideSpacing`.

    Attributes:
        lines: along which nodes slide, by their numbers as names.
        spacing: of their nodes.
    """

    lines: dict[str, SlidingLine]
    exponent: float = 1.0
    spacing: SideSpacing = field(init=False)

    def __post_init__(self) -> None:
        """Space the nodes as they are."""
        self.spacing = SideSpacing(self.curves, self.exponent)

    @property
    def curves(self) -> dict[str, SlideCurve]:
        """The curves of the lines."""
        return {name: line.curve for name, line in self.lines.items()}

    def toward(self, layout: MultiBlock, density: Array, damping: float, energy: float) -> LayoutSlide:
        """Return the sliding nodes of a layout with springs that go toward a density (n,) at all nodes."""
        shapes = [grid.shape for grid in layout.blocks]
        begin, widths = np.cumsum([0, *(ni * nj for ni, nj in shapes)]), np.array([nj for _, nj in shapes])
        sprung = []
        for name, line in self.lines.items():
            block, i, j = line.places
            points = _points(layout, line.places)
            curve = self.spacing.sprung(name, points, density[begin[block] + i * widths[block] + j], damping, energy)
            sprung.append(replace(line, curve=curve))
        slide = LayoutSlide(sprung, layout.copies, shapes)
        slide.follow(np.concatenate([grid.planes.ravel() for grid in layout.blocks]))
        for (name, line), side in zip(self.lines.items(), slide.slide.sides, strict=True):
            self.lines[name] = replace(line, at=side.at)
        return slide


def sliding_lines(
    layout: MultiBlock, boundary: Boundary, fixed: Mapping[str, npt.ArrayLike] | None
) -> dict[str, SlidingLine]:
    """Return the lines of the outer boundary along which nodes may slide, as `sliding_curves` does for one block."""
    found: dict[str, SlidingLine] = {}
    for line in outer_lines(layout, dict.fromkeys(outer_edges(layout), 0)) if boundary != "fixed" else ():
        order, closed = _order(layout, line)
        places = line.places[:, order]
        points = _points(layout, places)
        stays = staying(points, boundary) | _held(layout, places, fixed)
        if stays[1:-1].all():
            continue
        closed = closed and boundary == "all" and not stays.any()
        corners = 1 + np.flatnonzero(stays[1:-1])
        curve = SlideCurve.round_points(points.T) if closed else SlideCurve.of_points(points.T, corners)
        edges = tuple(line.edges[k] for k in order[:-1])
        name = str(len(found))
        found[name] = SlidingLine(f"boundary line {name}", places, curve, chord_fractions(points.T), edges=edges)
    return found


def _order(layout: MultiBlock, line: OuterLine) -> tuple[npt.NDArray[np.intp], bool]:
    """Return the nodes of a line in their order, and whether it is closed; such a line begins at a turn, if it can."""
    count = line.places.shape[1]
    order = np.arange(count, dtype=np.intp)
    if not line.closed:
        return order, False
    points = _points(layout, line.places).T
    sharp = np.flatnonzero(sharp_turns(np.concatenate((points[-2:-1], points)))[1:-1])
    return ((sharp[0] + order) % (count - 1), False) if len(sharp) else (order, True)


def _points(layout: MultiBlock, places: npt.NDArray[np.intp]) -> Array:
    """Return the positions (2, n) of nodes at places (3, n)."""
    return np.array([layout.blocks[b].planes[:, i, j] for b, i, j in places.T.tolist()]).T


def _held(
    layout: MultiBlock, places: npt.NDArray[np.intp], fixed: Mapping[str, npt.ArrayLike] | None
) -> npt.NDArray[np.bool_]:
    """Return which nodes at places (3, n) a user holds."""
    masks = {layout.names.index(name): np.asarray(mask) for name, mask in (fixed or {}).items()}
    return np.array([b in masks and bool(masks[b][i, j]) for b, i, j in places.T.tolist()])
