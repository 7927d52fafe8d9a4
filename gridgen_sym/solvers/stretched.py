"""Where a fold stays although nothing says that it must: untangle the nodes round it by themselves, seen otherwise.

An affine map neither folds nor unfolds a cell. But it changes what a functional of the shape of cells likes: the minima
of its regularised barrier lie elsewhere, and following them may lead past the fold, or so near to a valid grid that
lifting leads there. So a window of the grid round the fold is looked at in coordinates in which its boundary extends
evenly, and in those stretched this way and that; it starts from the transfinite grid of its own boundary.
"""

from __future__ import annotations

import numpy as np

from ..functionals.definition import functional
from ..grids import transfinite
from ..runtime import Array
from .frame import stretched_frames
from .lift import MOST_NODES, Fold, surroundings
from .problem import Problem
from .progress import Progress
from .untangle import at_all_nodes, path
from .windows import cut_out

#: Nodes up to so many cells from a fold are moved, at first and then.
_LAYERS = (3, 9)
#: What is minimised, whatever the user minimises: of the functionals with a barrier, its barrier is the steepest.
_FUNCTIONAL = "modified_liao"


def unfold_stretched(problem: Problem, coordinates: Array, progress: Progress) -> bool:
    """Unfold what is left of a few folds, in place, each in a window of its own; return whether the grid is valid.

    What does not lead to less folded cells is undone. It ends when every window was looked at in every frame, and each
    of these when there is no more progress. Steps are told to `progress`, those of lifting without an energy.
    """
    tried = set()
    for layers in _LAYERS:
        for free in surroundings(coordinates, problem.fixed, layers):
            ends = tuple((int(where.min()) - 1, int(where.max()) + 2) for where in np.nonzero(free))
            if ends not in tried:
                tried.add(ends)
                _unfold_window(problem, coordinates, (slice(*ends[0]), slice(*ends[1])), progress)
    return problem.folds(coordinates).cells == 0


def _unfold_window(problem: Problem, coordinates: Array, window: tuple[slice, slice], progress: Progress) -> None:
    """Untangle a window in place, in one frame after the other until it is valid; keep the least folded."""
    part, least = cut_out(problem, coordinates, window)
    free, lower = part.fixed == 0, at_all_nodes(part, progress)
    xy = least.transpose(1, 2, 0)
    start = np.where(free, transfinite(xy[:, 0], xy[:, -1], xy[0], xy[-1]).planes, least)
    for frame in stretched_frames(start):
        place = frame.of(start)
        try:
            for _ in path(part, functional(_FUNCTIONAL), place, None, lower):
                pass
            if free.sum() <= MOST_NODES:
                Fold(place, free).lift(progress)
        finally:  # Ctrl-C may come in the midst of a step.
            found = frame.back(place, start, part.fixed)
            if part.folds(found) < part.folds(least):
                least = found
                coordinates[:, *window] = found
        if not part.folds(least, mendable=True).cells:
            break
