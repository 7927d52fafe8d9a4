"""Plane curves as functions of a parameter s in [0, 1]: (n,) -> (n, 2)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..arrays import Array

Side = Callable[[Array], Array]


def curve(x: Side, y: Side) -> Side:
    """Join two coordinate functions of the parameter s in [0, 1] to one curve: s of shape (n,) -> (n, 2)."""
    return lambda s: np.stack((x(s), y(s)), axis=-1)


def line(start: tuple[float, float], end: tuple[float, float]) -> Side:
    """Return the straight side between two points."""
    a, b = np.array(start), np.array(end)
    return lambda s: (1 - s)[:, None] * a + s[:, None] * b


def polyline(points: list[tuple[float, float]], at: list[float]) -> Side:
    """Return the polyline through `points`, which it meets at the parameters `at`."""
    xs, ys = zip(*points, strict=True)
    return curve(lambda s: np.interp(s, at, xs), lambda s: np.interp(s, at, ys))


def arc(rx: float, ry: float, start: float, turn: float, center: float = 0.0) -> Side:
    """Return an elliptic arc around (center, 0), clockwise over `turn` from the angle `start`.

    Clockwise, because the sides 'bottom' and 'top' must keep the domain's outside (increasing eta) on their
    left.
    """
    return curve(
        lambda s: center + rx * np.cos(start - turn * s),
        lambda s: ry * np.sin(start - turn * s),
    )
