"""Folded cells and seconds on the hard list of boundaries, by five methods; writes docs/validity.md and its picture.

Regions and most outlines are read from a folder of shared domains (GRIDGEN_SYM_SHARED, else `../shared` of the
repository); without it, the classical domains and the outlines in `examples/outlines` are measured.
"""

from __future__ import annotations

import argparse
import os
import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from measure import FOLDER, OUTLINES, Table, machine
from plain_untangle import plain_untangle
from validity_text import HEAD, LIST_TEXT, SPEED_TEXT

import gridgen_sym as gg
from gridgen_sym.certificates import certificates

_SHARED = Path(os.environ.get("GRIDGEN_SYM_SHARED") or FOLDER.parent.parent / "shared") / "domains"
#: Cells a side; the horseshoes' R; seconds after which the relaxation and the plain method are stopped.
SIZES, ASPECTS, PATIENCE = (20, 40, 80, 160), (2.0, 3.0, 4.0, 4.5, 5.0, 6.0, 7.0, 8.0), 4.0
_UNTANGLED = 64
_HEADER = ("boundary", "cells", "TFI", "Laplace", "Winslow, finite differences", "winslow", "modified_liao",
           "scaled J", "angles", "energy per corner", "certified impossible")  # fmt: skip


@dataclass(frozen=True, slots=True)
class Case:
    """One boundary with its nodes.

    Attributes:
        group: heading of its table.
        name: of the boundary.
        start: its transfinite grid.
        reference: a valid grid from the literature, or None.
    """

    group: str
    name: str
    start: gg.Grid
    reference: gg.Grid | None = None


def cases(sizes: Sequence[int], quick: bool) -> Iterator[Case]:
    """Yield the hard list."""
    for size in sizes:
        for name in gg.domain_names():
            if name != "horseshoe_map":
                yield Case("Classical domains", name, gg.domain(name, size + 1, size + 1))
        for aspect in ASPECTS:
            grid = gg.domain("horseshoe_map", size + 1, size + 1, R=aspect)
            yield Case("Classical domains", f"horseshoe R = {aspect:g}", grid)
    folder = _SHARED / "outlines" if _SHARED.is_dir() else OUTLINES
    for path in sorted(folder.glob("*.csv")):
        if path.stem != "index":
            yield from _outline(path, sizes)
    for path in sorted((_SHARED / "regions").glob("*_21.npz" if quick else "*.npz")):
        with np.load(path) as archive:
            xy = archive["xy"]
        start = gg.transfinite(xy[:, 0], xy[:, -1], xy[0], xy[-1])
        yield Case("Regions", path.stem.rpartition("_")[0], start, gg.Grid(xy))


def _outline(path: Path, sizes: Sequence[int]) -> Iterator[Case]:
    """Yield an outline with both samplings; equal arc length with the corners that the file gives."""
    outline = gg.Outline.read(path)
    for size in sizes:
        nodes = size + 1
        yield Case("Outlines, default sampling", path.stem, outline.grid(nodes, nodes))
        equal = outline.grid(nodes, nodes, sampling="equal", corners=outline.corners)
        yield Case("Outlines, equal arc length and fixed corners", path.stem, equal)


@dataclass(frozen=True, slots=True)
class Outcome:
    """What a method made of a case: folded cells, processor seconds, and its mark in the table."""

    folded: int
    seconds: float
    mark: str = ""

    def __str__(self) -> str:
        """Return it as a cell of the table."""
        return f"{self.folded}{self.mark} ({self.seconds:.2g} s)"


def _measured(call: Callable[[], gg.Result]) -> tuple[Outcome, gg.Result]:
    begin = time.process_time()
    result = call()
    seconds = time.process_time() - begin
    mark = "" if result.converged else " nc"
    return Outcome(result.quality.folded_cells, seconds, mark), result


def _row(case: Case) -> tuple[list[object], dict[str, Outcome]]:
    """Run all methods on a case."""
    start, quality = case.start, gg.quality(case.start)
    outcomes = {"TFI": Outcome(quality.folded_cells, 0.0)}
    outcomes["Laplace"], _ = _measured(lambda: gg.solve_euler_lagrange(start, "length", keep_valid=False))
    outcomes["Winslow, finite differences"], _ = _measured(lambda: finite_differences(start))
    outcomes["modified_liao"], _ = _measured(lambda: gg.optimize(start, "modified_liao"))
    outcomes["winslow"], result = _measured(lambda: gg.optimize(start, "winslow"))
    proofs = "; ".join(sorted({f"{p.kind} {p.numbers.get('corner', '')}".strip() for p in certificates(start)}))
    made = result.quality
    if case.reference is not None and result.energy > gg.energy(case.reference, "winslow"):
        outcomes["winslow"] = Outcome(made.folded_cells, outcomes["winslow"].seconds, " above the reference")
    cells: list[object] = [case.name, f"{start.shape[0] - 1}²", quality.folded_cells]
    cells += [str(outcomes[name]) for name in _HEADER[3:7]]
    cells += [f"{made.min_scaled_jacobian:.2g}", f"{made.min_angle:.0f} to {made.max_angle:.0f}"]
    cells += [f"{result.energy / (4 * made.cells):.4g}", proofs]
    return cells, outcomes


def finite_differences(start: gg.Grid) -> gg.Result:
    """Solve the Winslow equations as textbooks do, from the grid as it is; the solution may be folded."""
    return gg.solve_euler_lagrange(
        start, "winslow", "relaxation", tolerance=1e-6, keep_valid=False, time_limit=PATIENCE, progress=False
    )


def hard_list(listed: Sequence[Case]) -> list[Table]:
    """Return a summary and one table for each group of cases."""
    tables: dict[str, Table] = {}
    summary = Table(
        "Summary", LIST_TEXT, ("boundaries", "cases", "impossible", *(f"valid by {n}" for n in _HEADER[2:7]))
    )
    counts: dict[str, list[int]] = {}
    for case in listed:
        table = tables.setdefault(case.group, Table(case.group, "", _HEADER))
        cells, outcomes = _row(case)
        table.add(*cells)
        count = counts.setdefault(case.group, [0] * 7)
        valid = [not outcomes[name].folded for name in _HEADER[2:7]]
        for k, one in enumerate((True, bool(cells[-1]), *valid)):
            count[k] += one
    for group, count in counts.items():
        summary.add(group, *count)
    return [summary, *tables.values()]


def speed(listed: Sequence[Case]) -> Table:
    """Compare `untangle` with the same method without coarse grids, on every folded start of the list."""
    header = ("boundary", "cells", "folded", "untangle, s", "plain, s", "plain, multigrid, s", "folded after plain")
    table, seconds = Table("Speed of untangling", SPEED_TEXT, header), []
    for case in listed:
        before = gg.quality(case.start).folded_cells
        if before and not certificates(case.start):
            ours = min(_measured(partial(gg.untangle, case.start))[0].seconds for _ in range(3))
            direct, after = _plain(case.start, multigrid=False)
            fast, _ = _plain(case.start, multigrid=True)
            seconds.append((ours, direct, fast))
            table.add(case.name, f"{case.start.shape[0] - 1}²", before, ours, direct, fast, after)
    median = [statistics.median(column) for column in zip(*seconds, strict=True)]
    table.add("**median**", "", "", *median, "")
    table.note(f"By the medians, untangle is {median[1] / median[0]:.3g} times as fast as the plain method.")
    table.note(f"With this project's multigrid in the plain method, {median[2] / median[0]:.3g} times.")
    return table


def _plain(start: gg.Grid, *, multigrid: bool) -> tuple[float, int]:
    """Return the processor seconds of the plain method, and the number of folded cells that it leaves."""
    begin = time.process_time()
    made = plain_untangle(start, multigrid=multigrid, limit=PATIENCE)
    return time.process_time() - begin, gg.quality(made).folded_cells


def picture(path: Path) -> None:
    """Draw the worst cases: transfinite, finite differences, and this project's grid."""
    lake = next(_SHARED.glob("outlines/lake_superior.csv"), OUTLINES / "france.csv")
    outline = gg.Outline.read(lake)
    worst = {
        "horseshoe R = 4.5": gg.domain("horseshoe_map", 21, 21),
        "zee": gg.domain("zee", 41, 41),
        lake.stem: outline.grid(41, 41, sampling="equal", corners=outline.corners),
    }
    panels = []
    for name, start in worst.items():
        panels += [
            (f"{name}: transfinite", start),
            ("Winslow, finite differences", finite_differences(start).grid),
            ("gg.optimize, winslow", gg.optimize(start, "winslow").grid),
        ]
    gg.plot_grids(panels, path, columns=3)


def main() -> None:
    """Measure and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="20 and 40 cells, and the regions of 20 cells only")
    parser.add_argument("--docs", type=Path, default=FOLDER.parent / "docs", help="where to write")
    options = parser.parse_args()
    os.environ.update(OMP_NUM_THREADS="1", GRIDGEN_SYM_QUIET="1")
    tables = hard_list(list(cases(SIZES[:2] if options.quick else SIZES, options.quick)))
    tables.insert(1, speed([case for case in cases((_UNTANGLED,), False) if case.start.shape[0] > _UNTANGLED]))
    picture(options.docs / "images" / "validity.png")
    facts = "\n".join(f"* {fact}" for fact in machine())
    head = HEAD.format(flags=" --quick" * options.quick, facts=facts)
    page = "\n".join([head, *(table.markdown().replace("### ", "## ", 1) for table in tables)])
    (options.docs / "validity.md").write_text(page, encoding="utf-8")
    print("wrote validity.md and its picture")


if __name__ == "__main__":
    main()
