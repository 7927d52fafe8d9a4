"""Krylov methods preconditioned by a geometric multigrid cycle, on the stencils of any ni x nj grid.

Coarse grids keep every second node and the last one. Where couplings along one direction are far weaker, as on
stretched grids, only the other direction is halved, until they are alike. The compiled part is `multigrid.c`, which
knows no functional.
"""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..runtime import Array, Mask, compile_library, thread_count
from ..runtime.kernels import HESSIAN_PLANES, JACOBIAN_PLANES
from .linear import Solution

#: A direction with this many nodes is not halved further.
_COARSEST = 4
_MOST_ITERATIONS = 200
_NODES_PER_THREAD = 16384
#: A direction whose couplings are weaker than this part of the other's is not halved.
_WEAK = 0.25


class _Layout(NamedTuple):
    """Where things stand among the planes of a stencil.

    Attributes:
        planes: their number.
        center: the entry xx of a node's block with itself.
        couplings: the entries xx and yy of the block with the next node along xi, and of that along eta.
    """

    planes: int
    center: int
    couplings: tuple[tuple[int, int], tuple[int, int]]


_SYMMETRIC = _Layout(HESSIAN_PLANES, 0, ((3, 6), (7, 10)))
_GENERAL = _Layout(JACOBIAN_PLANES, 16, ((28, 31), (20, 23)))


class _Level(ctypes.Structure):
    """One level, as `multigrid.c` declares it."""

    _fields_ = (
        ("ni", ctypes.c_int64),
        ("nj", ctypes.c_int64),
        ("threads", ctypes.c_int64),
        *((name, ctypes.c_void_p) for name in ("operator", "inverse", "right", "solution", "residual", "fixed")),
    )


@dataclass(frozen=True, slots=True)
class _Arrays:
    """The memory of one level, in single precision."""

    fixed: Mask
    operator: Any
    inverse: Any
    right: Any
    solution: Any
    residual: Any

    @classmethod
    def allocate(cls, fixed: Mask, planes: int) -> _Arrays:
        """Allocate for the nodes of a mask; vectors are zero at the boundary, and stay so."""
        operator, inverse = (np.empty((count, *fixed.shape), dtype=np.float32) for count in (planes, 4))
        return cls(fixed, operator, inverse, *(np.zeros((2, *fixed.shape), dtype=np.float32) for _ in range(3)))

    def level(self) -> _Level:
        """Return it as the compiled code sees it."""
        arrays = (self.operator, self.inverse, self.right, self.solution, self.residual, self.fixed)
        return _Level(*self.fixed.shape, _threads(self.fixed.size), *(array.ctypes.data for array in arrays))


class _Hierarchy:
    """The levels of one grid: planned and allocated for the first stencil, set up anew for every one."""

    def __init__(self, fixed: Mask, *, general: bool) -> None:
        """Keep the fixed nodes (the boundary among them); `general` stencils have 36 planes, symmetric ones 19."""
        self._fixed = np.ascontiguousarray(fixed)
        self._library = _library(general)
        self._layout = _GENERAL if general else _SYMMETRIC
        self._arrays: list[_Arrays] = []
        self._levels: Any = None
        self._operator: Array | None = None
        self._size = 1.0

    def set_operator(self, planes: Array) -> bool:
        """Take the planes of a stencil, in which couplings with fixed nodes are cut in place.

        Returns:
            Whether the diagonal blocks of all levels are usable: regular, and positive definite if symmetric. Only
            then may `solve` be called.
        """
        self._library.decouple(*self._fixed.shape, planes.ctypes.data, self._fixed.ctypes.data)
        self._operator = planes
        self._size = size = float(np.abs(planes[self._layout.center]).mean())
        if not 0 < size < np.inf:
            return False
        if not self._arrays:
            self._arrays.append(_Arrays.allocate(self._fixed, self._layout.planes))
        finest = self._arrays[0].operator
        self._library.to_single(
            planes.size, planes.ctypes.data, finest.ctypes.data, 1 / size, _threads(self._fixed.size)
        )
        if self._levels is None:
            self._plan()
        else:
            for fine, coarse in pairwise(self._arrays):
                self._coarsen(fine, coarse)
        return not any(self._library.invert_diagonal(ctypes.byref(level)) for level in self._levels)

    def _plan(self) -> None:
        """Choose and set up the coarser levels: a direction is halved unless its couplings are the far weaker ones."""
        while max(self._arrays[-1].fixed.shape) > _COARSEST:
            fine = self._arrays[-1]
            coarse = _Arrays.allocate(_coarse_mask(fine.fixed, self._directions(fine)), self._layout.planes)
            self._coarsen(fine, coarse)
            self._arrays.append(coarse)
        self._levels = (_Level * len(self._arrays))(*(arrays.level() for arrays in self._arrays))

    def _directions(self, level: _Arrays) -> tuple[bool, bool]:
        """Return which directions of a level to halve, rows and columns.

        A point smoother leaves errors that are rough along weak couplings, which a coarser grid cannot hold.
        """
        rows, columns = (
            float(sum(np.abs(level.operator[plane]).mean() for plane in pair)) for pair in self._layout.couplings
        )
        large = tuple(count > _COARSEST for count in level.fixed.shape)
        wanted = rows > _WEAK * columns, columns > _WEAK * rows
        halved = large[0] and wanted[0], large[1] and wanted[1]
        return halved if any(halved) else (large[0], large[1])

    def _coarsen(self, fine: _Arrays, coarse: _Arrays) -> None:
        """Set up Galerkin's operator of a level from the one above, one direction at a time."""
        (fine_ni, fine_nj), (ni, nj) = fine.fixed.shape, coarse.fixed.shape
        threads = _threads(fine.fixed.size)
        rows = fine.operator
        if ni != fine_ni:
            rows = coarse.operator if nj == fine_nj else np.empty((self._layout.planes, ni, fine_nj), dtype=np.float32)
            self._library.coarsen_rows(fine_ni, fine_nj, fine.operator.ctypes.data, ni, rows.ctypes.data, threads)
        if nj != fine_nj:
            self._library.coarsen_columns(ni, fine_nj, rows.ctypes.data, nj, coarse.operator.ctypes.data, threads)


class Multigrid(_Hierarchy):
    """Conjugate gradients with one V-cycle as the preconditioner, for the stored half (19, ni, nj) of a Hessian."""

    def __init__(self, fixed: Mask) -> None:
        """Allocate for a grid with these fixed nodes (its boundary among them)."""
        super().__init__(fixed, general=False)
        self._work = np.empty(8 * fixed.size + fixed.shape[0])

    def solve(self, right: Array, tolerance: float) -> Solution:
        """Solve for a right-hand side (2, ni, nj) that is zero at fixed nodes, to a relative residual."""
        solution, reduction = np.empty_like(right), ctypes.c_double(0.0)
        iterations = self._library.conjugate_gradients(
            self._levels,
            len(self._levels),
            np.ascontiguousarray(right).ctypes.data,
            solution.ctypes.data,
            self._work.ctypes.data,
            tolerance,
            _MOST_ITERATIONS,
            ctypes.byref(reduction),
        )
        solution /= self._size
        return Solution(solution, abs(iterations), reduction.value, iterations > 0)


class GeneralMultigrid(_Hierarchy):
    """BiCGStab with one V-cycle as the preconditioner, for the 36 planes of the Euler-Lagrange Jacobian."""

    def __init__(self, fixed: Mask) -> None:
        """Allocate for a grid with these fixed nodes (its boundary among them)."""
        super().__init__(fixed, general=True)
        self._row = np.empty(fixed.shape[0])

    def solve(self, right: Array, tolerance: float) -> Solution:
        """Solve for a right-hand side (2, ni, nj) that is zero at fixed nodes, to a relative residual."""
        from scipy.sparse.linalg import LinearOperator, bicgstab

        products = 0

        def multiply(vector: Array) -> Array:
            nonlocal products
            products += 1
            assert self._operator is not None
            result = np.zeros(right.size)
            self._library.apply_operator(
                self._levels, *(a.ctypes.data for a in (self._operator, vector, result, self._row))
            )
            return result

        def cycle(vector: Array) -> Array:
            result = np.zeros(right.size)
            arrays = (vector, result, self._row)
            self._library.apply_cycle(self._levels, len(self._levels), *(a.ctypes.data for a in arrays))
            return result

        shape = (right.size, right.size)
        solution, _ = bicgstab(
            LinearOperator(shape, matvec=lambda v: multiply(np.ascontiguousarray(v)), dtype=float),
            right.ravel(),
            rtol=tolerance,
            maxiter=_MOST_ITERATIONS // 2,
            M=LinearOperator(shape, matvec=lambda v: cycle(np.ascontiguousarray(v)), dtype=float),
        )
        reduction = float(np.linalg.norm(multiply(solution) - right.ravel()) / np.linalg.norm(right))
        return Solution(solution.reshape(right.shape), products, reduction, np.isfinite(reduction) and reduction < 1)


def _coarse_mask(fixed: Mask, halved: tuple[bool, bool]) -> Mask:
    """Return the mask of fixed nodes with every second row, column or both, and the last ones."""
    rows, columns = (
        [*range(0, count - 1, 2), count - 1] if half else list(range(count))
        for count, half in zip(fixed.shape, halved, strict=True)
    )
    return np.ascontiguousarray(fixed[np.ix_(rows, columns)])


def _threads(nodes: int) -> int:
    return max(1, min(thread_count(), nodes // _NODES_PER_THREAD))


@lru_cache(maxsize=2)
def _library(general: bool) -> ctypes.CDLL:
    """Compile `multigrid.c` for symmetric or for general stencils."""
    source = f"#define GENERAL {int(general)}\n" + Path(__file__).with_suffix(".c").read_text(encoding="utf-8")
    library = ctypes.CDLL(str(compile_library("multigrid_general" if general else "multigrid", source)))
    pointer, integer, number = ctypes.c_void_p, ctypes.c_int64, ctypes.c_double
    signatures = {
        "decouple": [integer, integer, pointer, pointer],
        "to_single": [integer, pointer, pointer, number, integer],
        "coarsen_rows": [integer, integer, pointer, integer, pointer, integer],
        "coarsen_columns": [integer, integer, pointer, integer, pointer, integer],
        "invert_diagonal": [pointer],
    }
    if general:
        signatures |= {"apply_operator": [pointer] * 5, "apply_cycle": [pointer, integer, pointer, pointer, pointer]}
    else:
        signatures["conjugate_gradients"] = [pointer, integer, pointer, pointer, pointer, number, integer, pointer]
    for name, kinds in signatures.items():
        function = getattr(library, name)
        function.argtypes = kinds
        function.restype = integer if name in ("invert_diagonal", "conjugate_gradients") else None
    return library
