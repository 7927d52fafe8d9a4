"""What Newton's method on equations needs of them, on one block or several."""

from __future__ import annotations

from typing import Any, Protocol

from ...arrays import Array


class System(Protocol):
    """Equations of the coordinates of a grid, and the best grids that an iteration has seen.

    A residual, a step and the coordinates are arrays; only the equations know what their axes are.

    Attributes:
        best: of all grids (False) and of the valid ones (True): the residual's norm and the coordinates.
    """

    best: dict[bool, tuple[float, Array]]

    @property
    def barrier(self) -> bool:
        """Whether the energy is infinite where J = 0."""
        ...

    @property
    def equation_type(self) -> str:
        """`elliptic`, or what the equations are instead."""
        ...

    def residual(self, coordinates: Array) -> Array:
        """Return the residual."""
        ...

    def norm(self, residual: Array) -> float:
        """Return the norm of a residual."""
        ...

    def round_off(self, coordinates: Array) -> float:
        """Return the norm below which a residual cannot be distinguished from zero."""
        ...

    def smallest(self, coordinates: Array) -> float:
        """Return the smallest Jacobian."""
        ...

    def refresh(self, coordinates: Array) -> None:
        """Evaluate what is held while the nodes move."""
        ...

    def direction(self, coordinates: Array, residual: Array) -> Array:
        """Return Newton's step; NaN where the Jacobian is singular."""
        ...

    @property
    def width(self) -> int:
        """About how many nodes lie along a line across the grid."""
        ...

    def sweep(self, coordinates: Array, factor: float) -> None:
        """Relax all nodes once, in place, with frozen coefficients; steps are longer by a factor."""
        ...

    def linearized(self, coordinates: Array, residual: Array) -> tuple[Any, Array]:
        """Return the Jacobian as a sparse matrix, and the residual as a vector of unknowns."""
        ...

    def field(self, vector: Array) -> Array:
        """Return a vector of unknowns as a step of the coordinates."""
        ...

    def remember(self, coordinates: Array, norm: float) -> float:
        """Keep the grid if it is the best so far, or the best valid one; return its smallest Jacobian."""
        ...
