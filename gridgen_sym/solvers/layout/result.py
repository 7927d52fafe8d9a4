"""What solvers return for several blocks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from ...certificates import Certificate
from ...topology import MultiBlock
from ...topology.quality import LayoutQuality, quality
from ..run.differentiable import Differentiable
from ..run.ended import Iterated
from ..run.result import Step
from ..run.status import Status


@dataclass(frozen=True, slots=True)
class LayoutResult(Iterated, Differentiable):
    """A solved grid of several blocks.

    Attributes:
        grid: the last grid; where the solver stopped early, the best valid one that it had.
        converged: whether the convergence test is met.
        status: how the run has ended; see `Result`.
        message: why it ended, as a sentence with its numbers; also what the user must know of the result.
        iterations: Newton steps of the last stage.
        energy: the discrete energy of `grid`, over all corners of all cells.
        history: one entry per iteration of the last stage; the shape of a step is the number of its nodes, and 1.
        untangled_by: what made a folded start valid; empty where the start was valid, or the result is folded.
        certificates: proofs that no valid grid has this outer boundary, by block, as `gridgen_sym.certificates` finds
            them; of a valid result, and where outer nodes slide, there are none.
        minimum: what the grid is the minimum of, for derivatives; see `Result`.
    """

    grid: MultiBlock
    converged: bool
    status: Status
    message: str
    iterations: int
    energy: float
    history: tuple[Step, ...]
    untangled_by: str = ""
    certificates: Mapping[str, tuple[Certificate, ...]] = field(default_factory=dict)
    minimum: object = field(default=None, repr=False, compare=False)

    @property
    def quality(self) -> LayoutQuality:
        """The quality measures of the grid."""
        return quality(self.grid)
