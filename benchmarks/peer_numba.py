"""Newton's method as one would write it in an afternoon: Numba kernels by hand, SciPy's SuperLU, a line search."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numba import njit
from peer_clock import Clock
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

from gridgen_sym.arrays import Array

#: Corners of a cell: offsets of the corner, of its neighbor along i and of that along j, and the sign of J.
CORNERS = ((0, 0, 1, 0, 0, 1, 1.0), (1, 0, 0, 0, 1, 1, -1.0), (0, 1, 1, 1, 0, 0, -1.0), (1, 1, 0, 1, 1, 0, 1.0))
_STEPS = 100


@njit(cache=False)
def _energy(x: Array, y: Array) -> tuple[float, float]:
    energy, smallest = 0.0, np.inf
    for i in range(x.shape[0] - 1):
        for j in range(x.shape[1] - 1):
            for oi, oj, ai, aj, bi, bj, sign in CORNERS:
                ax, ay = x[i + ai, j + aj] - x[i + oi, j + oj], y[i + ai, j + aj] - y[i + oi, j + oj]
                bx, by = x[i + bi, j + bj] - x[i + oi, j + oj], y[i + bi, j + bj] - y[i + oi, j + oj]
                jacobian = sign * (ax * by - ay * bx)
                energy += (ax * ax + ay * ay + bx * bx + by * by) / jacobian
                smallest = min(smallest, jacobian)
    return energy, smallest


@njit(cache=False)
def _derivatives(x: Array, y: Array, number: Any, gradient: Array, rows: Any, columns: Any, values: Array) -> int:
    """Add up the gradient over free nodes, and list the entries of the Hessian; returns how many."""
    h, g = np.empty((4, 4)), np.empty(4)
    local, unknown, place = np.empty((6, 6)), np.empty(6, dtype=np.int64), 0
    gradient[:] = 0.0
    for i in range(x.shape[0] - 1):
        for j in range(x.shape[1] - 1):
            for oi, oj, ai, aj, bi, bj, sign in CORNERS:
                ax, ay = x[i + ai, j + aj] - x[i + oi, j + oj], y[i + ai, j + aj] - y[i + oi, j + oj]
                bx, by = x[i + bi, j + bj] - x[i + oi, j + oj], y[i + bi, j + bj] - y[i + oi, j + oj]
                v = (ax, ay, bx, by)
                dj = (sign * by, -sign * bx, -sign * ay, sign * ax)
                r = 1.0 / (sign * (ax * by - ay * bx))
                s = ax * ax + ay * ay + bx * bx + by * by
                for k in range(4):
                    g[k] = 2.0 * v[k] * r - s * dj[k] * r * r
                    for m in range(4):
                        h[k, m] = 2.0 * r * r * (s * r * dj[k] * dj[m] - v[k] * dj[m] - dj[k] * v[m])
                    h[k, k] += 2.0 * r
                # J is bilinear: its second derivatives couple ax with by and ay with bx.
                second = sign * s * r * r
                h[0, 3] -= second
                h[3, 0] -= second
                h[1, 2] += second
                h[2, 1] += second
                for k in range(4):
                    for m in range(4):
                        local[2 + k, 2 + m] = h[k, m]
                for c in range(2):
                    for m in range(4):
                        local[c, 2 + m] = -h[c, m] - h[2 + c, m]
                        local[2 + m, c] = local[c, 2 + m]
                    for d in range(2):
                        local[c, d] = h[c, d] + h[c, 2 + d] + h[2 + c, d] + h[2 + c, 2 + d]
                    unknown[c] = number[i + oi, j + oj] * 2 + c
                    unknown[2 + c] = number[i + ai, j + aj] * 2 + c
                    unknown[4 + c] = number[i + bi, j + bj] * 2 + c
                for k in range(6):
                    if unknown[k] >= 0:
                        gradient[unknown[k]] += g[k - 2] if k >= 2 else -g[k] - g[2 + k]
                        for m in range(6):
                            if unknown[m] >= 0:
                                rows[place], columns[place], values[place] = unknown[k], unknown[m], local[k, m]
                                place += 1
    return place


@lru_cache(maxsize=2)
def _numbers(shape: tuple[int, int]) -> Any:
    number = np.full(shape, -1, dtype=np.int64)
    number[1:-1, 1:-1] = np.arange((shape[0] - 2) * (shape[1] - 2)).reshape(shape[0] - 2, shape[1] - 2)
    return number


def newton(planes: Array, clock: Clock) -> str:
    """Minimize from (2, ni, nj) coordinates; indefinite steps that lead uphill are replaced by their opposite."""
    number = _numbers(planes.shape[1:])
    unknowns = 2 * (planes.shape[1] - 2) * (planes.shape[2] - 2)
    entries = 144 * (planes.shape[1] - 1) * (planes.shape[2] - 1)
    clock.start()
    now, gradient = planes.copy(), np.empty(unknowns)
    rows, columns = np.empty(entries, dtype=np.int32), np.empty(entries, dtype=np.int32)
    values = np.empty(entries)
    energy, _ = _energy(now[0], now[1])
    for step in range(_STEPS):
        used = _derivatives(now[0], now[1], number, gradient, rows, columns, values)
        matrix = coo_matrix((values[:used], (rows[:used], columns[:used])), shape=(unknowns, unknowns)).tocsc()
        factors = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        direction = -factors.solve(gradient)
        slope = float(direction @ gradient)
        if slope > 0:
            direction, slope = -direction, -slope
        moves = np.zeros_like(now)
        moves[:, 1:-1, 1:-1] = direction.reshape(planes.shape[1] - 2, planes.shape[2] - 2, 2).transpose(2, 0, 1)
        length = 1.0
        while length > 1e-12:
            trial = now + length * moves
            found, smallest = _energy(trial[0], trial[1])
            if smallest > 0 and found <= energy + 1e-4 * length * slope + 1e-14 * abs(energy):
                break
            length *= 0.5
        now, energy = trial, found
        clock.stop()
        if clock.look(energy):
            return f"reached after {step + 1} steps"
        if -slope < 1e-15 * energy:
            break
        clock.start()
    return f"no further progress after {step + 1} steps"
