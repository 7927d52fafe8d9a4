"""The discrete problem on several blocks: the kernels of a functional on each, and sums over the copies of nodes."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

import numpy as np

from ...arrays import Array, Mask
from ...errors import UnusableValueError
from ...runtime import BlockKernels, KernelSet, Values
from ...topology.copies import Bond, Copies
from ..folds import Folds
from ..linear.solution import LinearSolver
from ..norms import shortest_edges
from ..problem import Problem
from .exchange import Exchange
from .linear import layout_solver
from .slide import LayoutSlide

#: So many blocks are a sample of all.
_SOME_BLOCKS = 16


class LayoutProblem:
    """Energy, gradient and Hessian as functions of one array with the coordinates of all blocks; see `Exchange`.

    Attributes:
        blocks: the problem on each block; their own masks of fixed nodes have no part in it.
        copies: the nodes with several copies.
        fixed: for each block the mask of nodes that do not move.
        bonds: what is connected.
        exchange: joins blocks, and sums over copies.
        slide: the boundary nodes that slide along curves, or None; they count as fixed elsewhere.
    """

    def __init__(
        self,
        blocks: Sequence[Problem],
        copies: Copies,
        fixed: Sequence[Mask],
        bonds: Sequence[Bond],
        slide: LayoutSlide | None = None,
    ) -> None:
        """Join the problems of blocks."""
        self.slide = slide
        self.blocks, self.copies, self.fixed, self.bonds = tuple(blocks), copies, tuple(fixed), tuple(bonds)
        self.exchange = Exchange(copies, [mask.shape for mask in self.fixed])
        self._lengths: Array | None = None
        self._block_kernels = BlockKernels(self.kernels, self.exchange.shapes, [block.steps for block in self.blocks])
        self._held = self.exchange.join([np.stack((mask, mask)) for mask in self.fixed]) != 0

    @property
    def kernels(self) -> KernelSet:
        """Those of the functional, in the variant of all blocks."""
        return self.blocks[0].kernels

    @property
    def lags(self) -> bool:
        """Whether something is held while the nodes move, and evaluated again where they come to."""
        return any(block.lags for block in self.blocks)

    def _each(self, coordinates: Array) -> list[tuple[Problem, Array]]:
        return list(zip(self.blocks, self.exchange.views(coordinates), strict=True))

    def refresh(self, coordinates: Array) -> None:
        """Evaluate weights and fields at the nodes' present positions."""
        if not self.kernels.planes:
            return
        for block, place in self._each(coordinates):
            block.refresh(place)

    def exists_at(self, coordinates: Array) -> bool:
        """Return whether everything that the density is given can be evaluated at coordinates."""
        return all(block.exists_at(place) for block, place in self._each(coordinates))

    def _values(self, coordinates: Array) -> list[Values | None] | None:
        """Return what the density is given on each block; None where it is given nothing."""
        if not self.kernels.planes:
            return None
        return [block.values(place) for block, place in self._each(coordinates)]

    def energy(self, coordinates: Array) -> tuple[float, float]:
        """Return the energy and the smallest Jacobian."""
        energy, smallest = self._block_kernels.energy(coordinates, self._values(coordinates))
        return energy + self._springs(coordinates), smallest

    def _springs(self, coordinates: Array) -> float:
        """Return the energy of springs between sliding nodes; zero without any."""
        return 0.0 if self.slide is None else self.slide.spring_energy(coordinates)

    def energy_gradient(self, coordinates: Array, out: Array | None = None) -> tuple[float, float, Array]:
        """Return the energy, the smallest Jacobian and the gradient, consistent and zero at fixed nodes."""
        gradient = np.empty(self.exchange.size) if out is None else out
        energy, least = self._block_kernels.energy_gradient(coordinates, self._values(coordinates), gradient)
        return energy + self._springs(coordinates), least, self._pinned(gradient, coordinates)

    def _pinned(self, gradient: Array, coordinates: Array) -> Array:
        """Sum a gradient over copies and make it zero at fixed nodes, tangential at sliding ones, in place."""
        if self.slide is None:
            gradient[self._held] = 0.0
            return self.exchange.make_consistent(gradient)
        self.exchange.make_consistent(gradient)
        along = self.slide.tangential(gradient, coordinates)
        gradient[self._held] = 0.0
        self.slide.spread(along, gradient)
        return gradient

    def hessian(self, coordinates: Array, *, semidefinite: bool = False, out: list[Array] | None = None) -> list[Array]:
        """Return for each block the stored half of the Hessian (19, ni, nj) of its own cells.

        At sliding nodes it is that of the tangential unknowns.
        """
        values = self._values(coordinates)
        found = self._block_kernels.hessian(coordinates, values, semidefinite=semidefinite, out=out)
        if self.slide is not None:
            gradient = self.exchange.join([block.gradient_at_sides(place) for block, place in self._each(coordinates)])
            self.slide.constrain(found, coordinates, gradient, semidefinite=semidefinite)
        return found

    def shift(self, hessian: list[Array], part: float) -> None:
        """Add to the diagonals of all blocks, in place, this part of their mean size."""
        nodes = sum(planes[0].size for planes in hessian)
        size = 0.5 * sum(float(np.abs(planes[0]).sum() + np.abs(planes[2]).sum()) for planes in hessian) / nodes
        for planes in hessian:
            planes[0] += part * size
            planes[2] += part * size

    def solver(self) -> LinearSolver:
        """Return what solves the linear systems of Newton's method."""
        shared = self.copies if self.slide is None else self.slide.shared()
        return layout_solver(self.exchange, shared, self.held, self.bonds, self.kernels.backend)

    @property
    def held(self) -> Sequence[Mask]:
        """For each block the mask of nodes without unknowns: of the fixed ones those that do not slide."""
        return self.fixed if self.slide is None else self.slide.masks(self.fixed)

    def retract(self, coordinates: Array, *, trial: bool = False) -> None:
        """Put sliding nodes back on their curves, in place; a `trial` may be refused."""
        if self.slide is not None:
            self.slide.retract(coordinates, trial=trial)

    def follow(self, coordinates: Array) -> None:
        """Take the sliding nodes from where they are in coordinates, on their curves."""
        if self.slide is not None:
            self.slide.follow(coordinates)

    def inner(self, first: Array, second: Array) -> float:
        """Return the inner product of two consistent fields."""
        return self.exchange.inner(first, second)

    def norm(self, gradient: Array) -> float:
        """Return the norm of a consistent field, in local lengths where gradients are measured so."""
        measured = gradient if self._lengths is None else gradient * self._lengths
        return float(np.sqrt(max(self.inner(measured, measured), 0.0)))

    def measure_locally(self, coordinates: Array) -> None:
        """Measure gradients from now on in the lengths of the shortest edges that meet at each node; see `Problem`."""
        views = self.exchange.views(coordinates)
        self._lengths = self.exchange.join([np.stack([shortest_edges(place)] * 2) for place in views])
        self.exchange.spread_least(self._lengths)

    def gradient_scale(self, coordinates: Array, energy: float) -> float:
        """Return the norm that the gradient of this energy has on a grid far from its minimum; see `Problem`."""
        spacing = self._spacing(coordinates) if self._lengths is None else 1.0
        return abs(energy) / float(spacing * np.sqrt(coordinates.size / 2)) if spacing > 0 else 0.0

    def _spacing(self, coordinates: Array) -> float:
        lengths: list[float] = []
        begin = 0
        for (ni, nj), alike in groupby(
            self.exchange.shapes
        ):  # With many small blocks, calls cost more than arithmetic.
            count = len(list(alike))
            end = begin + 2 * count * ni * nj
            blocks = coordinates[begin:end].reshape(count, 2, ni, nj)
            edges = [np.diff(blocks, axis=axis) for axis in (2, 3)]
            squares = [np.einsum("bcij,bcij->b", one, one) / one[0, 0].size for one in edges]
            lengths += (np.sqrt(squares[0]) + np.sqrt(squares[1])).tolist()
            begin = end
        return float(np.mean(lengths))

    def mean_jacobian(self, coordinates: Array) -> float:
        """Return the mean of the absolute Jacobians of the corners; of many blocks, of some."""
        some = slice(None, None, max(1, len(self.blocks) // _SOME_BLOCKS))
        means = [block.mean_jacobian(place) for block, place in self._each(coordinates)[some]]
        return float(np.average(means, weights=[mask.size for mask in self.fixed[some]]))

    def round_off(self, coordinates: Array, gradient: Array) -> float:
        """Return the norm below which the gradient cannot be distinguished from zero; see `Problem`."""
        size = float(np.abs(coordinates).max())
        random, local = np.random.default_rng(0), self._lengths is not None
        little = 1e-4 if local else 1e-4 * self._spacing(coordinates)
        moved = random.choice((-little, little), coordinates.shape)
        if self._lengths is not None:
            moved *= self._lengths
        moved = self.exchange.of_first_copies(moved)  # Copies move alike.
        moved += coordinates
        try:
            energy, _, there = self.energy_gradient(moved)
        except UnusableValueError:
            return 0.0
        finally:
            self.refresh(coordinates)
        there -= gradient
        if self._lengths is not None:
            size = 1.0
            there *= np.abs(coordinates) / self._lengths
        change, eps = self.norm(there), float(np.finfo(float).eps)
        summed = 10 * eps * self.gradient_scale(coordinates, 1.0) * abs(energy) if np.isfinite(energy) else 0.0
        return summed + (4 * eps * size * change / little if little > 0 and np.isfinite(change) else 0.0)

    def folds(self, coordinates: Array, *, mendable: bool = False) -> Folds:
        """Count the folds; with `mendable`, only those that moving free or sliding nodes may repair."""
        rows = self._block_kernels.smallest_jacobians(coordinates)
        counts = [len(mask) - 1 for mask in self.fixed]
        by_block = np.split(rows, np.cumsum(counts)[:-1])
        found = [
            Folds.of(place, fixed if mendable else None, of_block)
            for (_, place), fixed, of_block in zip(self._each(coordinates), self.held, by_block, strict=True)
        ]
        return Folds(sum(one.cells for one in found), max(one.depth for one in found))
