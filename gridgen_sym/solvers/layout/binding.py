"""Bind a functional to the blocks of a layout, with checked input."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from ...arrays import Mask
from ...errors import GridgenError, quoted
from ...fields.weight import Source, Weight
from ...functionals.definition import Functional
from ...grids import Grid
from ...topology import MultiBlock
from ...topology.steps import unit_steps
from ..binding import make_problem
from ..logical import LogicalRectangle, Spacing
from ..problem import Problem
from ..run.checks import check_size, fixed_mask
from .problem import LayoutProblem
from .slide import LayoutSlide
from .slide_choice import make_layout_slide


def make_layout_problem(
    layout: MultiBlock,
    functional: str | Functional,
    *,
    weight: Weight | Source | Mapping[str, object] | None = None,
    fields: Mapping[str, object] | None = None,
    target: object = None,
    slide: object = None,
    fixed: Mapping[str, npt.ArrayLike] | None = None,
    parameters: Mapping[str, float] | None = None,
    rectangles: Sequence[LogicalRectangle] | None = None,
    arrays_of: Sequence[tuple[int, int]] | None = None,
    spacing: Spacing = "unit",
    backend: str | None = None,
) -> LayoutProblem:
    """Bind a functional to every block.

    What is given as a mapping from names of blocks has a value for each block; anything else is the same for all.

    Args:
        layout: the blocks.
        functional: what is minimized.
        weight: as in `optimize`.
        fields: likewise.
        target: likewise; a layout of the same shape is a reference.
        slide: what slides of the outer boundary; see `make_layout_slide`.
        fixed: masks of inner nodes that do not move, by the names of blocks.
        parameters: of the functional.
        rectangles: the logical rectangles of the blocks; by default those of `spacing`.
        arrays_of: the shapes of the blocks that arrays of values belong to, where these are finer ones.
        spacing: the logical steps: `unit`, `index`, or two numbers.
        backend: `c` or `numpy`.

    Raises:
        GridgenError: as for one block; the block is named.
    """
    made = rectangles or logical_rectangles(layout, spacing)
    if isinstance(target, MultiBlock):
        target = blocks_of(layout, target)
    held = _masks(layout, fixed)
    problems: list[Problem] = []
    for number, (name, grid) in enumerate(zip(layout.names, layout.blocks, strict=True)):
        if number and weight is None and not fields and target is None and problems[0].inputs is None:
            if arrays_of is None or grid.shape == arrays_of[number]:  # Coarser grids have nodes of the finest.
                check_size(grid)
            steps = made[number].steps(grid.shape)
            problems.append(Problem(problems[0].kernels, fixed_mask(grid, None), None, steps=steps))
            continue
        own: dict[str, Any] = {
            "weight": _of_block(weight, layout, name),
            "target": _of_block(target, layout, name),
            "fields": {key: _of_block(value, layout, name) for key, value in fields.items()} if fields else fields,
        }
        home = grid.shape if arrays_of is None else arrays_of[number]
        try:
            problems.append(
                make_problem(
                    grid,
                    functional,
                    **own,
                    parameters=parameters,
                    arrays_of=home,
                    spacing=made[number],
                    backend=backend,
                )
            )
        except GridgenError as error:
            if len(layout) == 1:
                raise
            raise type(error)(f"block {name}: {error}") from error
    sliding = slide if isinstance(slide, LayoutSlide | None) else make_layout_slide(layout, slide)
    return LayoutProblem(problems, layout.copies, held, layout.bonds, sliding)


def logical_rectangles(layout: MultiBlock, spacing: Spacing) -> list[LogicalRectangle]:
    """Return the logical rectangle of each block."""
    if isinstance(spacing, str) and spacing == "unit":
        steps = unit_steps(layout)
        return [
            LogicalRectangle((h_xi * (grid.shape[0] - 1), h_eta * (grid.shape[1] - 1)))
            for (h_xi, h_eta), grid in zip(steps, layout.blocks, strict=True)
        ]
    return [LogicalRectangle.of(spacing, grid.shape) for grid in layout.blocks]


def blocks_of(layout: MultiBlock, reference: MultiBlock) -> dict[str, Grid]:
    """Return the blocks of a reference by the names of a layout.

    Raises:
        GridgenError: if they have other shapes.
    """
    shapes, came = ([grid.shape for grid in one.blocks] for one in (layout, reference))
    if shapes != came:
        raise GridgenError(f"a reference must have blocks of the shapes {shapes}; came {came}")
    return dict(zip(layout.names, reference.blocks, strict=True))


def _of_block(given: Any, layout: MultiBlock, name: str) -> Any:  # noqa: ANN401
    """Return what is given for a block."""
    if not isinstance(given, Mapping):
        return given
    if set(given) != set(layout.names):
        raise GridgenError(
            f"values by block need one for each of {', '.join(layout.names)}; came {quoted(sorted(map(str, given)))}"
        )
    return given[name]


def _masks(layout: MultiBlock, fixed: Mapping[str, npt.ArrayLike] | None) -> list[Mask]:
    """Return for each block the nodes that do not move; all copies of a node alike."""
    masks = [mask.astype(np.uint8) for mask in layout.outer]
    if fixed is not None and not isinstance(fixed, Mapping):
        raise GridgenError(
            f"fixed of several blocks maps names of blocks to masks, such as {{{layout.names[0]!r}: mask}}; came "
            f"{quoted(fixed)}"
        )
    for name, given in (fixed or {}).items():
        if name not in layout.names:
            raise GridgenError(f"unknown block {quoted(name)} in fixed: the blocks are {', '.join(layout.names)}")
        number, mask = layout.names.index(name), np.asarray(given)
        if mask.shape != masks[number].shape:
            raise GridgenError(f"fixed of block {name} must have the shape {masks[number].shape}; came {mask.shape}")
        masks[number] |= mask.astype(bool)
    copies = layout.copies
    if fixed and len(copies.starts):
        held = np.array([masks[b][i, j] for b, i, j in zip(copies.block, copies.i, copies.j, strict=True)])
        any_copy = np.repeat(np.maximum.reduceat(held, copies.starts), copies.counts)
        for b, i, j, one in zip(copies.block, copies.i, copies.j, any_copy, strict=True):
            masks[b][i, j] = one
    return masks
