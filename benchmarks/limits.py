"""The limits of the machine, and the hand-written Winslow kernels: what generated kernels are held to."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import Any

import numpy as np
from measure import FOLDER, fastest

from gridgen_sym.arrays import Array
from gridgen_sym.runtime import compile_library

_ELEMENTS, _ROUNDS = 16_000_000, 2_000_000
_BYTES = 32


@dataclass(frozen=True, slots=True)
class Limits:
    """Bytes, floating-point operations and divisions per second."""

    bandwidth: float
    multiply_adds: float
    divisions: float


def measure_limits(threads: int) -> Limits:
    """Measure the limits with this many threads; the bandwidth counts the read that a write makes."""
    library = _library("limits")
    a, b, c = np.zeros(_ELEMENTS), np.ones(_ELEMENTS), np.ones(_ELEMENTS)
    sink = ctypes.c_double()
    library.triad.argtypes = [ctypes.c_int64, *[ctypes.c_void_p] * 3, ctypes.c_double, ctypes.c_int64]

    def triad() -> None:
        library.triad(_ELEMENTS, a.ctypes.data, b.ctypes.data, c.ctypes.data, 3.0, threads)

    def rate(name: str) -> float:
        function = getattr(library, name)
        function.argtypes, function.restype = [ctypes.c_int64, ctypes.c_int64, ctypes.c_void_p], ctypes.c_double
        done = function(1000, threads, ctypes.byref(sink)) / 1000 * _ROUNDS
        return done / fastest(lambda: function(_ROUNDS, threads, ctypes.byref(sink)), runs=7).wall

    return Limits(_ELEMENTS * _BYTES / fastest(triad, runs=10).wall, rate("multiply_adds"), rate("divisions"))


class Handwritten:
    """The hand-written kernels on one grid, with preallocated results."""

    def __init__(self, coordinates: Array, threads: int) -> None:
        """Load; `coordinates` is (2, ni, nj)."""
        self._library = _library("handwritten")
        self._library.winslow_energy.argtypes = [*[ctypes.c_int64] * 2, *[ctypes.c_void_p] * 4, ctypes.c_int64]
        self._library.winslow_energy_gradient.argtypes = [*[ctypes.c_int64] * 2, *[ctypes.c_void_p] * 5, ctypes.c_int64]
        self._library.winslow_hessian_vector.argtypes = [*[ctypes.c_int64] * 2, *[ctypes.c_void_p] * 4, ctypes.c_int64]
        self._coordinates, self._threads = coordinates, threads
        self._rows = np.empty((2, coordinates.shape[1] - 1))
        self.gradient, self.product = np.empty_like(coordinates), np.empty_like(coordinates)

    def energy(self) -> float:
        """Return the energy."""
        self._library.winslow_energy(*self._arguments(), self._threads)
        return float(self._rows[0].sum())

    def energy_gradient(self) -> float:
        """Return the energy; the gradient is in `gradient`."""
        self._library.winslow_energy_gradient(*self._arguments(), self.gradient.ctypes.data, self._threads)
        return float(self._rows[0].sum())

    def hessian_vector(self) -> None:
        """Multiply the Hessian by the coordinates; the result is in `product`."""
        ni, nj, x, y, *_ = self._arguments()
        vector, product = self._coordinates.ctypes.data, self.product.ctypes.data
        self._library.winslow_hessian_vector(ni, nj, x, y, vector, product, self._threads)

    def _arguments(self) -> tuple[Any, ...]:
        _, ni, nj = self._coordinates.shape
        planes = (self._coordinates[0], self._coordinates[1], self._rows[0], self._rows[1])
        return (ni, nj, *(plane.ctypes.data for plane in planes))


def _library(name: str) -> ctypes.CDLL:
    return ctypes.CDLL(str(compile_library(f"benchmark_{name}", (FOLDER / f"{name}.c").read_text(encoding="utf-8"))))
