"""Full-approximation multigrid, the local sweep its smoother, against Newton's method: which is the default, and why.

Newton's method is: it is ten to forty times cheaper on every curved boundary, and its number of steps does not grow
with the grid. On a square the cycles converge as they should, seven for a factor of 1e-8 on any grid. But a sweep
that moves one node at a time smooths in one direction only where cells are stretched (horseshoe, 12 to 1) or sheared
(wavy, to 24 degrees); a cycle then takes off a tenth of the error instead of nine tenths. The cycles of Newton's
linear systems solve for whole lines, and one nonlinear sweep, with its line search, costs about 13 passes of energy
and gradient.

The cycle is that of Brandt (1977), as Nash (2000) has it for minimization: sweeps, coordinates injected into the grid
of every second node, the gradient restricted by full weighting, a linear term -b.x that makes the coarse energy's
gradient the fine one's, and the coarse change interpolated and taken as far as it lowers the energy and folds
nothing.

The linear term needs no kernel written for it: a weight s that is added to the density and differentiated through
moves with its node by its slope, so slopes of -b/4 (an inner node has four corners) put -b.x into the generated
sweep.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np
from measure import Table, fastest, start_grid, threads

import gridgen_sym as gg
from gridgen_sym.arrays import Array
from gridgen_sym.functionals.metric import Metric
from gridgen_sym.runtime import KernelSet, kernels
from gridgen_sym.solvers.binding import make_problem
from gridgen_sym.solvers.multilevel.prolongation import finer_start
from gridgen_sym.solvers.norms import inner, norm_of

TOLERANCE = 1e-8
#: Sweeps before and after a coarse correction, and instead of one on the coarsest grid.
BEFORE, AFTER, COARSEST = 2, 2, 20
#: The coarsest grid of a cycle, and the one where nested iteration begins, in nodes a side.
_FEWEST, _FIRST = 5, 17
_HEADER = ("boundary", "nodes", "method", "cycles or steps", "reduction", "work units", "cpu seconds", "outcome")
_SQUARE = "square, disturbed"
_TEXT = (
    "Winslow's functional from transfinite interpolation, untangled for the start of the swan, one thread, until the "
    "gradient's norm has fallen by 1e-8. The square, its inner nodes displaced by waves, shows that the cycles are "
    "right: seven on any grid. Work units of Newton's method are its seconds over those of one energy + gradient "
    "pass; those of full approximation count its sweeps and passes on each grid at the cost of the kernels, and leave "
    "out what Python adds between them; its seconds have all. Reduction is the one that was reached; cycles and steps "
    "are those on the finest grid."
)


def linear(m: Metric) -> Any:
    """Winslow's functional and a linear term."""
    return (m.g11 + m.g22) / m.J + m.s


@dataclass(slots=True)
class FullApproximation:
    """The method on one hierarchy of grids.

    Attributes:
        kernels: of winslow.
        linear: of winslow with a linear term, in the variant that moves with the node.
        deadline: processor time after which it gives up.
        work: how many sweeps and passes were made, by what and number of nodes a side.
    """

    kernels: KernelSet
    linear: KernelSet
    deadline: float
    work: Counter[tuple[str, int]] = field(default_factory=Counter)

    def gradient(self, x: Array, b: Array) -> tuple[float, float, Array]:
        """Return the energy with its linear term, the smallest Jacobian, and the gradient, zero at the boundary."""
        self.work["pass", x.shape[1]] += 1
        energy, smallest, gradient = self.kernels.energy_gradient(x)
        gradient -= b
        gradient[:, 0], gradient[:, -1], gradient[:, :, 0], gradient[:, :, -1] = 0.0, 0.0, 0.0, 0.0
        return energy - inner(b, x), smallest, gradient

    def smooth(self, x: Array, b: Array, sweeps: int) -> None:
        """Sweep over all nodes in four colors."""
        self.work["sweep", x.shape[1]] += sweeps
        fixed = np.ones(x.shape[1:], dtype=np.uint8)
        fixed[1:-1, 1:-1] = 0
        weight = None
        if b.any():
            weight = np.zeros((6, *x.shape[1:]))
            weight[1:3] = -0.25 * b
        used = self.kernels if weight is None else self.linear
        for _ in range(sweeps):
            for color in range(4):
                used.sweep(x, weight, fixed, color, floor=0.0)

    def cycle(self, x: Array, b: Array) -> None:
        """One V-cycle on the energy less b.x, in place."""
        coarse = np.ascontiguousarray(x[:, ::2, ::2])
        # Every second node of a valid grid may make a folded one, where the energy is infinite: no coarser grid then.
        if x.shape[1] <= _FEWEST or not self.kernels.energy(coarse)[1] > 0:
            self.smooth(x, b, COARSEST)
            return
        self.smooth(x, b, BEFORE)
        coarse = np.ascontiguousarray(x[:, ::2, ::2])
        energy, smallest, gradient = self.gradient(x, b)
        if self.kernels.energy(coarse)[1] > 0:
            # There are a fourth of the corners, of the same energy each.
            right = self.gradient(coarse, np.zeros_like(coarse))[2] - 0.25 * restricted(gradient)
            moved = coarse.copy()
            self.cycle(moved, right)
            self.correct(x, b, interpolated(moved - coarse), energy, 0.1 * smallest)
        self.smooth(x, b, AFTER)

    def correct(self, x: Array, b: Array, change: Array, energy: float, lowest: float) -> None:
        """Add as much of the coarse change as lowers the energy and folds nothing."""
        length = 1.0
        for _ in range(10):
            trial = x + length * change
            reached, smallest, _ = self.gradient(trial, b)
            if reached <= energy + 1e-14 * abs(energy) and smallest > lowest:
                x[...] = trial
                return
            length *= 0.5

    def solve(self, x: Array, goal: float) -> tuple[int, float]:
        """Cycle until the gradient's norm is `goal`, in place; return the number of cycles and the norm."""
        zero = np.zeros_like(x)
        norm, cycles = norm_of(self.gradient(x, zero)[2]), 0
        while norm > goal and time.process_time() < self.deadline:
            self.cycle(x, zero)
            norm, cycles = norm_of(self.gradient(x, zero)[2]), cycles + 1
        return cycles, norm

    def nested(self, name: str, size: int) -> Array:
        """Return the start that grids with fewer nodes of the same boundary give."""
        solved = gg.optimize(start_grid(name, _FIRST), "winslow", progress=False).grid.planes
        while True:
            finer = start_grid(name, 2 * solved.shape[1] - 1)
            problem, boundary = make_problem(finer, "winslow"), np.ascontiguousarray(finer.planes)
            solved = valid(gg.Grid.from_planes(*finer_start(problem, np.ascontiguousarray(solved), boundary)))
            if solved.shape[1] >= size:
                return solved
            # As well as the default solves its coarse grids.
            self.solve(solved, 1e-4 * first_norm(solved))


def restricted(fine: Array) -> Array:
    """Return the transpose of `interpolated`, zero at the boundary: full weighting, times four."""
    rows = fine[:, 2:-1:2] + 0.5 * (fine[:, 1:-2:2] + fine[:, 3::2])
    coarse = np.zeros((2, *(n // 2 + 1 for n in fine.shape[1:])))
    coarse[:, 1:-1, 1:-1] = rows[:, :, 2:-1:2] + 0.5 * (rows[:, :, 1:-2:2] + rows[:, :, 3::2])
    return coarse


def interpolated(coarse: Array) -> Array:
    """Return a field on the grid of twice as many cells, bilinearly."""
    fine = np.empty((2, *(2 * n - 1 for n in coarse.shape[1:])))
    fine[:, ::2, ::2] = coarse
    fine[:, 1::2, ::2] = 0.5 * (coarse[:, 1:] + coarse[:, :-1])
    fine[:, :, 1::2] = 0.5 * (fine[:, :, :-1:2] + fine[:, :, 2::2])
    return fine


def valid(grid: gg.Grid) -> Array:
    """Return the coordinates of a grid, untangled where it is folded."""
    return np.ascontiguousarray(gg.untangle(grid, progress=False).grid.planes).copy()


def first_norm(x: Array) -> float:
    """Return the norm that the solvers measure from."""
    problem = make_problem(gg.Grid.from_planes(*x), "winslow", spacing="index")
    energy, _, gradient = problem.energy_gradient(x)
    return min(norm_of(gradient), problem.gradient_scale(x, energy))


def run(quick: bool) -> list[Table]:
    """Measure, and return the table."""
    table = Table("Full approximation against Newton's method", _TEXT, _HEADER)
    ratios: list[float] = []
    with threads(1):
        gg.define("winslow_and_linear", linear)
        gg.optimize(start_grid("swan", 17), "winslow", progress=False)  # compiles
        for boundary in ("wavy", "swan", "horseshoe", _SQUARE):
            for size in (65, 129) if quick else (65, 129, 257):
                costs = list(_costs(boundary, size, 10.0 if quick else 60.0))
                for cost in costs:
                    table.add(boundary, f"{size}²", *cost)
                if boundary != _SQUARE:
                    ratios.append(min(cost[3] for cost in costs[1:]) / costs[0][3])
    table.note(
        f"On the curved boundaries Newton's method needs {min(ratios):.0f} to {max(ratios):.0f} times fewer work units "
        "than the better full approximation: it is the default. A sweep over single nodes does not smooth along "
        "stretched and sheared cells, where the cycles of Newton's linear systems solve for whole lines."
    )
    return [table]


def _costs(boundary: str, size: int, limit: float) -> Iterator[tuple[str, int, float, int, float, str]]:
    """Yield each method's cells after boundary and size."""
    given = _disturbed_square(size) if boundary == _SQUARE else start_grid(boundary, size)
    start = valid(given)
    first, unit = first_norm(start), _seconds("pass", size)
    spent = fastest(lambda: gg.optimize(given, "winslow", tolerance=TOLERANCE, progress=False), runs=3).cpu
    result = gg.optimize(given, "winslow", tolerance=TOLERANCE, progress=False)
    reached = result.history[-1].gradient_norm / first
    yield "Newton, the default", result.iterations, reached, round(spent / unit), spent, _outcome(result.converged)
    for nested in (False,) if boundary == _SQUARE else (True, False):
        begin = time.process_time()
        method = FullApproximation(
            kernels(gg.functional("winslow")),
            kernels(gg.functional("winslow_and_linear"), "differentiated"),
            begin + limit,
        )
        x = method.nested(boundary, size) if nested else start.copy()
        cycles, norm = method.solve(x, TOLERANCE * first)
        spent = time.process_time() - begin
        units = sum(count * _seconds(*key) for key, count in method.work.items()) / unit
        name = f"full approximation, {'nested' if nested else 'from the valid start'}"
        yield name, cycles, norm / first, round(units), spent, _outcome(norm <= TOLERANCE * first)


def _outcome(converged: bool) -> str:
    return "converged" if converged else "gave up"


@lru_cache(maxsize=64)
def _seconds(what: str, size: int) -> float:
    """Return the seconds of one pass, or of one sweep of all four colors, on a grid of this size."""
    x, kernel_set = np.ascontiguousarray(start_grid("wavy", size).planes), kernels(gg.functional("winslow"))
    gradient, fixed = np.empty_like(x), np.zeros(x.shape[1:], dtype=np.uint8)

    def sweep() -> None:
        for color in range(4):
            kernel_set.sweep(x, None, fixed, color, floor=0.0)

    def evaluate() -> None:
        kernel_set.energy_gradient(x, out=gradient)

    return fastest(sweep if what == "sweep" else evaluate, runs=5, seconds=0.05).cpu


def _disturbed_square(size: int) -> gg.Grid:
    """Return a unit square with waves inside."""
    xi, eta = np.meshgrid(*2 * [np.linspace(0.0, 1.0, size)], indexing="ij")
    wave = 0.05 * np.sin(2 * np.pi * xi) * np.sin(3 * np.pi * eta)
    return gg.Grid.from_planes(xi + wave, eta + wave)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="smaller grids, and 10 seconds for one solve")
    for result in run(parser.parse_args().quick):
        print(result.markdown())
