"""A few folded cells: follow the regularized barrier at the nodes around them, by sweeps over single nodes."""

from __future__ import annotations

from dataclasses import dataclass

from ...arrays import Array
from ..iterate import Iterate
from ..newton.nonlinear_elimination import sweep_standing_out
from ..problem import Problem
from .affine_maps import balanced_maps
from .regularization import follow
from .search import Search

#: More folded cells than this fraction of all nodes are not few.
_FEW = 0.02


@dataclass(frozen=True, slots=True)
class FoldedNodes:
    """Sweeps over the nodes around few folded cells; costs a hundredth of a Newton step on all nodes."""

    name: str = "regularized barrier at folded nodes"

    def run(self, search: Search) -> None:
        """Sweep from the start, where few cells are folded."""

        def lower(regular: Problem, coordinates: Array) -> None:
            iterate = Iterate(regular, coordinates)
            search.progress.step(0, iterate.energy, iterate.norm, iterate.smallest)
            sweep_standing_out(iterate, regular, search.progress.deadline, until_valid=True)

        if search.best.folds.cells < _FEW * search.problem.fixed.size:
            follow(search, next(balanced_maps(search.start)), lower)
