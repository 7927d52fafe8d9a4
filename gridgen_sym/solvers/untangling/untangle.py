"""From a folded grid to a valid one: the ways there, the cheapest first.

Each follows the minima of a regularised barrier functional while it is sharpened (`continuation.py`): at the nodes
round few folds, in windows round them, and everywhere. Affine maps neither fold nor unfold, but no grid in a thin band
is what these functionals like: what stays folded is tried again in coordinates in which the boundary extends evenly.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from ...arrays import Array
from ...functionals.definition import Functional
from ..folds import Folds
from ..iterate import Point
from ..newton.nonlinear_elimination import sweep_standing_out
from ..problem import Problem
from ..run.progress import Progress
from ..subdomains import cut_out, folded_nodes, windows
from .continuation import Lower, at_all_nodes, path
from .frame import Frame, frames

#: Nodes round folds that are unfolded as a grid of their own, at first and then; no window is more than a part of all.
_LAYERS = 6, 12
#: Folded cells that are less than this part of all are tried by themselves before all nodes are moved.
_FEW = 0.02


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
    search = _Search(problem, functional, parameters, progress, coordinates, _Least(problem, coordinates))
    try:
        for way in (search.node_by_node, search.window_by_window, search.everywhere):
            way()
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
    start: Array
    least: _Least

    @property
    def done(self) -> bool:
        """Whether no cell is left that moving free nodes may mend."""
        return not self.problem.folds(self.least.coordinates, mendable=True).cells

    def node_by_node(self) -> None:
        """Where few cells are folded, lower the energy at the nodes round them."""

        def lower(regular: Problem, place: Array) -> None:
            point = Point(regular, place)
            self.progress.step(0, point.energy, point.norm, point.smallest)
            sweep_standing_out(point, self.progress.deadline, until_valid=True)

        if self.least.folds.cells < _FEW * self.problem.fixed.size:
            self._follow(next(frames(self.start)), lower)

    def window_by_window(self) -> None:
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

    def everywhere(self) -> None:
        """Lower the energy at all nodes, in every frame."""
        lower = at_all_nodes(self.problem, self.progress)
        for frame in frames(self.start):
            self._follow(frame, lower)
            if self.done:
                break

    def _follow(self, frame: Frame, lower: Lower) -> None:
        """Follow the minima for falling epsilon from the start, in a frame."""
        place, fixed = frame.of(self.start), self.problem.fixed
        try:
            for _ in path(self.problem, self.functional, place, self.parameters, lower):
                self.least.offer(frame.back(place, self.start, fixed))
        finally:  # Ctrl-C may come in the midst of a step.
            self.least.offer(frame.back(place, self.start, fixed))
