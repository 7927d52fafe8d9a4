"""The second derivatives of the energy of one block: in its nodes, and mixed with what the density is given."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from ..arrays import Array
from ..functionals.definition import Functional
from ..functionals.variant import Modes
from ..runtime import KernelSet, kernels
from ..solvers.problem import Problem
from ..solvers.sliding.springs import add_spring_gradient
from .corners import OFFSETS, sum_at_nodes
from .lag import Slopes, slopes_of_held


@dataclass(slots=True, eq=False)
class BlockDerivatives:
    """Products with the derivatives of the gradient of one block's energy, in all its nodes; nothing is pinned.

    The gradient is what vanishes at the minimum. Of values that are held while the nodes move it is the gradient with
    these held; since they are evaluated again where the nodes come to, its derivative is not symmetric.

    Attributes:
        problem: with values at `coordinates`.
        functional: what was minimized.
        parameters: its values, where they are not the defaults.
        coordinates: (2, ni, nj).
    """

    problem: Problem
    functional: Functional
    parameters: Mapping[str, float] | None
    coordinates: Array
    _mixed: KernelSet | None = None
    _slopes: Slopes = field(init=False)

    def __post_init__(self) -> None:
        """Evaluate what is held at the present nodes, and how that changes as these move."""
        self.problem.follow(self.coordinates)
        self.problem.refresh(self.coordinates)
        self._slopes = slopes_of_held(self.problem, self.coordinates)

    @property
    def shape(self) -> tuple[int, int]:
        """The numbers of nodes."""
        return self.coordinates.shape[1], self.coordinates.shape[2]

    @property
    def symmetric(self) -> bool:
        """Whether the derivative of the gradient is symmetric: nothing is held that changes with the nodes."""
        return not self._slopes

    def gradient(self) -> Array:
        """Return the gradient in all nodes (2, ni, nj), also those that stay."""
        problem = self.problem
        values, inner = problem.values(self.coordinates), problem.interior_only
        found = problem.kernels.energy_gradient(self.coordinates, values, problem.steps, interior_only=inner)[2]
        add_spring_gradient(problem.slide, self.coordinates, found)
        return found

    def symmetric_product(self, vector: Array) -> Array:
        """Return the derivative of the gradient with held values times a vector (2, ni, nj)."""
        problem = self.problem
        values, inner = problem.values(self.coordinates), problem.interior_only
        vector = np.ascontiguousarray(vector)
        product = problem.kernels.hessian_vector(self.coordinates, vector, values, problem.steps, interior_only=inner)
        add_spring_gradient(problem.slide, vector, product)  # It is linear.
        return product

    def product(self, vector: Array) -> Array:
        """Return the derivative of the gradient along a displacement of the nodes."""
        found = self.symmetric_product(vector)
        if self._slopes:
            found += self.mixed_along({name: self._moved(pair, vector) for name, pair in self._slopes.items()}, {})
        return found

    def transposed(self, vector: Array) -> Array:
        """Return the transpose of that derivative times a vector."""
        found = self.symmetric_product(vector)
        if self._slopes:
            planes, _ = self.mixed(vector)
            for name, pair in self._slopes.items():
                found += pair * sum_at_nodes(planes[name])
        return found

    def _moved(self, slopes: Array, vector: Array) -> Array:
        nodes = (slopes * vector).sum(axis=0)
        ni, nj = self.shape
        return np.stack([nodes[i : ni - 1 + i, j : nj - 1 + j] for i, j in OFFSETS])

    def mixed(self, vector: Array) -> tuple[dict[str, Array], dict[str, Array]]:
        """Return the derivatives of the gradient times a vector in what is given, at every corner (4, ni-1, nj-1).

        Returns:
            By the names of planes; and by those of parameters.
        """
        kernel, values = self._kernel(), self.problem.values(self.coordinates)
        found = kernel.mixed(
            self.coordinates,
            np.ascontiguousarray(vector),
            values if kernel.planes else None,
            self.problem.steps,
            interior_only=self.problem.interior_only,
        )
        planes = dict(zip(kernel.planes, found, strict=False))
        return planes, dict(zip(self.functional.parameters, found[len(planes) :], strict=True))

    def mixed_along(self, planes: Mapping[str, Array], parameters: Mapping[str, float]) -> Array:
        """Return the derivative of the gradient (2, ni, nj) along changes of what is given.

        Every cell has one node of each of four colors: the rows of the matrix of mixed derivatives come from products
        with vectors of one color.

        Args:
            planes: changes (4, ni-1, nj-1) at the corners, by the names of planes.
            parameters: changes of parameters.
        """
        result = np.zeros((2, *self.shape))
        if not planes and not parameters:
            return result
        for color in range(4):
            a, b = color % 2, color // 2
            for component in range(2):
                vector = np.zeros_like(result)
                vector[component, a::2, b::2] = 1.0
                by_plane, by_parameter = self.mixed(vector)
                cells = sum(
                    (np.einsum("mij,mij->ij", by_plane[name], change) for name, change in planes.items()),
                    np.zeros((self.shape[0] - 1, self.shape[1] - 1)),
                )
                for name, number in parameters.items():
                    cells = cells + number * by_parameter[name].sum(axis=0)
                for i, j in OFFSETS:
                    p, q = (a - i) % 2, (b - j) % 2
                    part = cells[p::2, q::2]
                    result[component, p + i : p + i + 2 * part.shape[0] : 2, q + j : q + j + 2 * part.shape[1] : 2] += (
                        part
                    )
        return result

    def _kernel(self) -> KernelSet:
        if self._mixed is None:
            own = self.problem.kernels
            variant = replace(Modes.read(own.variant), mixed=True).variant
            self._mixed = kernels(self.functional, variant, self.parameters, own.backend)
        return self._mixed
