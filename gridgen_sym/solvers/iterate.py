"""Iterates: a grid, its energy and its gradient."""

from __future__ import annotations

from dataclasses import dataclass, field

from ..arrays import Array
from .energy_problem import EnergyProblem


@dataclass(slots=True)
class Iterate:
    """A grid that a solver has reached, with its energy and gradient.

    Attributes:
        problem: what is minimized.
        coordinates: in the problem's shape, changed in place by whoever moves; `evaluate` then renews the rest.
        energy: of the grid.
        smallest: Jacobian of all corners.
        gradient: of that shape, zero at fixed nodes.
        norm: of the gradient.
    """

    problem: EnergyProblem
    coordinates: Array
    energy: float = field(init=False)
    smallest: float = field(init=False)
    gradient: Array = field(init=False)
    norm: float = field(init=False)

    def __post_init__(self) -> None:
        """Evaluate the problem, with the weight that it has."""
        self.energy, self.smallest, self.gradient = self.problem.energy_gradient(self.coordinates)
        self.norm = self.problem.norm(self.gradient)

    def evaluate(self) -> None:
        """Evaluate the problem anew, and its weight, because the coordinates have changed."""
        self.problem.refresh(self.coordinates)
        self.energy, self.smallest, _ = self.problem.energy_gradient(self.coordinates, out=self.gradient)
        self.norm = self.problem.norm(self.gradient)
