"""Spacing laws: how nodes are placed along a line, from the lengths of its first and last cells.

A law is given for many lines at once. It returns the fractions of a line's length at its nodes, from 0 to 1.
References: M. Vinokur, On one-dimensional stretching functions for finite-difference calculations, J. Comput. Phys. 50
(1983); J. F. Thompson, Z. U. A. Warsi and C. W. Mastin, Numerical Grid Generation (1985), chapter VIII.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..errors import GridgenError

_BISECTIONS = 100
#: Bounds on the logarithm of a ratio of neighboring cells, and on the steepness of hyperbolic laws.
_LARGEST_LOGARITHM, _STEEPEST = 60.0, 300.0
_FIXED_POINTS = 60


def geometric(first: npt.ArrayLike, cells: int) -> Array:
    """Return fractions of a geometric series: every cell is longer than the one before by the same factor.

    Args:
        first: length of the first cell over that of the line, (m,).
        cells: number of cells.

    Returns:
        (m, cells + 1).
    """
    first = _checked(first, "first")
    logarithm = _bisect(
        lambda q: first * _series(q, cells), np.ones_like(first), -_LARGEST_LOGARITHM, _LARGEST_LOGARITHM
    )
    return _fractions(first[:, None] * np.exp(np.multiply.outer(logarithm, np.arange(cells))))


def hyperbolic_sine(first: npt.ArrayLike, cells: int) -> Array:
    """Return fractions sinh(d s)/sinh(d), s from 0 to 1, with the first cell of this length; see `geometric`.

    Where the first cell is as long as the mean one or longer there is no such d: the series is geometric.
    """
    return _one_ended(first, cells, lambda d, s: np.sinh(d * s) / np.sinh(d))


def hyperbolic_tangent(first: npt.ArrayLike, cells: int) -> Array:
    """Return fractions 1 + tanh(d (s - 1))/tanh(d), s from 0 to 1, as `hyperbolic_sine` does (Vinokur, one end)."""
    return _one_ended(first, cells, lambda d, s: 1 + np.tanh(d * (s - 1)) / np.tanh(d))


def two_ended(first: npt.ArrayLike, last: npt.ArrayLike, cells: int) -> Array:
    """Return Vinokur's fractions with given lengths of the first and the last cell.

    His function takes slopes at the ends; these are corrected until the cells have the lengths that were asked for.

    Args:
        first: length of the first cell over that of the line, (m,).
        last: the same of the last cell.
        cells: number of cells.

    Returns:
        (m, cells + 1).
    """
    return vinokur(*vinokur_slopes(first, last, cells), cells)


def vinokur_slopes(first: npt.ArrayLike, last: npt.ArrayLike, cells: int) -> tuple[Array, Array]:
    """Return the slopes at both ends, over the number of cells, with which `vinokur` has end cells of given lengths."""
    first, last = _checked(first, "first"), _checked(last, "last")
    if cells < 3:
        raise GridgenError(f"a law with given lengths at both ends needs at least 3 cells; came {cells}")
    slope, other = first.copy(), last.copy()
    for _ in range(_FIXED_POINTS):
        step = np.diff(vinokur(slope, other, cells), axis=1)
        wrong, wrong_last = first / step[:, 0], last / step[:, -1]
        if max(np.abs(wrong - 1).max(), np.abs(wrong_last - 1).max()) < 1e-12:
            break
        slope, other = slope * wrong, other * wrong_last
    return slope, other


def growing(first: npt.ArrayLike, growth: npt.ArrayLike, cells: int, layers: int | None = None) -> Array:
    """Return fractions of cells that grow by a given factor, as long as the line is long enough.

    Growth ends where the rest of the line can be divided evenly. Where it does not reach the end, only the first
    `layers` cells grow so, and the others by the factor that does.

    Args:
        first: length of the first cell over that of the line, (m,).
        growth: factor from one cell to the next, (m,) or one for all.
        cells: number of cells.
        layers: number of cells that grow by `growth` where not all can; by default half of them.

    Returns:
        (m, cells + 1).
    """
    first = _checked(first, "first")
    growth = np.broadcast_to(np.asarray(growth, dtype=float), first.shape)
    kept = cells // 2 if layers is None else min(max(layers, 1), cells)
    number = np.arange(cells)
    with np.errstate(over="ignore"):
        step = np.minimum(first[:, None] * growth[:, None] ** number, 1.0)
        ends = np.cumsum(step, axis=1)
        rest = (1 - (ends - step)) / (cells - number)
    even = step >= rest
    start = np.where(even.any(axis=1), even.argmax(axis=1), cells)
    reached = start < cells
    step = np.where(number >= start[:, None], rest[np.arange(len(first)), np.minimum(start, cells - 1)][:, None], step)
    short = ~reached
    if short.any() and kept < cells:
        outer = cells - kept
        length = 1 - step[short, :kept].sum(axis=1)
        before = step[short, kept - 1]
        logarithm = _bisect(
            lambda q: before * np.exp(q) * _series(q, outer), length, -_LARGEST_LOGARITHM, _LARGEST_LOGARITHM
        )
        step[short, kept:] = before[:, None] * np.exp(np.multiply.outer(logarithm, 1 + np.arange(outer)))
    return _fractions(step)


def growing_from_both(
    first: npt.ArrayLike, growth: npt.ArrayLike, last: npt.ArrayLike, growth_last: npt.ArrayLike, cells: int
) -> Array | None:
    """Return fractions of cells that grow from both ends until they meet, or are even in the middle.

    Args:
        first: length of the first cell over that of the line, (m,).
        growth: factor from one cell to the next at the first end, (m,) or one for all.
        last: the same of the last cell.
        growth_last: the same from the last end.
        cells: number of cells.

    Returns:
        (m, cells + 1); None where cells that grow so do not meet, or the ends are longer than the mean.
    """
    first, last = _checked(first, "first"), _checked(last, "last")
    number = np.arange(cells)
    with np.errstate(over="ignore"):
        from_first = first[:, None] * np.broadcast_to(growth, first.shape)[:, None] ** number
        from_last = last[:, None] * np.broadcast_to(growth_last, last.shape)[:, None] ** number[::-1]
    step = np.minimum(np.minimum(from_first, from_last), 1.0)
    even = _bisect(lambda c: np.minimum(step, c[:, None]).sum(axis=1), np.ones_like(first), 0.0, 1.0)
    step = np.minimum(step, even[:, None])
    # Where they do not quite meet, what is missing is that of the longest, as far as growth allows.
    longest = step == step.max(axis=1, keepdims=True)
    added = (1 - step.sum(axis=1, keepdims=True)) / longest.sum(axis=1, keepdims=True)
    allowed = (np.minimum(growth, growth_last) - 1).reshape(-1, 1) * step.max(axis=1, keepdims=True)
    if (step[:, 0] < first).any() or (step[:, -1] < last).any() or (added > allowed + 1e-12).any():
        return None
    return _fractions(step + longest * added)


def _checked(length: npt.ArrayLike, name: str) -> Array:
    value = np.atleast_1d(np.asarray(length, dtype=float))
    bad = ~((value > 0) & (value < 1))
    if bad.any():
        k = int(np.flatnonzero(bad)[0])
        raise GridgenError(
            f"the {name} cell of line {k} has {value[k]:.6g} of the line's length: it must have more than 0 and less "
            "than 1"
        )
    return value


def _series(logarithm: Array, cells: int) -> Array:
    """Return 1 + r + ... + r^(cells-1), r = exp(logarithm)."""
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        value = np.expm1(cells * logarithm) / np.expm1(logarithm)
    return np.asarray(np.where(np.abs(logarithm) < 1e-12, float(cells), value))


def _bisect(function: Callable[[Array], Array], value: Array, low: float, high: float) -> Array:
    """Return where an increasing function takes values, (m,)."""
    below, above = np.full(value.shape, low), np.full(value.shape, high)
    for _ in range(_BISECTIONS):
        middle = (below + above) / 2
        if ((middle == below) | (middle == above)).all():
            break
        with np.errstate(over="ignore", invalid="ignore"):
            less = ~(function(middle) > value)
        below, above = np.where(less, middle, below), np.where(less, above, middle)
    return np.asarray((below + above) / 2)


def _one_ended(first: npt.ArrayLike, cells: int, law: Callable[[Array, Array], Array]) -> Array:
    first = _checked(first, "first")
    s = np.linspace(0, 1, cells + 1)
    clustered = first < (1 - 1e-9) / cells
    result = geometric(first, cells)
    if clustered.any():
        # The first cell shrinks as d grows.
        wanted = -first[clustered]
        d = _bisect(lambda d: -law(d, np.full_like(d, s[1])), wanted, 1e-6, _STEEPEST)
        result[clustered] = law(d[:, None], s[None, :])
    result[:, 0], result[:, -1] = 0.0, 1.0
    return result


def vinokur(first: Array, last: Array, cells: int) -> Array:
    """Return Vinokur's two-sided function for slopes cells*first and cells*last at the ends."""
    s = np.linspace(0, 1, cells + 1)
    ratio, steepness = np.sqrt(last / first), 1 / (cells * np.sqrt(first * last))
    u = np.empty((len(first), cells + 1))
    clustered = steepness > 1
    if clustered.any():
        delta = _bisect(lambda d: np.sinh(d) / d, steepness[clustered], 1e-6, _STEEPEST)[:, None]
        u[clustered] = (1 + np.tanh(delta * (s - 0.5)) / np.tanh(delta / 2)) / 2
    if not clustered.all():
        delta = _bisect(lambda d: -np.sin(d) / d, -steepness[~clustered], 1e-6, np.pi - 1e-6)[:, None]
        u[~clustered] = (1 + np.tan(delta * (s - 0.5)) / np.tan(delta / 2)) / 2
    result: Array = u / (ratio[:, None] + (1 - ratio[:, None]) * u)
    result[:, 0], result[:, -1] = 0.0, 1.0
    return result


def _fractions(step: Array) -> Array:
    """Return the ends of cells over the length of all."""
    ends = np.concatenate((np.zeros((len(step), 1)), np.cumsum(step, axis=1)), axis=1)
    return np.asarray(ends / ends[:, -1:])
