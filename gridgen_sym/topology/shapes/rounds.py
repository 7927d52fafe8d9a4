"""Round shapes: the annulus, its sector, and the cross-section of a pipe."""

from __future__ import annotations

import numpy as np

from ...arrays import Array
from ...boundary.curve_nodes import Nodes, nodes_on
from ...grids import Grid
from ..connection import Connection
from ..curve_names import Curve
from ..multiblock import MultiBlock
from ..wireframe import Wireframe
from .registry import require, shape


@shape("the ring between two circles: one block, closed at a cut")
def annulus(inner: float = 1.0, outer: float = 2.0, around: int = 48, outwards: int = 12) -> MultiBlock:
    """Make the ring; its boundaries are `inner` and `outer`.

    Args:
        inner: the radius of the inner circle, positive.
        outer: that of the outer circle, greater than the inner one.
        around: cells on a circle, at least 3.
        outwards: cells between the circles.
    """
    require("annulus", inner=inner > 0, outer=outer > inner, around=around >= 3)
    nodes = _ring(np.linspace(2 * np.pi, 0, around + 1), inner, outer, outwards)
    nodes[-1] = nodes[0]
    return MultiBlock(
        {"ring": Grid(nodes)},
        [Connection(("ring", "left"), ("ring", "right"))],
        boundaries={"inner": [("ring", "bottom")], "outer": [("ring", "top")]},
    )


@shape("a sector of the ring between two circles, periodic by rotation")
def sector(
    inner: float = 1.0, outer: float = 2.0, angle: float = 60.0, around: int = 16, outwards: int = 16
) -> MultiBlock:
    """Make the sector, symmetric about the x axis; its boundaries are `inner` and `outer`.

    Args:
        inner: the radius of the inner arc, positive.
        outer: that of the outer arc, greater than the inner one.
        angle: of the sector in degrees, more than 0 and at most 180.
        around: cells on an arc.
        outwards: cells between the arcs.
    """
    require("sector", inner=inner > 0, outer=outer > inner, angle=0 < angle <= 180)
    nodes = _ring(np.radians(angle * np.linspace(0.5, -0.5, around + 1)), inner, outer, outwards)
    return MultiBlock(
        {"sector": Grid(nodes)},
        [Connection(("sector", "left"), ("sector", "right"), rotation=-angle)],
        boundaries={"inner": [("sector", "bottom")], "outer": [("sector", "top")]},
    )


@shape("the cross-section of a pipe: a core and four blocks round it (O-H, 'butterfly')")
def pipe(radius: float = 1.0, core: float = 0.5, across: int = 12, outwards: int = 8) -> MultiBlock:
    """Make the disk; its boundary is `wall`. Three blocks meet at each corner of the core.

    Args:
        radius: of the pipe, positive.
        core: the distance of the core's corners from the center over the radius, between 0 and 1.
        across: cells on each side of the core; four times as many are on the wall.
        outwards: cells from the core to the wall.
    """
    require("pipe", radius=radius > 0, core=0 < core < 1)
    diagonal = np.exp(1j * np.pi * np.array([-0.75, -0.25, 0.25, 0.75])) * radius
    names = ("sw", "se", "ne", "nw")
    points = {
        f"{kind} {name}": (float(part * place.real), float(part * place.imag))
        for kind, part in (("wall", 1.0), ("core", core))
        for name, place in zip(names, diagonal, strict=True)
    }
    curves, blocks = {}, {"core": [f"core {name}" for name in names]}
    for k, (block, a, b) in enumerate(
        zip(("south", "east", "north", "west"), names, names[1:] + names[:1], strict=True)
    ):
        arc = circle_arc(radius, np.pi * (-0.75 + 0.5 * k), np.pi * (-0.25 + 0.5 * k))
        curves[f"wall {block}"] = Curve((f"wall {a}", f"wall {b}"), arc)
        blocks[block] = [f"wall {a}", f"wall {b}", f"core {b}", f"core {a}"]
    cells = {"core sw-core se": across, "core sw-core nw": across, "wall sw-core sw": outwards}
    return Wireframe(points, curves, blocks, cells, {"wall": list(curves)}).layout()


def circle_arc(radius: float, start: float, end: float, center: tuple[float, float] = (0.0, 0.0)) -> Nodes:
    """Return the nodes of an arc of a circle between two angles, in radians."""

    def on_arc(s: Array) -> Array:
        angle = start + (end - start) * s
        return np.stack((center[0] + radius * np.cos(angle), center[1] + radius * np.sin(angle)), axis=-1)

    return nodes_on(on_arc)


def _ring(angles: Array, inner: float, outer: float, outwards: int) -> Array:
    """Return nodes (ni, nj, 2) at angles that fall, so that J > 0."""
    radii = np.linspace(inner, outer, outwards + 1)
    return np.stack((np.outer(np.cos(angles), radii), np.outer(np.sin(angles), radii)), axis=-1)
