"""From a folded grid to a valid one: minimise a barrier functional whose barrier is regularised, and sharpen it.

The Jacobian J is replaced by chi(J) = (J + sqrt(J² + epsilon²))/2, which is positive everywhere; epsilon is driven to
zero while the energy is minimised (Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov 2021, "Foldover-free maps in
50 lines of code"; Escobar et al. 2003). chi is a substitution in the derivation, so every barrier functional has it.

The minima for falling epsilon lie on a path, and Newton's method follows it in large steps: epsilon falls by a
constant factor. Where a valid grid exists the worst fold becomes shallower with epsilon, sooner or later; where none
exists it tends to a depth that stays. Affine maps neither fold nor unfold, but no grid in a thin band is what these
functionals like: what stays folded is tried again in coordinates in which the boundary extends evenly.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace

from ..functionals.definition import Functional
from ..runtime import Array, kernels
from .folds import Folds, mean_jacobian
from .frame import Frame, frames
from .linear import hessian_solver
from .newton import minimize
from .nonlinear_elimination import sweep_standing_out
from .point import Point
from .problem import Problem
from .progress import Progress
from .windows import cut_out, folded_nodes, windows

#: The first epsilon, over the depth of the worst fold and over the mean Jacobian: the larger of the two counts.
_DEPTH, _SIZE = 0.2, 0.02
#: Factor by which epsilon falls.
_FALL = 0.3
#: Progress has ended if in so many falls no cell is unfolded, and the worst fold is no shallower by this factor.
_PATIENCE, _SHALLOWER = 3, 0.9
#: For one epsilon: factor by which the gradient must fall, and Newton steps after which epsilon falls in any case.
_TOLERANCE, _STEPS = 1e-2, 20
#: Over the mean Jacobian: below this epsilon, rounding decides about signs.
_SHARPEST = 1e-12
#: Nodes round folds that are unfolded as a grid of their own, at first and then; no window is more than a part of all.
_LAYERS = 6, 12
#: Folded cells that are less than this part of all are tried by themselves before all nodes are moved.
_FEW = 0.02


#: Lowers the energy of a problem from given coordinates on, in place.
_Lower = Callable[[Problem, Array], None]


def unfold(
    problem: Problem,
    functional: Functional,
    coordinates: Array,
    parameters: Mapping[str, float] | None,
    progress: Progress,
) -> bool:
    """Make every corner's Jacobian positive, where that can be done; changes `coordinates` in place.

    Stops at the first valid grid; where only corners are left whose three nodes are all fixed; or where progress has
    ended: epsilon falls and falls, and no cell unfolds any more, nor does the worst fold become shallower, or epsilon
    has become so small that rounding decides. The grid with the fewest folded cells is kept, whatever ends it.

    Returns:
        Whether the grid is valid.
    """
    search = _Search(problem, functional, parameters, progress, _Least(problem, coordinates.copy()))
    try:
        for way in (search.node_by_node, search.window_by_window, search.everywhere):
            way(coordinates)
            if search.done:
                break
    finally:
        coordinates[...] = search.least.coordinates
    return search.least.folds.cells == 0


@dataclass(slots=True)
class _Least:
    """The least folded grid so far: its coordinates, and its folds, which the problem counts."""

    problem: Problem
    coordinates: Array
    folds: Folds = field(init=False)

    def __post_init__(self) -> None:
        """Count the folds of the start."""
        self.folds = self.problem.folds(self.coordinates)

    def offer(self, coordinates: Array) -> None:
        """Take a grid that is less folded."""
        folds = self.problem.folds(coordinates)
        if folds < self.folds:
            self.coordinates, self.folds = coordinates.copy(), folds


@dataclass(slots=True)
class _Search:
    """The ways to a valid grid, the cheapest first; each offers the grids that it finds to `least`."""

    problem: Problem
    functional: Functional
    parameters: Mapping[str, float] | None
    progress: Progress
    least: _Least

    @property
    def done(self) -> bool:
        """Whether no cell is left that moving free nodes may mend."""
        return not self.problem.folds(self.least.coordinates, mendable=True).cells

    def node_by_node(self, start: Array) -> None:
        """Where few cells are folded, lower the energy at the nodes round them."""

        def lower(regular: Problem, place: Array) -> None:
            point = Point(regular, place)
            self.progress.step(0, point.energy, point.norm, point.smallest)
            sweep_standing_out(point, self.progress.deadline, until_valid=True)

        if self.least.folds.cells < _FEW * self.problem.fixed.size:
            self._follow(start, next(frames(start)), lower)

    def window_by_window(self, start: Array) -> None:
        """Unfold small parts of the least folded grid, each as a grid of its own."""
        for layers in _LAYERS:
            for window in windows(folded_nodes(self.least.coordinates, self.problem.fixed), layers):
                part, place = cut_out(self.problem, self.least.coordinates, window)
                try:
                    unfold(part, self.functional, place, self.parameters, self.progress)
                finally:
                    whole = self.least.coordinates.copy()
                    whole[:, *window] = place
                    self.least.offer(whole)

    def everywhere(self, start: Array) -> None:
        """Lower the energy at all nodes, in every frame."""
        lower = at_all_nodes(self.problem, self.progress)
        for frame in frames(start):
            self._follow(start, frame, lower)
            if self.done:
                break

    def _follow(self, start: Array, frame: Frame, lower: _Lower) -> None:
        """Follow the minima for falling epsilon from a start."""
        place, fixed = frame.of(start), self.problem.fixed
        try:
            for _ in path(self.problem, self.functional, place, self.parameters, lower):
                self.least.offer(frame.back(place, start, fixed))
        finally:  # Ctrl-C may come in the midst of a step.
            self.least.offer(frame.back(place, start, fixed))


def at_all_nodes(problem: Problem, progress: Progress) -> _Lower:
    """Return what lowers the energy at all nodes of a problem, by Newton's method."""
    solver = hessian_solver(problem.fixed, problem.kernels.backend)

    def lower(regular: Problem, place: Array) -> None:
        minimize(
            regular,
            place,
            progress,
            tolerance=_TOLERANCE,
            max_iterations=_STEPS,
            keep_valid=False,
            until_valid=True,
            semidefinite=True,
            solver=solver,
        )

    return lower


def path(
    problem: Problem,
    functional: Functional,
    coordinates: Array,
    parameters: Mapping[str, float] | None,
    lower: _Lower,
) -> Iterator[None]:
    """Follow the minima for falling epsilon, changing `coordinates` in place, as long as that is progress."""
    folds = [problem.folds(coordinates, mendable=True)]
    size = mean_jacobian(coordinates)
    epsilon = max(_DEPTH * folds[0].depth, _SIZE * size)
    while folds[-1].cells and epsilon > _SHARPEST * size and not _ended(folds[1:]):
        lower(regularized(problem, functional, parameters, epsilon), coordinates)
        folds.append(problem.folds(coordinates, mendable=True))
        epsilon *= _FALL
        yield


def _ended(folds: list[Folds]) -> bool:
    """Return whether the last falls of epsilon were no progress over all before them."""
    before, lately = folds[:-_PATIENCE], folds[-_PATIENCE:]
    if not before:
        return False
    fewer = min(fold.cells for fold in lately) < min(fold.cells for fold in before)
    shallower = min(fold.depth for fold in lately) < _SHALLOWER * min(fold.depth for fold in before)
    return not (fewer or shallower)


def regularized(
    problem: Problem, functional: Functional, parameters: Mapping[str, float] | None, epsilon: float
) -> Problem:
    """Return the same problem with the regularised barrier, without a weight, over all corners."""
    kernel_set = kernels(functional, "regularized", {**(parameters or {}), "epsilon": epsilon}, problem.kernels.backend)
    # Its energy is finite everywhere, so the line search need not keep corners positive.
    return Problem(replace(kernel_set, barrier=False), problem.fixed, None)
