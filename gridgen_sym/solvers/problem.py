"""The discrete problem: the kernels of a functional bound to a weight, fixed nodes and a set of corners."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..arrays import Array, Mask
from ..errors import UnusableValueError
from ..fields.inputs import DensityInputs
from ..grids import corner_jacobians
from ..runtime import KernelSet, Values
from ..runtime.kernel_set import INDEX_STEPS
from .folds import Folds, mean_jacobian
from .harmonic import SIDES
from .linear.solution import LinearSolver
from .linear.systems import hessian_solver
from .norms import inner, mean_edge_length, norm_of, shortest_edges
from .sliding.slide import Slide
from .sliding.springs import add_spring_gradient, add_spring_hessian, spring_energy


@dataclass(slots=True)
class Problem:
    """Energy, gradient and Hessian as functions of the coordinates (2, ni, nj).

    Attributes:
        kernels: of the functional, in the variant that its inputs require.
        fixed: (ni, nj), non-zero at nodes that do not move; the boundary is fixed.
        inputs: the weight, fields and target that the density is given; None where it needs none.
        interior_only: sum over the corners at inner nodes only, as the paper prints it.
        guard_summed_only: the smallest Jacobian is that of the corners that are summed: others may fold.
        steps: h_xi and h_eta of the logical coordinates.
        slide: the boundary nodes that slide along curves, or None; they count as fixed elsewhere.
    """

    kernels: KernelSet
    fixed: Mask
    inputs: DensityInputs | None
    interior_only: bool = False
    guard_summed_only: bool = False
    steps: tuple[float, float] = INDEX_STEPS
    _values: Values | None = None
    slide: Slide | None = None
    _lengths: Array | None = None
    _inner_fixed: bool = field(init=False)

    def __post_init__(self) -> None:
        """Check once whether inner nodes are fixed: removing their entries takes far longer than those of the sides."""
        self._inner_fixed = bool(self.fixed[1:-1, 1:-1].any())

    @property
    def logical_area(self) -> float:
        """Area of the logical rectangle."""
        ni, nj = self.fixed.shape
        return float(self.steps[0] * (ni - 1) * self.steps[1] * (nj - 1))

    @property
    def lags(self) -> bool:
        """Whether something is held while the nodes move, and evaluated again where they come to."""
        return self.inputs is not None and self.inputs.lags

    def refresh(self, coordinates: Array) -> None:
        """Evaluate the weight and the fields at the nodes' present positions."""
        if self.inputs is not None and not (self._values is not None and self._is_settled):
            planes = self.inputs.planes(coordinates, self.kernels.planes, self.steps)
            self._values = Values.of(planes, (coordinates.shape[1], coordinates.shape[2]))

    @property
    def _is_settled(self) -> bool:
        """Whether the values do not depend on where the nodes are."""
        return self.inputs is not None and self.inputs.settled and not self.kernels.moving

    def values(self, coordinates: Array) -> Values | None:
        """Return what the density is given: as last refreshed where it is held, else at these coordinates."""
        if self.inputs is not None and (self._values is None or self.kernels.moving):
            self.refresh(coordinates)
        return self._values

    def corner_values(self, coordinates: Array) -> dict[str, Array]:
        """Return what the density is given at every corner of every cell, by name: corner after corner, as one row."""
        values = self.values(coordinates)
        if values is None:
            return {}
        planes = zip(self.kernels.planes, values.corners, strict=True)
        return {name: np.concatenate([view.ravel() for view in views]) for name, views in planes}

    def exists_at(self, coordinates: Array) -> bool:
        """Return whether everything that the density is given can be evaluated at coordinates."""
        return self.inputs is None or self.inputs.exists(coordinates, self.kernels.planes)

    def check_samples(self, coordinates: Array, *, folded: bool = False) -> None:
        """Refuse nodes outside the samples of what the density is given.

        The inner nodes of a `folded` grid may be anywhere, and are not looked at.

        Raises:
            UnusableValueError: naming the field, the node and the repair.
        """
        if self.inputs is not None:
            self.inputs.check_samples(coordinates, self.fixed != 0 if folded else None)

    def energy(self, coordinates: Array) -> tuple[float, float]:
        """Return the energy and the smallest Jacobian."""
        energy, smallest = self.kernels.energy(
            coordinates, self.values(coordinates), self.steps, interior_only=self.interior_only
        )
        return energy + spring_energy(self.slide, coordinates), self._guarded(coordinates, smallest)

    def energy_gradient(self, coordinates: Array, out: Array | None = None) -> tuple[float, float, Array]:
        """Return the energy, the smallest Jacobian and the gradient (2, ni, nj; in `out`), zero at fixed nodes."""
        energy, smallest, gradient = self.kernels.energy_gradient(
            coordinates, self.values(coordinates), self.steps, interior_only=self.interior_only, out=out
        )
        energy += spring_energy(self.slide, coordinates)
        add_spring_gradient(self.slide, coordinates, gradient)
        return energy, self._guarded(coordinates, smallest), self.pin(gradient)

    def _guarded(self, coordinates: Array, smallest: float) -> float:
        """Return the smallest Jacobian of the corners that must not fold, given that of all corners."""
        return smallest_inner_jacobian(coordinates) if self.guard_summed_only else smallest

    def pin(self, field: Array) -> Array:
        """Make a field (2, ni, nj) zero at the fixed nodes, and tangential at sliding ones, in place, and return it."""
        along = None if self.slide is None else self.slide.tangential(field)
        field[:, 0], field[:, -1], field[:, :, 0], field[:, :, -1] = 0.0, 0.0, 0.0, 0.0
        if self._inner_fixed:
            field[:, self.fixed != 0] = 0.0
        if self.slide is not None:
            field[:, *self.slide.nodes] = along
        return field

    def retract(self, coordinates: Array, *, trial: bool = False) -> None:
        """Put sliding nodes back on their curves, in place; a `trial` may be refused."""
        if self.slide is not None:
            self.slide.retract(coordinates, trial=trial)

    def follow(self, coordinates: Array) -> None:
        """Take the sliding nodes from where they are in coordinates, on their curves."""
        if self.slide is not None:
            self.slide.follow(coordinates)

    @property
    def held(self) -> Mask:
        """The mask of nodes without unknowns: of the fixed ones those that do not slide."""
        return self.fixed if self.slide is None else self.slide.mask(self.fixed)

    def solver(self) -> LinearSolver:
        """Return what solves the linear systems of Newton's method."""
        return hessian_solver(self.held, self.kernels.backend)

    def hessian(self, coordinates: Array, *, semidefinite: bool = False, out: Array | None = None) -> Array:
        """Return the stored half of the Hessian (19, ni, nj); entries of fixed nodes are not removed.

        At sliding nodes it is that of the tangential unknowns.
        """
        values = self.values(coordinates)
        planes = self.kernels.hessian(
            coordinates, values, self.steps, semidefinite=semidefinite, interior_only=self.interior_only, out=out
        )
        if self.slide is not None:
            add_spring_hessian(self.slide, planes)
            self.slide.constrain(planes, self.gradient_at_sides(coordinates), semidefinite=semidefinite)
        return planes

    def gradient_at_sides(self, coordinates: Array) -> Array:
        """Return the gradient (2, ni, nj), not projected, that is right at the nodes of the sides alone."""
        values, inner = self.values(coordinates), self.interior_only
        if values is not None or inner:
            found = self.kernels.energy_gradient(coordinates, values, self.steps, interior_only=inner)[2]
        else:
            found = self._gradient_of_cells_at_sides(coordinates)
        add_spring_gradient(self.slide, coordinates, found)
        return found

    def _gradient_of_cells_at_sides(self, coordinates: Array) -> Array:
        """Return the gradient at the sides from the cells beside them, which are all that counts there."""
        found = np.empty_like(coordinates)
        every, first, last = slice(None), slice(None, 2), slice(-2, None)
        strips = (every, first), (every, last), (every, every, first), (every, every, last)
        for strip, side in zip(strips, SIDES, strict=True):
            beside = np.ascontiguousarray(coordinates[strip])
            found[side] = self.kernels.energy_gradient(beside, None, self.steps)[2][side]
        return found

    def folds(self, coordinates: Array, *, mendable: bool = False) -> Folds:
        """Count the folds of coordinates; with `mendable`, only those that moving free or sliding nodes may repair."""
        return Folds.of(coordinates, self.held if mendable else None, self.kernels.smallest_jacobians(coordinates))

    def gradient_scale(self, coordinates: Array, energy: float) -> float:
        """Return the norm that the gradient of this energy has on a grid far from its minimum: E/(h sqrt(nodes)).

        On a nearly folded grid the gradient can be larger by any factor, so it does not set a scale. With a gradient
        measured in local lengths h is 1.
        """
        spacing = mean_edge_length(coordinates) if self._lengths is None else 1.0
        return abs(energy) / (spacing * float(np.sqrt(coordinates[0].size))) if spacing > 0 else 0.0

    def round_off(self, coordinates: Array, gradient: Array) -> float:
        """Return the norm below which the gradient cannot be distinguished from zero: that of rounding errors.

        Measured by the change of the gradient when every node moves by a random rounding error.
        """
        if self._lengths is not None:
            return self._local_round_off(coordinates, gradient, self._lengths)
        size = max(float(coordinates.max()), -float(coordinates.min()))
        # Before the copy of the grid, so that no two temporaries are in memory at once.
        little, scale = self._little(coordinates), self.gradient_scale(coordinates, 1.0)
        # Products of random signs per row and per column are uncorrelated between nodes, and cost nothing.
        rows, columns = (
            np.random.default_rng(seed).choice((-little, little), (2, count))
            for seed, count in enumerate(coordinates.shape[1:])
        )
        moved = coordinates + rows[:, :, None] * (columns[:, None, :] / (little or 1.0))
        try:
            energy, _, there = self.energy_gradient(moved)
        except UnusableValueError:  # At a node that has left the domain, where the weight exists.
            return 0.0
        finally:
            self.refresh(coordinates)
        there -= gradient
        eps, change = float(np.finfo(float).eps), norm_of(there)
        # A gradient that does not change at all (of a null Lagrangian) still is a sum of rounded terms.
        summed = 10 * eps * scale * abs(energy) if np.isfinite(energy) else 0.0
        return summed + (4 * eps * size * change / little if little > 0 and np.isfinite(change) else 0.0)

    def _little(self, coordinates: Array) -> float:
        """Return how far nodes are moved to measure rounding: a small part of an edge that folds no cell."""
        part = 1e-4
        if self.kernels.barrier:
            smallest = self.energy(coordinates)[1] / (self.mean_jacobian(coordinates) or 1.0)
            part = min(part, max(0.05 * smallest, 1e-9)) if smallest > 0 else part
        return part * mean_edge_length(coordinates)

    def measure_locally(self, coordinates: Array) -> None:
        """Measure gradients from now on in the lengths of a grid's own edges, where these differ by many magnitudes.

        The norm is that of the gradient of every node times the shortest edge that meets there: of the changes of the
        energy when nodes move by a part of their cells, and not by one length everywhere.
        """
        self._lengths = shortest_edges(coordinates)

    def measure_as(self, other: Problem) -> None:
        """Measure gradients as another problem does."""
        self._lengths = other._lengths

    def shift(self, hessian: Array, part: float) -> None:
        """Add to the diagonal of the stored half of a Hessian, in place, this part of its mean size."""
        size = 0.5 * float(np.abs(hessian[0]).mean() + np.abs(hessian[2]).mean())
        hessian[0] += part * size
        hessian[2] += part * size

    def mean_jacobian(self, coordinates: Array) -> float:
        """Return the mean of the absolute Jacobians of the corners."""
        return mean_jacobian(coordinates)

    def inner(self, first: Array, second: Array) -> float:
        """Return the inner product of two fields (2, ni, nj)."""
        return inner(first, second)

    def norm(self, gradient: Array) -> float:
        """Return the norm of a gradient (2, ni, nj), in local lengths where gradients are measured so."""
        return norm_of(gradient if self._lengths is None else gradient * self._lengths)

    def _local_round_off(self, coordinates: Array, gradient: Array, lengths: Array) -> float:
        """Return the same as `round_off`, with moves and gradients in local lengths."""
        little, random = 1e-4, np.random.default_rng(0)
        moved = coordinates + little * lengths * random.choice((-1.0, 1.0), coordinates.shape)
        energy, _, there = self.energy_gradient(moved)
        self.refresh(coordinates)
        there -= gradient
        there *= np.abs(coordinates).max(axis=0) / little  # Over the length of the move, times the local length.
        eps, change = float(np.finfo(float).eps), norm_of(there)
        return 4 * eps * change if np.isfinite(change) and np.isfinite(energy) else 0.0

    def caution(self, coordinates: Array) -> str:
        """Return remarks on the energy and its weight for the user, with a leading blank, or nothing."""
        weight = self.inputs.weight if self.inputs is not None else None
        remarks = self.inputs.remarks(coordinates) if self.inputs is not None else ""
        if weight is None:
            same = self.kernels.null_lagrangian and not self.interior_only
            what = f" The energy of {self.kernels.functional} is the same for every grid with this boundary"
            return f"{what}: there is nothing to minimize." if same else remarks
        if self._values is not None and not self._values.nodes[0].any():
            flat = self.energy(coordinates)[0] == 0
            return (
                f" The weight is zero at every node: {'every grid has the energy zero' if flat else 'it asks nothing'}."
            )
        said = remarks
        outside = weight.nodes_outside(coordinates)
        if outside:
            said = (
                f" {outside} of {coordinates[0].size} nodes lie outside the weight's samples: the nearest sample "
                "counts there."
            )
        negative = weight.negative_nodes(coordinates)
        if negative:
            # On valid grids with this boundary J is bounded, and so is the energy, unless it has a barrier.
            bound = "where cells may fold, the energy has no lower bound, and"
            if self.kernels.barrier:
                bound = "the energy may have no lower bound, and then"
            said += (
                f" The weight is negative at {negative} of {coordinates[0].size} nodes: {bound} no grid minimizes it."
            )
        return said


def smallest_inner_jacobian(coordinates: Array) -> float:
    """Return the smallest Jacobian of the corners at inner nodes."""
    jacobians = corner_jacobians(coordinates[0], coordinates[1])
    later, earlier = slice(1, None), slice(None, -1)
    places = ((later, later), (earlier, later), (earlier, earlier), (later, earlier))
    inner_corners = [corner[place] for corner, place in zip(jacobians, places, strict=True)]
    return min(float(corners.min()) for corners in inner_corners)
