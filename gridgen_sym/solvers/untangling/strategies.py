"""The list of strategies by which a folded grid becomes valid, the cheapest first; a new one is one entry here."""

from __future__ import annotations

from collections.abc import Mapping

from ...arrays import Array
from ...certificates.branching import DEFAULT_BUDGET, LARGE_BUDGET
from ...functionals.definition import Functional
from ..problem import Problem
from ..run.progress import Progress
from .all_nodes import AllNodes
from .coarse_grids import CoarseGrids
from .expected_spacing import ExpectedSpacing, PowersOfSpacing
from .feasible_starts import FeasibleStarts
from .fixed_boundary import FixedBoundary
from .folded_nodes import FoldedNodes
from .folded_subdomains import FoldedSubdomains
from .other_barriers import OtherBarriers
from .proofs import ProofSearch, QuickProofs, SliverSearch
from .regularization import SLOW
from .search import Search, Strategy
from .smallest_jacobian import SmallestJacobian, SmallestJacobianOfAll
from .stretched_coordinates import StretchedCoordinates

#: On a grid with so many nodes a valid coarse grid is found and refined faster than the barrier is followed to its end.
_LARGE = 4096
#: On a grid with at most so many nodes the barrier is followed to its end in less than a second.
_SMALL = 2048

#: What follows the regularized barrier. A subdomain or a coarse grid is untangled by these alone.
REGULARIZED: tuple[Strategy, ...] = (FoldedNodes(), FoldedSubdomains(), AllNodes())

#: All strategies. Searches for proofs are short at first, and long where no strategy has succeeded: where not even that
#: is proved, that every grid has a sliver, there mostly is a valid one.
STRATEGIES: tuple[Strategy, ...] = (
    FoldedNodes(),
    FoldedSubdomains(),
    CoarseGrids(((2, 2),), fewest_nodes=_LARGE),
    AllNodes(),
    CoarseGrids(((2, 2), (4, 4))),
    SmallestJacobian(),
    QuickProofs(),
    OtherBarriers(("winslow",)),
    ExpectedSpacing(),
    OtherBarriers(("modified_liao", "area_winslow"), most_nodes=_SMALL),
    SmallestJacobianOfAll(),
    ProofSearch(DEFAULT_BUDGET),
    PowersOfSpacing(16, _SMALL),
    StretchedCoordinates(_SMALL, "modified_liao", SLOW),
    StretchedCoordinates(_SMALL),
    FeasibleStarts(DEFAULT_BUDGET),
    SliverSearch(DEFAULT_BUDGET),
    CoarseGrids(((2, 1), (1, 2), (3, 3))),
    FeasibleStarts(LARGE_BUDGET),
    ProofSearch(LARGE_BUDGET),
    SliverSearch(LARGE_BUDGET),
)

#: Strategies where boundary nodes slide: first they stay. Nothing looks for proofs, which would hold for boundary nodes
#: where they are now, nor goes on for as long as where the boundary has no freedom.
SLIDING_STRATEGIES: tuple[Strategy, ...] = (
    FixedBoundary(),
    *REGULARIZED,
    SmallestJacobian(),
    OtherBarriers(("winslow",)),
    ExpectedSpacing(),
    OtherBarriers(("modified_liao", "area_winslow"), most_nodes=_SMALL),
)


def begin_search(
    problem: Problem,
    functional: Functional,
    coordinates: Array,
    parameters: Mapping[str, float] | None,
    progress: Progress,
) -> Search:
    """Return a search that begins at a grid (2, ni, nj), which it does not change."""
    return Search(problem, functional, parameters, progress, coordinates.copy(), REGULARIZED)


def untangle_regularized(
    problem: Problem,
    functional: Functional,
    coordinates: Array,
    parameters: Mapping[str, float] | None,
    progress: Progress,
) -> bool:
    """Follow the regularized barrier to a valid grid, in place; return whether the grid is valid.

    Stops at the first valid grid; where only corners are left whose three nodes are all fixed; or where progress has
    ended: epsilon falls and falls, and no cell unfolds any more, nor does the worst fold become shallower, or epsilon
    has become so small that rounding decides. The grid with the fewest folded cells is left, whatever ends it.
    """
    search = begin_search(problem, functional, coordinates, parameters, progress)
    return search.run_into(coordinates, REGULARIZED)
