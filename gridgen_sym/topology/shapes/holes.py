"""A round hole in a rectangle: a ring of four blocks round the hole, and a frame of eight round the ring."""

from __future__ import annotations

import numpy as np

from ..curve_names import Curve
from ..multiblock import MultiBlock
from ..wireframe import Wireframe
from .channels import square_cells
from .registry import require, shape
from .rounds import circle_arc


@shape("a square with a round hole in its middle, twelve blocks")
def square_with_hole(
    side: float = 4.0, radius: float = 0.5, ring: float = 1.0, around: int = 8, outwards: int = 8
) -> MultiBlock:
    """Make the square; its boundaries are `wall` and `hole`. Five blocks meet at each corner of the ring.

    Args:
        side: the length of the square's sides, more than twice `ring`.
        radius: of the hole, positive.
        ring: half the side of the square ring of blocks round the hole, greater than its radius.
        around: cells on each quarter of the hole.
        outwards: cells from the hole to the ring's outside; those beyond are about square.
    """
    require("square_with_hole", side=side > 2 * ring, radius=radius > 0, ring=ring > radius)
    half = side / 2
    return _frame((-half, half), (-half, half), radius, ring, around, outwards, {"wall": "wsen"})


@shape("a channel with a round hole in its middle, as round a cylinder, twelve blocks")
def channel_with_hole(
    height: float = 4.0,
    radius: float = 0.5,
    ring: float = 1.0,
    upstream: float = 3.0,
    downstream: float = 8.0,
    around: int = 8,
    outwards: int = 8,
) -> MultiBlock:
    """Make the channel; its boundaries are `inlet`, `outlet`, `wall` and `hole`, whose middle is at (0, 0).

    Args:
        height: of the channel, more than twice `ring`.
        radius: of the hole, positive.
        ring: half the side of the square ring of blocks round the hole, greater than its radius.
        upstream: the distance of the inlet from the middle of the hole, more than `ring`.
        downstream: the distance of the outlet, more than `ring`.
        around: cells on each quarter of the hole.
        outwards: cells from the hole to the ring's outside; those beyond are about square.
    """
    require(
        "channel_with_hole",
        height=height > 2 * ring,
        radius=radius > 0,
        ring=ring > radius,
        upstream=upstream > ring,
        downstream=downstream > ring,
    )
    sides = {"inlet": "w", "outlet": "e", "wall": "sn"}
    return _frame((-upstream, downstream), (-height / 2, height / 2), radius, ring, around, outwards, sides)


def _frame(
    x: tuple[float, float],
    y: tuple[float, float],
    radius: float,
    ring: float,
    around: int,
    outwards: int,
    sides: dict[str, str],
) -> MultiBlock:
    """Return the layout of a rectangle.

    Args:
        x: of its left and right side.
        y: of its bottom and top.
        radius: of the hole round (0, 0).
        ring: half the side of the ring.
        around: cells on a quarter of the hole.
        outwards: cells across the ring.
        sides: the sides of the rectangle, `w`, `e`, `s` and `n`, that every boundary has.
    """
    xs, ys = (x[0], -ring, ring, x[1]), (y[0], -ring, ring, y[1])
    points = {f"{i}{j}": (xs[i], ys[j]) for i in range(4) for j in range(4)}
    corners, angles = ("11", "21", "22", "12"), np.pi * np.array([-0.75, -0.25, 0.25, 0.75, 1.25])
    points |= {
        f"hole {at}": (float(radius * np.cos(angle)), float(radius * np.sin(angle)))
        for at, angle in zip(corners, angles[:4], strict=True)
    }
    blocks = {
        f"frame {i}{j}": [f"{i}{j}", f"{i + 1}{j}", f"{i + 1}{j + 1}", f"{i}{j + 1}"]
        for i in range(3)
        for j in range(3)
        if (i, j) != (1, 1)
    }
    curves = {}
    for k, name in enumerate(("s", "e", "n", "w")):
        a, b = corners[k], corners[(k + 1) % 4]
        arc = circle_arc(radius, float(angles[k]), float(angles[k + 1]))
        curves[f"hole {name}"] = Curve((f"hole {a}", f"hole {b}"), arc)
        blocks[f"ring {name}"] = [a, b, f"hole {b}", f"hole {a}"]
    size = 2 * ring / around
    cells = dict.fromkeys(("11-21", "21-22", "12-22", "11-12"), around) | {"hole 11-11": outwards}
    cells |= {"01-11": square_cells(-ring - x[0], size), "21-31": square_cells(x[1] - ring, size)}
    cells |= {"10-11": square_cells(-ring - y[0], size), "12-13": square_cells(y[1] - ring, size)}
    edges = {
        "w": [f"0{j}-0{j + 1}" for j in range(3)],
        "e": [f"3{j}-3{j + 1}" for j in range(3)],
        "s": [f"{i}0-{i + 1}0" for i in range(3)],
        "n": [f"{i}3-{i + 1}3" for i in range(3)],
    }
    boundaries = {name: [edge for side in given for edge in edges[side]] for name, given in sides.items()}
    return Wireframe(points, curves, blocks, cells, boundaries | {"hole": list(curves)}).layout()
