"""Sections 3.2 to 3.5: the functionals against each other, and against transfinite interpolation.

The paper gives its domains as pictures only. Classical domains that show the effects are used here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from ..boundary import domain
from .case import Case, converge, sweep
from .claim import Claim, better, decide
from .report import Example, Picture

CELLS, SWAN_CELLS = 20, 40


def comparisons(say: Callable[[str], None]) -> Iterator[Example]:
    """Yield the examples of Sections 3.2 to 3.5."""
    for title, example in (
        ("3.2  transfinite interpolation against Winslow on the swan", _winslow),
        ("3.3  Liao, modified Liao and area on the indented square", _liao),
        ("3.4  length, area and Knupp on the quarter annulus", _length_area_knupp),
        ("3.5  length against Knupp on the horseshoe", _length_knupp),
    ):
        say(title)
        yield example()


def _winslow() -> Example:
    start = domain("swan", SWAN_CELLS + 1, SWAN_CELLS + 1)
    algebraic = Case("transfinite interpolation", start)
    winslow = converge("Winslow", start, "winslow")
    return Example(
        section="3.2",
        title="Winslow functional against the algebraic method",
        setting=_setting("swan", SWAN_CELLS),
        cases=(algebraic, *winslow),
        claims=_winslow_claims(algebraic, winslow[-1]),
        pictures=(
            _picture(
                "3_2_winslow.png",
                ("Folded grid by transfinite interpolation", algebraic),
                ("Smooth grid by the Winslow functional", winslow[0]),
            ),
        ),
        notes=(
            f"As printed, the energy of the folded start is {winslow[-1].start_energy:.5g}, that of the Winslow grid "
            f"{winslow[-1].energy:.5g}: over folded cells the printed energy has no lower bound (erratum E6). The "
            "program therefore unfolds the start first, with a regularized barrier, and then sweeps.",
            *_too_slow(winslow),
        ),
    )


def _winslow_claims(algebraic: Case, winslow: Case) -> tuple[Claim, ...]:
    before, after = algebraic.quality, winslow.quality
    return (
        decide(
            "Algebraic methods can produce folded grids for curved domains.",
            (f"{before.folded_cells} of {before.cells} cells are folded", not before.valid),
        ),
        decide(
            "The Winslow functional smooths the grid and removes the folded grid lines.",
            (f"{after.folded_cells} of {after.cells} cells are folded", after.valid),
            (
                f"the largest area ratio of neighbors goes from {before.max_area_ratio:.3g} to "
                f"{after.max_area_ratio:.3g}",
                after.max_area_ratio < before.max_area_ratio,
            ),
        ),
    )


def _liao() -> Example:
    start = domain("indented_square", CELLS + 1, CELLS + 1)
    liao = sweep("Liao", start, "liao")
    modified = sweep("modified Liao", start, "modified_liao")
    again = sweep("modified Liao, from Liao's grid", liao.grid, "modified_liao")
    area = converge("area", start, "area")
    return Example(
        section="3.3",
        title="Liao, modified Liao and area functionals",
        setting=_setting("indented square", CELLS),
        cases=(liao, modified, again, *area),
        claims=_liao_claims(liao, modified, again, area[-1]),
        pictures=(
            _picture(
                "3_3_liao_area.png",
                ("Folded grid by the Liao functional", liao),
                ("Grid by the modified Liao functional", modified),
                ("Grid by the area functional, s = 1", area[0]),
            ),
        ),
        notes=_too_slow(area),
    )


def _liao_claims(liao: Case, modified: Case, again: Case, area: Case) -> tuple[Claim, ...]:
    folded = liao.quality.folded_cells
    return (
        decide(
            "The Liao functional folds the grid.",
            (f"{folded} of {liao.quality.cells} cells are folded", folded > 0),
        ),
        decide(
            "Modified Liao does indeed remove the inverted elements.",
            (f"{modified.quality.folded_cells} folded cells from the paper's start", modified.quality.valid),
            (f"{again.quality.folded_cells} from the folded grid of Liao", again.quality.valid),
        ),
        decide(
            "The area grid is certainly better than both Liao's and modified Liao's.",
            *better(area, liao),
            *better(area, modified),
        ),
    )


def _length_area_knupp() -> Example:
    start = domain("quarter_annulus", CELLS + 1, CELLS + 1)
    length, area, knupp = (converge(label, start, label.lower()) for label in ("length", "area", "Knupp"))
    return Example(
        section="3.4",
        title="Length, area and Knupp's functionals",
        setting=_setting("quarter annulus", CELLS),
        cases=(*length, *area, *knupp),
        claims=(
            decide(
                "The grids by the area and Knupp's functionals are better than that by the length functional.",
                *better(area[-1], length[-1]),
                *better(knupp[-1], length[-1]),
            ),
        ),
        pictures=(
            _picture(
                "3_4_length_area_knupp.png",
                ("Grid by the length functional", length[0]),
                ("Grid by the area functional, s = 1", area[0]),
                ("Grid by Knupp's functional", knupp[0]),
            ),
        ),
        notes=_too_slow(length) + _too_slow(area) + _too_slow(knupp),
    )


def _length_knupp() -> Example:
    start = domain("horseshoe", CELLS + 1, CELLS + 1)
    length, knupp = (converge(label, start, label.lower()) for label in ("length", "Knupp"))
    return Example(
        section="3.5",
        title="Length and Knupp's functionals",
        setting=_setting("horseshoe", CELLS),
        cases=(*length, *knupp),
        claims=(decide("The grid by Knupp's functional is of superior quality.", *better(knupp[-1], length[-1])),),
        pictures=(
            _picture(
                "3_5_length_knupp.png",
                ("Grid by the length functional", length[0]),
                ("Grid by Knupp's functional", knupp[0]),
            ),
        ),
        notes=_too_slow(length) + _too_slow(knupp),
    )


def _setting(name: str, cells: int) -> str:
    return f"the {name}, {cells} x {cells} cells (the paper shows its domain but does not give it)"


def _picture(file: str, *panels: tuple[str, Case]) -> Picture:
    return Picture(file, tuple((f"{caption}\n{_numbers(case)}", case.grid) for caption, case in panels), len(panels))


def _numbers(case: Case) -> str:
    """Return the second line of a panel's title; folded cells are counted below the panel."""
    smallest = f"smallest J / mean {case.evenness:.2f}"
    return f"{smallest}, mean K {case.quality.mean_condition:.2f}" if case.quality.valid else smallest


def _too_slow(cases: tuple[Case, ...]) -> tuple[str, ...]:
    """Return a note on sweeps that did not converge, and on how near their grid is to the limit."""
    if len(cases) == 1:
        return ()
    swept, end = cases
    distance = abs(swept.grid.planes - end.grid.planes).max()
    return (
        f"The paper's method has not converged for {swept.label} in {swept.effort}; its grid is shown, and the "
        f"claim is decided on the limit: {end.effort}. No coordinate differs by more than {distance:.1g}.",
    )
