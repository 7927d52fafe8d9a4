"""Follow the regularized barrier relative to the edge lengths that the spacing of the boundary nodes predicts.

One epsilon for all cells is large for the small cells of a boundary with very uneven spacing: these fold as long as the
large ones shape the grid, and stay folded when epsilon has fallen. Relative to the expected lengths all cells are of
one size, so that they unfold together. Relative to powers of these lengths the minima are other grids, which may be
valid where the first one is not.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...certificates.expected_jacobians import expected_edges
from ...functionals.registry import functional
from ...grids import Grid
from .affine_maps import balanced_maps
from .diagonal_target import DiagonalTarget
from .regularization import follow, global_newton
from .search import Search

#: The functional whose barrier is followed: its kernels relative to a target are in `generated/`.
FUNCTIONAL = "winslow"
#: The range of powers. Of those tried (0.5 to 1.6, 1 to 2, random factors instead) it led to valid grids most often.
_LEAST, _MOST = 0.3, 2.0
#: Steps modulo 1 that fill a square evenly with any number of points: the powers of the inverse plastic number.
_STEPS = 0.7548776662466927, 0.5698402909980532


@dataclass(frozen=True, slots=True)
class ExpectedSpacing:
    """Newton's method on all nodes, relative to rectangles with the expected lengths as sides."""

    name: str = "regularized barrier relative to the expected spacing"

    def run(self, search: Search) -> None:
        """Follow the minima from the start."""
        _follow(search, 1.0, 1.0)


@dataclass(frozen=True, slots=True)
class PowersOfSpacing:
    """Newton's method on all nodes, relative to rectangles with powers of the expected lengths as sides.

    Attributes:
        tries: how many pairs of powers.
        most_nodes: grids with more nodes are left to other strategies.
    """

    tries: int
    most_nodes: int
    name: str = "regularized barrier relative to powers of the expected spacing"

    def run(self, search: Search) -> None:
        """Follow the minima from the start for one pair of powers after the other until the grid is valid."""
        if search.problem.fixed.size > self.most_nodes:
            return
        for k in range(1, self.tries + 1):
            along_xi, along_eta = (_LEAST + (_MOST - _LEAST) * (k * step % 1) for step in _STEPS)
            _follow(search, along_xi, along_eta)
            if search.done:
                return


def _follow(search: Search, power_xi: float, power_eta: float) -> None:
    """Follow the minima relative to powers of the expected lengths, unless boundary nodes coincide."""
    along_xi, along_eta = expected_edges(Grid.from_planes(*search.start))
    if not min(along_xi.min(), along_eta.min()) > 0:
        return
    target = DiagonalTarget.of_edges(along_xi**power_xi, along_eta**power_eta)
    if not np.isfinite(target.determinants).all():
        return
    lower = global_newton(search.problem, search.progress)
    follow(search, next(balanced_maps(search.start)), lower, functional(FUNCTIONAL), target=target)
