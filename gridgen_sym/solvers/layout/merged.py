"""Solving with fewer, larger blocks: when that gives the same grid, and the way back to the blocks that were given."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, replace

from ...arrays import Array
from ...boundary.slide_curve import SlideCurve
from ...certificates import certificates
from ...functionals.definition import Functional
from ...functionals.metric import LOGICAL_NAMES
from ...grids import Grid, corner_jacobians
from ...topology import MultiBlock
from ...topology.merging import Merged, joined_names
from ..binding import make_problem
from ..multilevel.nested import coarse_shapes
from ..multilevel.prolongation import is_transfinite
from ..run.result import Result
from .result import LayoutResult
from .slide import LayoutSlide
from .slide_choice import make_layout_slide


def references_of(layout: MultiBlock, target: object) -> list[Array] | None:
    """Return the planes of the reference grids of all blocks; None where the target is anything else."""
    if not isinstance(target, Mapping) or set(target) != set(layout.names):
        return None
    shapes = zip((target[name] for name in layout.names), layout.blocks, strict=True)
    if not all(isinstance(one, Grid) and one.shape == block.shape for one, block in shapes):
        return None
    return [target[name].planes for name in layout.names]


def names_place(
    layout: MultiBlock, functional: Functional, parameters: Mapping[str, float] | None, backend: str | None
) -> bool:
    """Whether the density names xi or eta, which are others where blocks are put together."""
    planes = make_problem(layout.blocks[0], functional, parameters=parameters, backend=backend).kernels.planes
    return bool(set(LOGICAL_NAMES) & set(planes))


def is_one_grid(merged: MultiBlock) -> bool:
    """Whether merged blocks are a plain grid."""
    return len(merged) == 1 and not merged.bonds


def begins_from_sides(merged: MultiBlock) -> bool:
    """Whether the solver of one block costs least for merged blocks that are one.

    Where it has coarse grids they begin from the boundary, so the start's own inner nodes must be of no use: folded, or
    those of transfinite interpolation.
    """
    planes, few = merged.blocks[0].planes, len(coarse_shapes(merged.blocks[0].shape)) == 1
    return few or is_transfinite(planes) or not min(corners.min() for corners in corner_jacobians(*planes)) > 0


def sliding_sides(slide: LayoutSlide | None) -> dict[str, SlideCurve | None] | None:
    """Return what slides of a layout of one block, as its own solver takes it; None if that is a part of a side."""
    sides: dict[str, SlideCurve | None] = {}
    for line in slide.lines if slide is not None else ():
        _, i, j = line.places
        ((ni, nj),) = slide.shapes  # type: ignore[union-attr]
        on = {"bottom": (j == 0, ni), "right": (i == ni - 1, nj), "top": (j == nj - 1, ni), "left": (i == 0, nj)}
        whole = [side for side, (there, count) in on.items() if there.all() and len(there) == count]
        if not whole:
            return None
        sides[whole[0]] = None if line.own else line.curve
    return sides


def merged_slide(layout: MultiBlock, slide: object, merged: Merged) -> LayoutSlide | None:
    """Return what slides of a layout as that of its merged blocks."""
    if slide is None:
        return None
    given = slide if isinstance(slide, LayoutSlide) else make_layout_slide(layout, slide)
    return given.merged(merged)


def of_all_blocks(solve: Callable[[], LayoutResult | Result], layout: MultiBlock, merged: Merged) -> LayoutResult:
    """Solve on merged blocks, and return the result as one on those that were given.

    The result that comes with an error of the user's callback, too, is one on these.
    """

    def taken_apart(found: LayoutResult | Result) -> LayoutResult:
        blocks = found.grid.blocks if isinstance(found, LayoutResult) else [found.grid]
        grid = layout.moved(merged.split([block.planes for block in blocks]))
        if isinstance(found, LayoutResult):
            return replace(found, grid=grid, certificates=certificates(grid) if found.certificates else {})
        kept = {one.name: getattr(found, one.name) for one in fields(LayoutResult)}
        proofs = {joined_names(layout, range(len(layout))): found.certificates} if found.certificates else {}
        return LayoutResult(**kept | {"grid": grid, "certificates": proofs})

    try:
        return taken_apart(solve())
    except Exception as error:
        best = getattr(error, "result", None)
        if isinstance(best, LayoutResult | Result):
            error.result = taken_apart(best)  # type: ignore[attr-defined]
        raise
