"""The table of the examples: Markdown for a file, plain text for the screen."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from ..grids import Grid
from .case import Case
from .claim import Claim

Row = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture: its file, its panels (titles and grids) and how many of them are in a row."""

    file: str
    panels: tuple[tuple[str, Grid], ...]
    columns: int


@dataclass(frozen=True, slots=True)
class Example:
    """One section of the paper, run again.

    Attributes:
        section: its number in the paper.
        title: its title.
        setting: domain and number of cells.
        cases: the grids.
        claims: what the paper says of them, decided.
        pictures: what is drawn.
        notes: what else must be known.
    """

    section: str
    title: str
    setting: str
    cases: tuple[Case, ...]
    claims: tuple[Claim, ...]
    pictures: tuple[Picture, ...]
    notes: tuple[str, ...] = ()

    def case(self, label: str) -> Case:
        """Return the case of a label."""
        return next(case for case in self.cases if case.label == label)


_INTRODUCTION = """\
# Section 3 of the paper, run again

S. K. Khattri, *Grid Generation and Adaptation by Functionals*. As there, each grid starts from linear transfinite
interpolation and is found by the local method, one node at a time. J is the Jacobian at a corner of a cell, with unit
steps of the index; a cell is folded where J ≤ 0 at one of its corners, so that a grid without folded cells has convex
cells only. J/mean is the smallest J over the mean one; scaled J the smallest J/(|g1| |g2|), the sine of a corner's
angle; K = (g11 + g22)/J ≥ 2 is 2 for squares, its mean is over the corners with J > 0; the area ratio is the largest
of two neighbors. Energies are the discrete ones, over all corners of all cells. Of two grids a valid one is better
than a folded one; two valid ones are compared measure by measure, leaving out what is within 1 % of each other."""


def markdown(examples: Iterable[Example]) -> str:
    """Return the whole report as Markdown."""
    return "\n\n".join([_INTRODUCTION, *(_markdown_section(example) for example in examples)]) + "\n"


def _markdown_section(example: Example) -> str:
    head, *body = _rows(example.cases)
    claims = [("claim", "measured", "verdict"), *((c.paper, c.measured, c.verdict) for c in example.claims)]
    parts = [
        f"## {example.section} {example.title}",
        f"On {example.setting}.",
        *(f"![{example.title}]({picture.file})" for picture in example.pictures),
        _markdown_table(head, body),
        _markdown_table(claims[0], claims[1:]),
        *example.notes,
    ]
    return "\n\n".join(parts)


def _markdown_table(head: Row, body: Sequence[Row]) -> str:
    rule = tuple("---" for _ in head)
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in (head, rule, *body))


def text(example: Example) -> str:
    """Return one section as plain text."""
    rows = _rows(example.cases)
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    lines = ["", f"{example.section} {example.title}: {example.setting}", ""]
    for row in rows:
        cells = (
            cell.ljust(w) if k == 0 else cell.rjust(w) for k, (cell, w) in enumerate(zip(row, widths, strict=True))
        )
        lines.append("  " + "  ".join(cells).rstrip())
    for claim in example.claims:
        lines += ["", f"  Claim: {claim.paper}", f"  Measured: {claim.measured}.", f"  The claim {claim.verdict}."]
    for note in example.notes:
        lines += ["", f"  {note}"]
    return "\n".join(lines)


def _rows(cases: Sequence[Case]) -> list[Row]:
    """Return the table of the cases, its head first; extra columns in the order in which cases bring them."""
    extra = list(dict.fromkeys(name for case in cases for name in case.extra))
    head = (
        *("grid", "folded cells", "smallest J", "J/mean", "scaled J", "mean K", "area ratio"),
        *extra,
        *("energy at start", "energy", "work", "converged"),
    )
    return [head, *(_row(case, extra) for case in cases)]


def _row(case: Case, extra: Sequence[str]) -> Row:
    quality = case.quality
    return (
        case.label,
        f"{quality.folded_cells} of {quality.cells}",
        f"{quality.min_jacobian:.2e}",
        f"{case.evenness:.3g}",
        f"{quality.min_scaled_jacobian:.2f}",
        f"{quality.mean_condition:.3g}",
        f"{quality.max_area_ratio:.3g}",
        *(f"{case.extra[name]:.3f}" if name in case.extra else "–" for name in extra),
        _number(case.start_energy),
        _number(case.energy),
        case.effort or "–",
        {True: "yes", False: "no", None: "–"}[case.converged],
    )


def _number(value: float | None) -> str:
    return "–" if value is None else f"{value:.4g}"
