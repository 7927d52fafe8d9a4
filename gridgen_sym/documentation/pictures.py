"""What a functional does to the classical domains, and pictures of the best and the worst of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from ..boundary import domain, domain_names
from ..codegen.derivations import summary
from ..fields import Field
from ..functionals import Functional
from ..grids import Grid, quality
from ..plotting import plot_grids
from ..selfcheck.setting import Setting
from ..solvers import Result, optimize

#: Domains with the most instructive pictures, best first; any others follow.
_TELLING = ("swan", "horseshoe", "wavy", "chevron", "quarter_annulus", "indented_square", "zee", "annulus", "naca")
_NODES = 25
_STEPS = 60


@dataclass(frozen=True, slots=True)
class Trial:
    """A functional on one classical domain.

    Attributes:
        domain: the domain's name.
        start: the transfinite grid.
        start_folds: number of its folded cells.
        result: what the default solver made of it, allowed to fold.
    """

    domain: str
    start: Grid
    start_folds: int
    result: Result

    @property
    def folds(self) -> int:
        """The number of folded cells of the result."""
        return self.result.quality.folded_cells


def trials(functional: Functional) -> tuple[Trial, ...]:
    """Solve a functional on every classical domain, the most instructive ones first."""
    names = sorted(domain_names(), key=lambda name: (*_TELLING, name).index(name))
    return tuple(_trial(functional, name) for name in names)


def _trial(functional: Functional, name: str) -> Trial:
    start = domain(name, _NODES, _NODES)
    fields = example_fields(functional) or None
    result = optimize(start, functional, fields=fields, max_iterations=_STEPS, keep_valid=False, progress=False)
    return Trial(name, start, quality(start).folded_cells, result)


def example_fields(functional: Functional) -> dict[str, Field]:
    """Return smooth fields of xi and eta for a functional that declares some: those with which it is checked, too."""
    return Setting(functional, "plain").fields(1.0)


def draw(functional: Functional, tried: Sequence[Trial], folder: Path) -> tuple[tuple[str, str], ...]:
    """Draw a grid that the functional makes beside one that it folds; return pairs of a file and what it shows."""
    panels = tuple(_panels(functional, tried))
    for k, (title, _, made) in enumerate(panels):
        plot_grids([(title, made)], folder / _file(functional.name, k))  # As small as a panel, so that its text is not.
    return tuple((_file(functional.name, k), text) for k, (_, text, _) in enumerate(panels))


def _file(name: str, k: int) -> str:
    return f"{name}-{k + 1}.png"


def _panels(functional: Functional, tried: Sequence[Trial]) -> Iterator[tuple[str, str, Grid]]:
    """Yield the title, a sentence and the grid of each picture."""
    name = functional.name
    valid = [trial for trial in tried if trial.folds == 0]
    made = next((trial for trial in valid if trial.start_folds), next(iter(valid), None))
    if made is not None:
        if made.start_folds:
            text = f"Transfinite interpolation of `{made.domain}` folds {made.start_folds} cells (red)."
            yield f"{made.domain}: the start", text, made.start
        text = f"`{name}` makes a grid of `{made.domain}` without a folded cell."
        yield f"{made.domain}: {name}", text, made.result.grid
    folded = next((trial for trial in tried if trial.folds), None)
    if folded is not None:
        cells = folded.result.quality.cells
        told = "the start could not be untangled; folded are" if summary(functional).barrier else "it folds"
        text = f"On `{folded.domain}` {told} {folded.folds} of {cells} cells (red)."
        yield f"{folded.domain}: {name}", text, folded.result.grid
