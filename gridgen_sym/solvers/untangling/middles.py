"""Where a fold stays although nothing says that it must: lift from the middle of where valid grids have their nodes.

A window of the grid round the fold is a grid with sides of its own. The search for a proof tells where valid grids with
these sides may have each node, and where those have it whose corner Jacobians exceed a part of what is expected. The
larger that part, the less choice have the nodes, until no such grid is left. So the best that there may be is looked
for first: from the middle of these places a few linear programs lead to a valid grid, however uneven it must be. Where
there is much room, and the places say little, they do so from the transfinite grid.

An affine map neither folds nor unfolds a cell, but it changes how far a program may move a node in each direction. So
it is tried in coordinates in which the sides extend evenly, and in those stretched this way and that.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from ...arrays import Array
from ...certificates.branching import DEFAULT_BUDGET, Conflict, feasible_regions
from ...grids import Grid, transfinite
from ..problem import Problem
from ..run.deadline import Deadline
from ..run.progress import Progress
from ..subdomains import cut_out
from .frame import stretched_frames
from .lift import MOST_NODES, Fold, surroundings

#: Nodes up to so many cells from a fold are moved, at first and then.
_LAYERS = (3, 9)
#: Grids whose corner Jacobians exceed such a part of what is expected of them are looked for.
_SHARES = (0.1, 0.01, 1e-3, 1e-4, 1e-6)


def unfold_from_middles(problem: Problem, coordinates: Array, progress: Progress, work: int = DEFAULT_BUDGET) -> bool:
    """Unfold what is left of a few folds, in place, each in a window of its own; return whether the grid is valid.

    What does not lead to less folded cells is undone. It ends when every window was looked at in every frame, and each
    of these when there is no more progress. Each program is told to `progress` as a step without an energy. The
    places of nodes are what so much `work` tells of them.
    """
    tried = set()
    for layers in _LAYERS:
        for free in surroundings(coordinates, problem.fixed, layers):
            ends = tuple((int(where.min()) - 1, int(where.max()) + 2) for where in np.nonzero(free))
            if ends not in tried and free.sum() <= MOST_NODES:
                tried.add(ends)
                _unfold_window(problem, coordinates, (slice(*ends[0]), slice(*ends[1])), progress, work)
    return problem.folds(coordinates).cells == 0


def _unfold_window(
    problem: Problem, coordinates: Array, window: tuple[slice, slice], progress: Progress, work: int
) -> None:
    """Lift the nodes of a window in place, in one frame after the other until it is valid; keep the least folded."""
    part, least = cut_out(problem, coordinates, window)
    free = part.fixed == 0
    for start in _starts(least, free, progress.deadline, work):
        for frame in stretched_frames(start):
            place = frame.of(start)
            try:
                Fold(place, free).lift(progress)
            finally:  # Ctrl-C may come in the midst of a step.
                found = frame.back(place, least, part.fixed)
                if part.folds(found) < part.folds(least):
                    least = found
                    coordinates[:, *window] = found
            if not part.folds(least, mendable=True).cells:
                return


def _starts(window: Array, free: npt.NDArray[np.bool_], deadline: Deadline, work: int) -> Iterator[Array]:
    """Return a window with every free node in the middle of the largest part of its place, and its transfinite grid.

    There are none if its sides admit no grid whose corner Jacobians exceed the least share.
    """
    for share in _SHARES:
        places = feasible_regions(Grid.from_planes(*window), budget=work, jacobian_fraction=share, check=deadline.check)
        if not isinstance(places, Conflict):
            start = window.copy()
            for node, parts in places.items():
                if free[node]:
                    start[:, *node] = parts[0].mean(axis=0)
            yield start
    if isinstance(places, Conflict):  # At the least share, too.
        return
    xy = window.transpose(1, 2, 0)
    yield np.where(free, transfinite(xy[:, 0], xy[:, -1], xy[0], xy[-1]).planes, window)
