"""Section 3.1: grids adapted by the area functional, with the paper's two weights on the unit square.

Two things must be known of this example. The area functional is degenerate (its principal symbol has no
determinant), and the weights change from node to node by more than a factor of five near their zero lines: the
corners of one cell, with their different weights, pull it out of shape. The sweeps first spread the nodes as the
weight asks and then roughen the grid, so they are stopped, as the paper's smooth figures must have been. And the
second weight is negative on almost half of the square, where larger cells have less energy (erratum E8).

What the paper was after is had by `adapt`: a smoothed weight, damped, and a little of winslow beside the area
(`area_winslow`). Its grids are shown beside those of the sweeps; of the second weight the positive part is taken there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Literal

import numpy as np

from ..adaptation import adapt
from ..adaptation.equidistribution import cell_means, equidistribution
from ..boundary import domain
from ..errors import GridgenError
from ..fields import Weight
from ..grids import Grid
from ..solvers import energy
from .case import Case, sweep
from .claim import Claim, decide
from .report import Example, Picture

FIRST = "5 + 200*abs(sin(2*pi*x)*sin(2*pi*y))"
SECOND = "5 + 200*sin(2*pi*x)*sin(2*pi*y)"
#: The second weight with its sine terms cut where they are negative: 5 there.
POSITIVE_PART = "5 + 100*(sin(2*pi*x)*sin(2*pi*y) + abs(sin(2*pi*x)*sin(2*pi*y)))"
#: An odd number of cells: no node starts on the lines x = 1/2 and y = 1/2, where the first weight has a kink.
CELLS = 29
#: Sweeps: until the nodes have spread; fewer with the weight that is negative somewhere, guarded or not; too many.
STOP, STOP_NEGATIVE, STOP_FREE, TOO_MANY = 6, 2, 3, 100
PRODUCT, ROOT_PRODUCT, FRACTION = "spread of s·J", "spread of √s·J", "cells where s > 0"


def spreads(grid: Grid, formula: str) -> dict[str, float]:
    """Return the spread of s·J and √s·J over the cells (standard deviation over mean), or where the cells are.

    The spreads mean nothing where s is negative and are left out then; in their place stands the fraction of the cells
    whose weight is positive.
    """
    centers = np.stack([cell_means(plane) for plane in grid.planes])
    s = Weight(formula, allow_negative=True).planes(centers, ("s",))[0]
    if s.min() < 0:
        return {FRACTION: float((s > 0).mean())}
    found = equidistribution(grid, formula)
    return {PRODUCT: found.weight.variation, ROOT_PRODUCT: found.root.variation}


def adaptive_area(say: Callable[[str], None]) -> Iterator[Example]:
    """Yield the example of Section 3.1, with its two pictures."""
    say("3.1  adaptive area, s = 5 + 200 |sin 2πx sin 2πy|")
    first = _first_weight()
    say("3.1  adaptive area, s = 5 + 200 sin 2πx sin 2πy, negative on almost half of the square")
    second, refusal = _second_weight()
    yield Example(
        section="3.1",
        title="Adaptive grid by the area functional",
        setting=(
            f"the unit square, {CELLS} x {CELLS} cells; the sweeps are stopped by hand, after {STOP} with the first "
            f"weight and {STOP_NEGATIVE} with the second, and not converged"
        ),
        cases=(*first.values(), *second.values()),
        claims=(*_first_claims(first), *_second_claims(second)),
        pictures=(_figures(first, second), _modes(first)),
        notes=_notes(first, second, refusal),
    )


def _adapt(
    label: str,
    formula: str,
    sweeps: int,
    mode: Literal["frozen", "differentiated"] = "frozen",
    *,
    keep_valid: bool = True,
) -> Case:
    weight = Weight(formula, mode=mode, allow_negative=formula == SECOND)
    start = domain("square", CELLS + 1, CELLS + 1)
    case = sweep(label, start, "area", weight=weight, sweeps=sweeps, keep_valid=keep_valid)
    return replace(case, extra=spreads(case.grid, formula))


def _start(label: str, formula: str) -> Case:
    grid = domain("square", CELLS + 1, CELLS + 1)
    value = energy(grid, "area", weight=Weight(formula, allow_negative=True), spacing="index")
    return Case(label, grid, start_energy=value, energy=value, extra=spreads(grid, formula))


def _settled(label: str, formula: str, measured: str) -> Case:
    """Return the grid that settles under a weight when it is smoothed and winslow keeps the cells in shape.

    Args:
        label: of the case.
        formula: of the weight.
        measured: formula of the weight by which the paper's claim is measured.
    """
    result = adapt(domain("square", CELLS + 1, CELLS + 1), formula, monitor="values", boundary="fixed", progress=False)
    return Case(
        label,
        result.grid,
        f"{result.iterations} steps of adapt",
        converged=result.converged,
        message=result.message,
        extra=spreads(result.grid, measured) | spreads(result.grid, formula),
    )


def _first_weight() -> dict[str, Case]:
    return {
        "start": _start("first weight, start", FIRST),
        "frozen": _adapt("first weight, frozen", FIRST, STOP),
        "unguarded": _adapt("first weight, frozen, cells free to fold", FIRST, STOP, keep_valid=False),
        "differentiated": _adapt("first weight, differentiated", FIRST, STOP, "differentiated"),
        "ragged": _adapt("first weight, frozen, continued", FIRST, TOO_MANY),
        "settled": _settled("first weight, area and winslow", FIRST, FIRST),
    }


def _second_weight() -> tuple[dict[str, Case], str]:
    """Return the cases of the weight that is negative somewhere, and the words with which it is refused at first."""
    refusal = ""
    try:
        sweep("refused", domain("square", CELLS + 1, CELLS + 1), "area", weight=Weight(SECOND), sweeps=1)
    except GridgenError as error:
        refusal = str(error)
    cases = {
        "start": _start("second weight, start", SECOND),
        "frozen": _adapt("second weight, insisted on", SECOND, STOP_NEGATIVE),
        "longer": _adapt("second weight, continued", SECOND, TOO_MANY),
        "unguarded": _adapt(
            "second weight, differentiated, cells free to fold", SECOND, STOP_FREE, "differentiated", keep_valid=False
        ),
        "settled": _settled("second weight, its positive part, area and winslow", POSITIVE_PART, SECOND),
    }
    return cases, refusal


def _adapted(start: Case, case: Case, which: str = PRODUCT) -> tuple[str, bool]:
    """Say how a spread over the cells has changed, and whether it is smaller."""
    before, after = start.extra[which], case.extra[which]
    return f"{case.label}, {case.effort}: {which} from {before:.3f} to {after:.3f}", after < before


def _even(case: Case, than: Case) -> tuple[str, bool]:
    """Say how uneven neighbors are in area on two grids, and whether those of the first are less so."""
    ours, theirs = case.quality.max_area_ratio, than.quality.max_area_ratio
    text = f"the largest area ratio of neighbors is {ours:.3g}, to {theirs:.3g} of {than.label} ({than.effort})"
    return text, ours < theirs


def _first_claims(cases: dict[str, Case]) -> list[Claim]:
    free = cases["unguarded"].quality.folded_cells
    return [
        decide(
            f"The grid adapts: small cells where s is large (first weight, stopped by hand after {STOP} sweeps).",
            _adapted(cases["start"], cases["frozen"]),
            _adapted(cases["start"], cases["differentiated"], ROOT_PRODUCT),
        ),
        decide(
            "The same, by area_winslow until it settles (not in the paper).",
            _adapted(cases["start"], cases["settled"]),
            _even(cases["settled"], cases["frozen"]),
        ),
        decide(
            f"Even after adaptation the meshes are convex (first weight, after {STOP} sweeps).",
            (f"{cases['frozen'].quality.folded_cells} folded cells with keep_valid", cases["frozen"].quality.valid),
            (f"{free} folded cells without", free == 0),
        ),
        decide(
            "Area functionals can be used for generating robust adaptive meshes (the paper's Conclusions).",
            _adapted(cases["start"], cases["frozen"]),
            _adapted(cases["start"], cases["ragged"]),
        ),
    ]


def _second_claims(cases: dict[str, Case]) -> list[Claim]:
    before, after = (cases[key].extra[FRACTION] for key in ("start", "frozen"))
    guarded, free = cases["frozen"], cases["unguarded"]
    settled = cases["settled"]
    more = settled.extra[FRACTION]
    lowest = min(case.energy or 0.0 for case in cases.values())
    return [
        decide(
            "The grid adapts: small cells where s is large (second weight, stopped by hand after "
            f"{STOP_NEGATIVE} sweeps).",
            (f"the fraction of cells where s > 0 goes from {before:.2f} to {after:.2f}", after > before),
        ),
        decide(
            "The same, by area_winslow with the positive part of the weight until it settles (not in the paper).",
            (
                f"the fraction of cells where s > 0 goes from {before:.2f} to {settled.extra[FRACTION]:.2f}",
                more > before,
            ),
            _even(settled, cases["longer"]),
        ),
        decide(
            f"Even after adaptation the meshes are convex (second weight, after {STOP_NEGATIVE} sweeps).",
            (f"{guarded.quality.folded_cells} folded cells with keep_valid", guarded.quality.valid),
            (f"{free.quality.folded_cells} folded cells without", free.quality.valid),
        ),
        decide(
            "Implied: with the second weight, too, the area functional has a minimum, wherever nodes may go.",
            (
                f"the energy falls from {cases['start'].energy:.3g} to {guarded.energy:.3g} in {guarded.effort} and "
                f"to {cases['longer'].energy:.3g} in {cases['longer'].effort}; where cells may fold, to "
                f"{free.energy:.3g} in {free.effort} (erratum E8)",
                lowest >= 0,
            ),
        ),
    ]


def _figures(first: dict[str, Case], second: dict[str, Case]) -> Picture:
    """Return the paper's Figures 1 and 2, side by side as printed, and below each what area_winslow makes of it."""
    a, b = first["frozen"], second["frozen"]
    c, d = first["settled"], second["settled"]
    return Picture(
        "3_1_adaptive_area.png",
        (
            (
                "Adapted grid by the area functional\ns = 5 + 200 |sin 2πx sin 2πy|\n"
                f"spread of s·J {first['start'].extra[PRODUCT]:.2f} → {a.extra[PRODUCT]:.2f}, {a.effort}",
                a.grid,
            ),
            (
                "Adapted grid by the area functional\ns = 5 + 200 sin 2πx sin 2πy, partly negative\n"
                f"cells where s > 0: {second['start'].extra[FRACTION]:.0%} → {b.extra[FRACTION]:.0%}, {b.effort}",
                b.grid,
            ),
            (
                f"Better: area_winslow, weight smoothed\nspread of s·J {c.extra[PRODUCT]:.2f}, {c.effort}, {_end(c)}",
                c.grid,
            ),
            (
                "Better: area_winslow, positive part of the weight\n"
                f"cells where s > 0: {d.extra[FRACTION]:.0%}, {d.effort}, {_end(d)}",
                d.grid,
            ),
        ),
        columns=2,
    )


def _end(case: Case) -> str:
    return "converged" if case.converged else "not converged"


def _modes(first: dict[str, Case]) -> Picture:
    """Return what the paper does not show: both modes of the weight, what too many sweeps do, and a cure."""
    names = (
        ("frozen", "weight frozen"),
        ("differentiated", "weight differentiated"),
        ("ragged", "weight frozen"),
        ("settled", "area and winslow, weight smoothed"),
    )
    return Picture(
        "3_1_weight_modes.png",
        tuple(
            (
                f"{title}, {first[key].effort}\nspread of s·J {first[key].extra[PRODUCT]:.2f}, "
                f"of √s·J {first[key].extra[ROOT_PRODUCT]:.2f}",
                first[key].grid,
            )
            for key, title in names
        ),
        columns=2,
    )


def _notes(first: dict[str, Case], second: dict[str, Case], refusal: str) -> tuple[str, ...]:
    ragged = first["ragged"].extra[PRODUCT]
    return (
        "The area functional is degenerate, and near its zero lines the weight grows several times over from one "
        f"node to the next. Stopped after {first['frozen'].effort}, the grid is smooth; after "
        f"{first['ragged'].effort} it is ragged (spread of s·J {ragged:.2f}), and it is still not converged.",
        f"The cure: “{first['settled'].message}” The spread of s·J is {first['settled'].extra[PRODUCT]:.2f} then "
        f"(first weight, smoothed over the nodes; the functional area_winslow).",
        f"By default the second weight is refused: “{refusal}”",
        f"With Weight(..., allow_negative=True) the program says: “{second['frozen'].message}”",
    )
