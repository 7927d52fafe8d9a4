"""From what a user says of sliding boundaries to the sliding nodes of several blocks, checked."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from ...arrays import Array
from ...boundary.sides import Sides
from ...boundary.slide_curve import SlideCurve, chord_fractions, sharp_turns, slide_curve
from ...errors import GridgenError, quoted
from ...topology import MultiBlock
from ...topology.connection import side_part
from ...topology.copies import Indices
from ...topology.outer_lines import Edge, OuterLine, outer_edges, outer_lines
from ..sliding.placing import placed, placed_round
from .slide import LayoutSlide, SlidingLine


def make_layout_slide(layout: MultiBlock, slide: object) -> LayoutSlide:
    """Return the sliding nodes of a layout.

    Boundary nodes slide from block to block; those stay that are corners of the domain or sharp turns, end what slides,
    or have copies at another place.

    Args:
        layout: whose boundary nodes begin where they are.
        slide: `"all"`; names of boundaries, and sides as (block, side), one or several; or a mapping from these to
            curves (None for that of the boundary's own nodes).

    Raises:
        GridgenError: for what is no boundary, is said twice, or a curve that does not belong to its boundary.
    """
    chosen = _curves(layout, slide)
    groups: dict[Edge, int] = {}
    for number, (key, given) in enumerate(chosen.items(), 1):
        for edge in _edges(layout, key):
            if edge in groups:
                block, side, _ = edge
                raise GridgenError(f"{side} of block {layout.names[block]} slides twice: name it once in slide")
            groups[edge] = 0 if given is None else number
    lines = outer_lines(layout, groups)
    points = np.concatenate([grid.xy.reshape(-1, 2) for grid in layout.blocks])
    extent = float(np.ptp(points, axis=0).max())
    found = []
    keys = list(chosen)
    for line in lines:
        if line.group == 0:
            found.append(_on_own_curve(layout, line))
            continue
        key = keys[line.group - 1]
        parts = sum(other.group == line.group for other in lines)
        if parts > 1:
            raise GridgenError(
                f"{_told(key)} consists of {parts} parts between corners, and one curve is given: give one for each "
                "part, by block and side, or none, for those of its own nodes"
            )
        found.append(_on_given_curve(layout, line, key, chosen[key], extent))
    return LayoutSlide(found, layout.copies, [grid.shape for grid in layout.blocks])


def _curves(layout: MultiBlock, slide: object) -> dict[Any, object]:
    """Return what was said of the curve of every boundary or side."""
    if isinstance(slide, str) or _is_side(layout, slide):
        return {slide: None}
    if isinstance(slide, Mapping):
        return dict(slide)
    if not isinstance(slide, tuple | list | set | frozenset):
        raise GridgenError(
            "slide must be 'all', names of boundaries, sides such as ('a', 'top'), or a mapping from these to curves; "
            f"came {quoted(slide)}"
        )
    return {tuple(key) if isinstance(key, list) else key: None for key in slide}


def _is_side(layout: MultiBlock, key: object) -> bool:
    """Whether a key is a block and a side."""
    pair = isinstance(key, tuple | list) and 2 <= len(key) <= 3 and key[1] in Sides._fields
    return bool(pair and not (key[0] in layout.boundaries and key[1] in layout.boundaries))  # type: ignore[index]


def _edges(layout: MultiBlock, key: object) -> Iterator[Edge]:
    """Yield the edges of the outer boundary that a key names."""
    outer = outer_edges(layout)
    numbers, shapes = {name: k for k, name in enumerate(layout.names)}, [grid.shape for grid in layout.blocks]
    if key == "all":
        yield from outer
        return
    if isinstance(key, str) and key in layout.boundaries:
        parts: Sequence[Any] = layout.boundaries[key]
    elif len(layout) == 1 and key in Sides._fields:
        parts = [side_part((layout.names[0], key), numbers, shapes)]
    elif isinstance(key, str):
        known = ", ".join(layout.boundaries) or "none has a name"
        raise GridgenError(
            f"unknown boundary {quoted(key)} in slide; the boundaries are: {known}; a side is named with its block, "
            f"such as ({quoted(layout.names[0])}, 'top')"
        )
    else:
        parts = [side_part(key, numbers, shapes)]  # type: ignore[arg-type]
    wanted = {(part.block, part.side, k) for part in parts for k in range(part.first, part.last)}
    found = [edge for edge in outer if edge in wanted]
    if not found:
        raise GridgenError(f"{_told(key)} cannot slide: all of it is connected, so that its nodes move anyway")
    yield from found


def _told(key: object) -> str:
    """Return a boundary or a side in words."""
    return f"the boundary {key}" if isinstance(key, str) else f"{key[1]} of block {key[0]}"  # type: ignore[index]


def _nodes(layout: MultiBlock, places: Indices) -> Array:
    """Return the positions (n, 2) of nodes at places (3, n)."""
    return np.array([layout.blocks[b].planes[:, i, j] for b, i, j in places.T.tolist()])


def _on_own_curve(layout: MultiBlock, line: OuterLine) -> SlidingLine:
    """Return a line on splines through its nodes between sharp turns; a closed one begins at such, if there is one."""
    name, nodes, places = _name(layout, line), _nodes(layout, line.places), line.places
    if line.closed:
        sharp = np.flatnonzero(sharp_turns(np.concatenate((nodes[-2:-1], nodes)))[1:-1])
        if not len(sharp):
            return SlidingLine(name, places, SlideCurve.round_points(nodes), chord_fractions(nodes), own=True)
        order = (sharp[0] + np.arange(len(nodes))) % (len(nodes) - 1)
        nodes, places = nodes[order], places[:, order]
    return SlidingLine(name, places, SlideCurve.of_points(nodes), chord_fractions(nodes), own=True)


def _on_given_curve(layout: MultiBlock, line: OuterLine, key: object, given: object, extent: float) -> SlidingLine:
    nodes = _nodes(layout, line.places)
    if line.closed:
        curve, at = placed_round(_told(key), given, nodes, extent)
    else:
        curve, at = placed(_told(key), slide_curve(given), nodes, extent)
    return SlidingLine(_name(layout, line), line.places, curve, at)


def _name(layout: MultiBlock, line: OuterLine) -> str:
    """Return the name of the boundary that a line is on, or of its first side."""
    for name, parts in layout.boundaries.items():
        edges = {(part.block, part.side, k) for part in parts for k in range(part.first, part.last)}
        if edges.issuperset(line.edges):
            return name
    block, side, _ = line.edges[0]
    return side if len(layout) == 1 else f"{side} of block {layout.names[block]}"
