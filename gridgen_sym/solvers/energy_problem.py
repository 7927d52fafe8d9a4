"""What Newton's method needs of a problem, whether its unknowns are one array of nodes or several blocks."""

from __future__ import annotations

from typing import Any, Protocol

from ..arrays import Array
from .linear.solution import LinearSolver


class KernelFacts(Protocol):
    """What is known of a functional beside its values; see `KernelSet`."""

    @property
    def barrier(self) -> bool:
        """Whether the energy is infinite where J = 0."""

    @property
    def polyconvex(self) -> bool:
        """Whether the semidefinite Hessian is so by derivation."""


class EnergyProblem(Protocol):
    """Energy, gradient and Hessian as functions of coordinates, an array whose shape is the problem's own.

    Gradients have the shape of the coordinates, and are zero at fixed nodes.
    """

    @property
    def kernels(self) -> KernelFacts:
        """Facts of the functional."""

    @property
    def lags(self) -> bool:
        """Whether values are held while nodes move, and evaluated again where they come to."""

    def refresh(self, coordinates: Array) -> None:
        """Evaluate what the density is given at the nodes' present positions."""

    def exists_at(self, coordinates: Array) -> bool:
        """Return whether everything that the density is given can be evaluated at coordinates."""

    def energy(self, coordinates: Array) -> tuple[float, float]:
        """Return the energy and the smallest Jacobian."""

    def energy_gradient(self, coordinates: Array, out: Array | None = None) -> tuple[float, float, Array]:
        """Return the energy, the smallest Jacobian and the gradient, in `out` if that is given."""

    def hessian(self, coordinates: Array, *, semidefinite: bool = False, out: Any = None) -> Any:  # noqa: ANN401
        """Return the Hessian as its solver takes it; `out` may be one that was returned before."""

    def shift(self, hessian: Any, part: float) -> None:  # noqa: ANN401
        """Add to the diagonal of a Hessian, in place, this part of its mean size."""

    def solver(self) -> LinearSolver:
        """Return what solves the linear systems."""

    def retract(self, coordinates: Array, *, trial: bool = False) -> None:
        """Put sliding nodes back on their curves, in place."""

    def follow(self, coordinates: Array) -> None:
        """Take sliding nodes from where they are in coordinates, on their curves."""

    def inner(self, first: Array, second: Array) -> float:
        """Return the inner product of a gradient and a step, every node counted once."""

    def norm(self, gradient: Array) -> float:
        """Return the norm of a gradient."""

    def gradient_scale(self, coordinates: Array, energy: float) -> float:
        """Return the norm of the gradient of such an energy on a grid far from its minimum."""

    def mean_jacobian(self, coordinates: Array) -> float:
        """Return the mean of the absolute Jacobians of the corners."""

    def round_off(self, coordinates: Array, gradient: Array) -> float:
        """Return the norm below which the gradient cannot be distinguished from zero."""
