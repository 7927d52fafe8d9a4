"""How orthogonal grids become: winslow and near_orthogonal, with boundary nodes that stay and that slide.

    python benchmarks/orthogonality.py [OUTLINE ...]

Prints the table of docs/reference/walls.md: for classical domains of 30 x 30 cells and outlines of 60 x 40 the mean of
the degrees off 90 over the corners of all cells, and of those that do not touch the boundary, and the largest area
ratio of neighbors in parentheses.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import gridgen_sym as gg

COLUMNS = [(name, slide) for slide in (None, "all") for name in ("winslow", "near_orthogonal")]


def bend() -> gg.Grid:
    """Return the start of a channel that turns by 90 degrees over a bump."""
    s, across = np.linspace(0, 1, 31), np.linspace(0, 1, 31)[:, None]
    angle = np.pi / 2 * s
    outer, inner = (
        np.stack([radius * np.sin(angle), 1 - radius * np.cos(angle) + 0.3 * np.sin(np.pi * s)], axis=-1)
        for radius in (1.6, 0.7)
    )
    first, last = (outer[end] + across * (inner[end] - outer[end]) for end in (0, -1))
    return gg.transfinite(bottom=outer, top=inner, left=first, right=last)


def starts(outlines: list[Path]) -> Iterator[tuple[str, gg.Grid]]:
    """Yield the names of the cases and their starts."""
    yield "quarter annulus", gg.domain("quarter_annulus", 31, 31)
    yield "swan", gg.domain("swan", 31, 31)
    yield "bend with a bump", bend()
    for path in outlines:
        yield f"`{path.stem}`", gg.Outline.read(path).grid(61, 41)


def measure(start: gg.Grid, name: str, slide: str | None) -> str:
    """Return one cell of the table; a run that did not converge is marked."""
    result = gg.optimize(start, name, slide=slide, progress=False)
    found, inner = result.quality, gg.quality(gg.Grid(result.grid.xy[1:-1, 1:-1]))
    mark = "" if result.converged and found.valid else " *"
    means = (f"{measured.non_orthogonality.mean:.1f}" for measured in (found, inner))
    return f"{' / '.join(means)} ({found.max_area_ratio:.1f}){mark}"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    folder = Path(__file__).parent.parent / "examples" / "outlines"
    parser.add_argument("outlines", nargs="*", type=Path, default=[folder / "texas.csv", folder / "france.csv"])
    given = parser.parse_args()
    heads = [f"`{name}`{', all sides slide' * bool(slide)}" for name, slide in COLUMNS]
    print(f"| | {' | '.join(heads)} |\n|{' --- |' * (len(heads) + 1)}")
    for case, start in starts(given.outlines):
        print(f"| {case} | {' | '.join(measure(start, *column) for column in COLUMNS)} |", flush=True)


if __name__ == "__main__":
    main()
