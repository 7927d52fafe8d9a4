"""The one object that solvers hold: the kernels of one functional, on one backend."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import Array, Mask
from ..errors import GridgenError
from ..functionals.variant import Variant
from .block import Block
from .threads import threads_for
from .values import Values

#: Steps of the logical coordinates with which the index of a node is its coordinate.
INDEX_STEPS = (1.0, 1.0)
#: Number of planes of the stored half of the Hessian, and of the Jacobian of the Euler-Lagrange residual.
HESSIAN_PLANES, JACOBIAN_PLANES = 19, 36
#: What a functional is given that names no values.
_NONE = Values.of((), (0, 0))
_TYPES = (np.dtype(np.float64), np.dtype(np.uint8))


@dataclass(frozen=True, slots=True)
class KernelSet:
    """The kernels of one functional in one variant, with parameter values, on one backend.

    Coordinates are arrays (2, ni, nj), C-contiguous: the planes x and y. `values` are those of the weight and of other
    fields, in the order of `planes`: a `Values`, an array (len(planes), ni, nj), or None where there are none.

    `spacing` are the steps (h_xi, h_eta) of the logical coordinates between nodes. The energy is h_xi h_eta times the
    sum, over the corners, of the corner energy of the edge vectors over the steps; it tends to 4 `corner_factor` times
    the integral of the density. With the steps (1, 1) it is the sum over the index. Jacobians are those of the edges
    themselves, whatever the steps.

    Attributes:
        functional: its name.
        variant: how the weight, fields and a target enter, or `regularized`.
        backend: name of what runs them.
        barrier: whether the energy is infinite where J = 0.
        equation_type: type of the Euler-Lagrange equations where J > 0, `elliptic` or what they are instead.
        null_lagrangian: whether the energy, over all corners, is the same for every grid with the same boundary.
        polyconvex: whether the semidefinite Hessian is so by derivation, not by clamped eigenvalues.
        planes: names of the planes of values.
        moving: whether they move with the nodes.
        operations: number of arithmetic operations of each program.
    """

    functional: str
    variant: Variant
    backend: str
    barrier: bool
    equation_type: str
    null_lagrangian: bool
    polyconvex: bool
    planes: tuple[str, ...]
    moving: bool
    operations: Mapping[str, int]
    _parameters: Array
    _functions: Mapping[str, Callable[..., None]]

    def energy(
        self,
        coordinates: Array,
        values: Values | Array | None = None,
        spacing: tuple[float, float] = INDEX_STEPS,
        *,
        interior_only: bool = False,
    ) -> tuple[float, float]:
        """Return the energy, summed over corners, and the smallest Jacobian of any corner, counted or not."""
        rows = np.empty((2, coordinates.shape[1] - 1))
        self._call("energy", coordinates, values, rows[0], rows[1], interior_only=interior_only, spacing=spacing)
        return _total(rows[0]), float(rows[1].min())

    def smallest_jacobians(self, coordinates: Array) -> Array:
        """Return the smallest Jacobian of the corners of each row of cells, (ni - 1,); values have no part in it."""
        energies, smallest = np.empty(coordinates.shape[1] - 1), np.empty(coordinates.shape[1] - 1)
        values = np.zeros((len(self.planes), *coordinates.shape[1:]))
        values[:1] = 1.0
        with np.errstate(all="ignore"):  # The energies, which have no use here, need not be numbers.
            self._call("energy", coordinates, values, energies, smallest)
        return smallest

    def energy_gradient(
        self,
        coordinates: Array,
        values: Values | Array | None = None,
        spacing: tuple[float, float] = INDEX_STEPS,
        *,
        interior_only: bool = False,
        out: Array | None = None,
    ) -> tuple[float, float, Array]:
        """Return the energy, the smallest Jacobian, and the gradient (2, ni, nj) in all nodes (written to `out`)."""
        rows, gradient = np.empty((2, coordinates.shape[1] - 1)), _result(2, coordinates, out)
        arrays = rows[0], rows[1], gradient
        self._call("energy_gradient", coordinates, values, *arrays, interior_only=interior_only, spacing=spacing)
        return _total(rows[0]), float(rows[1].min()), gradient

    def hessian(
        self,
        coordinates: Array,
        values: Values | Array | None = None,
        spacing: tuple[float, float] = INDEX_STEPS,
        *,
        semidefinite: bool = False,
        interior_only: bool = False,
        out: Array | None = None,
    ) -> Array:
        """Return the stored half of the block Hessian, (19, ni, nj).

        The block of node (i, j) with itself (xx, xy, yy), then with (i+1, j), (i, j+1), (i+1, j+1), (i+1, j-1)
        (xx, xy, yx, yy each). With `out`, it is written there.
        """
        planes = _result(HESSIAN_PLANES, coordinates, out)
        name = "semidefinite_hessian" if semidefinite else "hessian"
        self._call(name, coordinates, values, planes, interior_only=interior_only, spacing=spacing)
        return planes

    def hessian_vector(
        self,
        coordinates: Array,
        vector: Array,
        values: Values | Array | None = None,
        spacing: tuple[float, float] = INDEX_STEPS,
        *,
        semidefinite: bool = False,
        interior_only: bool = False,
        out: Array | None = None,
    ) -> Array:
        """Return the Hessian times a vector (2, ni, nj), without storing the Hessian; with `out`, it is written there.

        Raises:
            GridgenError: for the semidefinite Hessian of a functional that is not polyconvex: its eigenvalues are
                clamped, which has no short cut.
        """
        if vector.shape != coordinates.shape:
            raise GridgenError(f"the vector must have the shape {coordinates.shape}; came {vector.shape}")
        if semidefinite and not self.polyconvex:
            raise GridgenError(
                f"{self.functional} is not polyconvex: its semidefinite Hessian must be stored, with "
                "hessian(semidefinite=True), to be multiplied by a vector"
            )
        product = _result(2, coordinates, out)
        name = "semidefinite_hessian_vector" if semidefinite else "hessian_vector"
        self._call(name, coordinates, values, vector, product, interior_only=interior_only, spacing=spacing)
        return product

    def mixed(
        self,
        coordinates: Array,
        vector: Array,
        values: Values | Array | None = None,
        spacing: tuple[float, float] = INDEX_STEPS,
        *,
        interior_only: bool = False,
    ) -> Array:
        """Return mixed derivatives at every corner: of the gradient times a vector (2, ni, nj), in what is given.

        Of a variant with `mixed`. An array (planes and then parameters, 4, ni-1, nj-1), corners as in `Values.corners`.
        """
        if vector.shape != coordinates.shape:
            raise GridgenError(f"the vector must have the shape {coordinates.shape}; came {vector.shape}")
        _, ni, nj = coordinates.shape
        mixed = np.empty((len(self.planes) + len(self._parameters), 4, ni - 1, nj - 1))
        self._call("mixed", coordinates, values, vector, mixed, interior_only=interior_only, spacing=spacing)
        return mixed

    def sweep(
        self,
        coordinates: Array,
        values: Values | Array | None,
        fixed: Mask,
        color: int,
        spacing: tuple[float, float] = INDEX_STEPS,
        *,
        floor: float,
        reach: float = np.inf,
        interior_only: bool = False,
    ) -> float:
        """Move every free node of a color (i % 2 + 2 (j % 2)) by one damped Newton step on its local energy.

        No step takes the Jacobian of a corner from above `floor` to below it; a negative floor lets cells fold.

        Returns:
            The largest component of a step; a node whose step would be `reach` or more stays, but is counted.
        """
        steps = np.zeros(coordinates.shape[1])
        arguments = fixed, color, floor, reach, steps
        self._call("sweep", coordinates, values, *arguments, interior_only=interior_only, spacing=spacing)
        return float(steps.max())

    def euler_lagrange_residual(
        self,
        coordinates: Array,
        values: Values | Array | None = None,
        spacing: tuple[float, float] = INDEX_STEPS,
        *,
        out: Array | None = None,
    ) -> Array:
        """Return the residual (2, ni, nj) of the equations, by central differences; zero at the boundary nodes.

        With `out`, it is written there.
        """
        residual = _zero_at_boundary(_result(2, coordinates, out))
        self._call("euler_lagrange_residual", coordinates, values, residual, spacing=spacing)
        return residual

    def euler_lagrange_jacobian(
        self,
        coordinates: Array,
        values: Values | Array | None = None,
        spacing: tuple[float, float] = INDEX_STEPS,
        *,
        frozen: bool = False,
        out: Array | None = None,
    ) -> Array:
        """Return the derivatives (36, ni, nj) of the residual in the nodes of its stencil; zero at the boundary nodes.

        Nine blocks in the order (i-1, j-1), (i-1, j), ..., (i+1, j+1), each xx, xy, yx, yy (equation, then
        coordinate). With `frozen`, the coefficients of the second derivatives are held. With `out`, it is
        written there.
        """
        jacobian = _zero_at_boundary(_result(JACOBIAN_PLANES, coordinates, out))
        name = "euler_lagrange_frozen_jacobian" if frozen else "euler_lagrange_jacobian"
        self._call(name, coordinates, values, jacobian, spacing=spacing)
        return jacobian

    def euler_lagrange_relaxation(
        self,
        coordinates: Array,
        values: Values | Array | None,
        fixed: Mask,
        color: int,
        relaxation: float,
        spacing: tuple[float, float] = INDEX_STEPS,
    ) -> None:
        """Relax the equations at every free node of a color, with frozen coefficients, in place."""
        self._call("euler_lagrange_relaxation", coordinates, values, fixed, color, relaxation, spacing=spacing)

    def on_blocks(self, name: str) -> Callable[..., None] | None:
        """Return what runs a kernel on many blocks in one call; None where the back end has no such thing."""
        run = getattr(self._functions.get(name), "on_blocks", None)
        if run is None:
            return None

        def with_parameters(blocks: Any, threads: int, coordinates: Any, values: Any, results: Any) -> None:  # noqa: ANN401
            run(blocks, threads, coordinates, values, self._parameters, results)

        return with_parameters

    def _call(
        self,
        name: str,
        coordinates: Array,
        values: Values | Array | None,
        *arguments: Any,  # noqa: ANN401
        interior_only: bool = False,
        spacing: tuple[float, float] = INDEX_STEPS,
    ) -> None:
        _, ni, nj = coordinates.shape
        given = self.checked_values(values, (ni, nj))
        if name.startswith("euler_lagrange"):
            given = given.at_nodes()
        for array in (coordinates, *arguments):
            # Compiled code does not check its memory: another type or order would silently give wrong numbers.
            if isinstance(array, np.ndarray) and not (array.flags.c_contiguous and array.dtype in _TYPES):
                raise GridgenError(
                    f"kernel {name} needs C-contiguous arrays of float64 (masks: uint8); came {array.dtype}, shape "
                    f"{array.shape}, strides {array.strides}: use np.ascontiguousarray(array, dtype=...)"
                )
        if name not in self._functions:
            raise GridgenError(
                f"the variant {self.variant!r} of {self.functional!r} has no kernel {name} on the backend "
                f"{self.backend!r}: use the variant 'plain', or another backend"
            )
        block = Block(ni, nj, 0, ni, nj, ni * nj, int(interior_only), threads_for(ni * nj), *spacing)
        self._functions[name](block, coordinates, given, self._parameters, *arguments)

    def checked_values(self, values: Values | Array | None, shape: tuple[int, int]) -> Values:
        """Return values as kernels read them.

        Raises:
            GridgenError: if there are more or fewer of them than the functional names, or of another grid.
        """
        if not self.planes:
            return _NONE
        if isinstance(values, Values):
            count, came = len(values.nodes), values.nodes[0].shape if values.nodes else shape
        else:
            planes = np.empty((0, *shape)) if values is None else values
            count, came = planes.shape[0], planes.shape[1:]
        if (count, *came) != (len(self.planes), *shape):
            raise GridgenError(
                f"the values of {self.functional} ({', '.join(self.planes)}) must have the shape "
                f"{(len(self.planes), *shape)}; came {(count, *came)}"
            )
        return values if isinstance(values, Values) else Values.of(planes, shape)


def _total(energies: Array) -> float:
    """Return the sum of energies; NaN, and not a warning, where infinite ones of both signs cancel."""
    with np.errstate(over="ignore", invalid="ignore"):
        return float(energies.sum())


def _result(count: int, coordinates: Array, out: Array | None) -> Array:
    """Return where a kernel writes (count, ni, nj) planes: `out` if it is given and has that shape, else new memory."""
    shape = (count, *coordinates.shape[1:])
    if out is not None and out.shape != shape:
        raise GridgenError(f"out must have the shape {shape}; came {out.shape}")
    return np.empty(shape) if out is None else out


def _zero_at_boundary(planes: Array) -> Array:
    """Set the boundary nodes of planes (n, ni, nj) to zero; the kernels write the others only."""
    planes[:, 0], planes[:, -1], planes[:, :, 0], planes[:, :, -1] = 0.0, 0.0, 0.0, 0.0
    return planes
