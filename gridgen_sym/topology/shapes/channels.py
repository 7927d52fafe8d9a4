"""Channels with straight walls: the T- and the Y-junction, and the backward step."""

from __future__ import annotations

import numpy as np

from ..multiblock import MultiBlock
from ..wireframe import Wireframe
from .registry import require, shape


@shape("a T-junction: a channel and a branch at a right angle, four blocks")
def tee(
    width: float = 1.0,
    branch: float = 1.0,
    upstream: float = 2.0,
    downstream: float = 2.0,
    height: float = 2.0,
    across: int = 12,
) -> MultiBlock:
    """Make the junction; its boundaries are `inlet` at the left, `outlet` at the right, `branch` and `wall`.

    Args:
        width: of the channel, positive.
        branch: the width of the branch, positive.
        upstream: the length of the channel before the branch, positive.
        downstream: the length of the channel behind it, positive.
        height: the length of the branch, positive.
        across: cells across the channel; all cells are about square.
    """
    require(
        "tee", width=width > 0, branch=branch > 0, upstream=upstream > 0, downstream=downstream > 0, height=height > 0
    )
    x, y = (-upstream, 0.0, branch, branch + downstream), (0.0, width, width + height)
    points = {f"{i}{j}": (x[i], y[j]) for i, j in ((0, 0), (1, 0), (2, 0), (3, 0), (0, 1), (1, 1), (2, 1), (3, 1))}
    points |= {"12": (x[1], y[2]), "22": (x[2], y[2])}
    blocks = {
        "upstream": ["00", "10", "11", "01"],
        "junction": ["10", "20", "21", "11"],
        "downstream": ["20", "30", "31", "21"],
        "branch": ["11", "21", "22", "12"],
    }
    cells = {
        "00-01": across,
        "10-20": square_cells(branch, width / across),
        "00-10": square_cells(upstream, width / across),
        "20-30": square_cells(downstream, width / across),
        "11-12": square_cells(height, width / across),
    }
    boundaries = {
        "inlet": ["00-01"],
        "outlet": ["30-31"],
        "branch": ["12-22"],
        "wall": ["00-10", "10-20", "20-30", "01-11", "21-31", "11-12", "21-22"],
    }
    return Wireframe(points, {}, blocks, cells, boundaries).layout()


@shape("a Y-junction: three channels round a node where three blocks meet, six blocks")
def wye(
    width: float = 1.0, angle: float = 120.0, upstream: float = 2.0, downstream: float = 2.0, across: int = 12
) -> MultiBlock:
    """Make the junction; its boundaries are `inlet` at the left, `upper outlet`, `lower outlet` and `wall`.

    Args:
        width: of all three channels, positive.
        angle: between the outlets in degrees, from 40 to 240.
        upstream: the length of the channel before the junction, positive.
        downstream: the length of both channels behind it, positive.
        across: an even number of cells across a channel; all cells are about square.
    """
    require(
        "wye",
        width=width > 0,
        angle=40 <= angle <= 240,
        upstream=upstream > 0,
        downstream=downstream > 0,
        across=across % 2 == 0,
    )
    axes = np.exp(1j * np.radians([180.0, -angle / 2, angle / 2]))  # Counter-clockwise.
    names = ("inlet", "lower", "upper")
    places: dict[str, complex] = {}
    for k, name in enumerate(names):  # The corner between this channel and the next one.
        half = np.angle(axes[(k + 1) % 3] / axes[k]) % (2 * np.pi) / 2
        places[f"after {name}"] = width / 2 / np.sin(half) * axes[k] * np.exp(1j * half)
    for k, name in enumerate(names):
        middle = (places[f"after {names[k - 1]}"] + places[f"after {name}"]) / 2
        end = middle + axes[k] * (upstream if k == 0 else downstream)
        places |= {f"mouth {name}": middle, f"right {name}": end - 0.5j * width * axes[k]}
        places[f"left {name}"] = end + 0.5j * width * axes[k]
    places["center"] = sum(places[f"mouth {name}"] for name in names) / 3
    blocks: dict[str, list[str | list[str]]] = {}
    walls, cells = [], {f"mouth {name}-after {name}": across // 2 for name in names}
    for k, name in enumerate(names):
        before, after, mouth = f"after {names[k - 1]}", f"after {name}", f"mouth {name}"
        blocks[name] = [
            [f"{before}-right {name}"],
            [f"right {name}-left {name}"],
            [f"left {name}-{after}"],
            [f"{after}-{mouth}", f"{mouth}-{before}"],
        ]
        blocks[f"center {k}"] = ["center", mouth, after, f"mouth {names[(k + 1) % 3]}"]
        walls += [f"{before}-right {name}", f"left {name}-{after}"]
        cells[f"{before}-right {name}"] = square_cells(upstream if k == 0 else downstream, width / across)
    boundaries = {"inlet": ["right inlet-left inlet"], "wall": walls}
    boundaries |= {f"{name} outlet": [f"right {name}-left {name}"] for name in ("lower", "upper")}
    points = {name: (float(place.real), float(place.imag)) for name, place in places.items()}
    return Wireframe(points, {}, blocks, cells, boundaries).layout()


@shape("a channel with a backward step, three blocks")
def step(
    height: float = 1.0, inlet: float = 1.0, upstream: float = 3.0, downstream: float = 9.0, across: int = 8
) -> MultiBlock:
    """Make the channel; its boundaries are `inlet`, `outlet` and `wall`. The foot of the step is at (0, 0).

    Args:
        height: of the step, positive.
        inlet: the height of the channel before the step, positive.
        upstream: the length of the channel before the step, positive.
        downstream: the length of the channel behind it, positive.
        across: cells on the step; all cells are about square.
    """
    require("step", height=height > 0, inlet=inlet > 0, upstream=upstream > 0, downstream=downstream > 0)
    top = height + inlet
    points = {"foot": (0.0, 0.0), "edge": (0.0, height), "lid": (0.0, top)}
    points |= {"low inlet": (-upstream, height), "high inlet": (-upstream, top)}
    points |= {"low outlet": (downstream, 0.0), "middle": (downstream, height), "high outlet": (downstream, top)}
    blocks = {
        "upstream": ["low inlet", "edge", "lid", "high inlet"],
        "upper": ["edge", "middle", "high outlet", "lid"],
        "lower": ["foot", "low outlet", "middle", "edge"],
    }
    cells = {
        "foot-edge": across,
        "edge-lid": square_cells(inlet, height / across),
        "low inlet-edge": square_cells(upstream, height / across),
        "foot-low outlet": square_cells(downstream, height / across),
    }
    boundaries = {
        "inlet": ["low inlet-high inlet"],
        "outlet": ["low outlet-middle", "middle-high outlet"],
        "wall": ["low inlet-edge", "foot-edge", "foot-low outlet", "high inlet-lid", "lid-high outlet"],
    }
    return Wireframe(points, {}, blocks, cells, boundaries).layout()


def square_cells(length: float, size: float) -> int:
    """Return how many cells of about a size a length has; at least two."""
    return max(2, round(length / size))
