"""Adapt a grid of several blocks: as one block, where they are one together."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..fields.function import required_arguments
from ..fields.sampled import SampledField
from ..functionals.definition import Functional
from ..functionals.registry import functional as find_functional
from ..grids import Grid
from ..solvers.layout.merged import is_one_grid
from ..solvers.run.deadline import Deadline
from ..topology import MultiBlock
from ..topology.merging import Merged, merge
from .arguments import check_arguments, valid_start
from .layout_nodes import LayoutNodes
from .lines import LineSpacing, sliding_lines
from .monitor import Monitor, as_monitor
from .mover import Mover
from .nodes import Measure
from .result import AdaptResult, LayoutAdaptResult
from .run import Callback, adapted
from .sides import Boundary
from .source import Solution, source_of
from .weight_exponent import weight_exponent_of


def adapt_layout(
    grid: MultiBlock,
    solution: Solution,
    *,
    functional: str | Functional = "area_winslow",
    monitor: Monitor | str | Measure = "curvature",
    weight_exponent: float | None = None,
    parameters: Mapping[str, float] | None = None,
    fields: Mapping[str, object] | None = None,
    target: object = None,
    max_iterations: int = 30,
    damping: float = 0.5,
    tolerance: float = 1e-3,
    boundary: Boundary = "straight",
    fixed: Mapping[str, npt.ArrayLike] | None = None,
    callback: Callback | None = None,
    time_limit: float | None = None,
    progress: bool | None = None,
    backend: str | None = None,
    of_one_block: Callable[..., AdaptResult],
) -> LayoutAdaptResult:
    """Move the nodes of several blocks to where a solution needs them; see `gridgen_sym.adapt`.

    A solver takes the `MultiBlock`, and returns nodal values for each block, by name or in their order. Nodes are moved
    once in a step. `fixed` maps names of blocks to masks. Blocks that are one together are adapted by `of_one_block`.

    Raises:
        GridgenError: as `adapt`; and for nodal values of blocks that are not one together.
    """
    check_arguments(max_iterations, None, damping, tolerance, boundary, callback, time_limit)
    common: dict[str, Any] = {
        "functional": functional,
        "monitor": monitor,
        "weight_exponent": weight_exponent,
        "parameters": parameters,
        "fields": fields,
        "target": target,
        "max_iterations": max_iterations,
        "damping": damping,
        "tolerance": tolerance,
    }
    merged = merge(grid)
    alike = fixed is None and target is None and not fields and not callable(as_monitor(monitor).measure)
    if alike and is_one_grid(merged.layout):
        given = {"callback": callback, "time_limit": time_limit, "progress": progress, "backend": backend}
        source = _on_merged(solution, grid, merged)
        return _of_all_blocks(
            partial(of_one_block, merged.layout.blocks[0], source, moves=1, boundary=boundary, **common, **given),
            grid,
            merged,
        )
    deadline, definition = Deadline(time_limit), find_functional(functional)
    exponent = weight_exponent_of(definition.name, weight_exponent)
    source = source_of(solution, grid)
    start, note = valid_start(grid, fixed, deadline, backend)
    chosen = as_monitor(monitor)
    of_functional = {"parameters": parameters, "fields": fields, "target": target}
    lines = LineSpacing(sliding_lines(start, boundary, fixed), chosen.side_exponent)
    mover = Mover(definition, exponent, of_functional, fixed or {}, backend, damping, lines, deadline)
    found = adapted(source, chosen, mover, start, note, max_iterations, 1, tolerance, callback, progress)
    assert isinstance(found, LayoutAdaptResult)
    return found


def _on_merged(solution: Any, layout: MultiBlock, merged: Merged) -> Any:  # noqa: ANN401 - as `adapt` takes it
    """Return a solution of several blocks as one of the block that they are."""
    if isinstance(solution, Mapping) or (isinstance(solution, list | tuple) and len(solution) == len(layout)):
        return _joined(LayoutNodes(layout), solution, merged)
    if not callable(solution) or isinstance(solution, SampledField) or required_arguments(solution) != 1:
        return solution

    def solve(grid: Grid) -> Array:
        on = layout.moved(merged.split([grid.planes]))
        return _joined(LayoutNodes(on), solution(on), merged)

    return solve


def _joined(nodes: LayoutNodes, values: object, merged: Merged) -> Array:
    """Return values of several blocks as those of the block that they are."""
    found = np.empty((1, *merged.layout.blocks[0].shape))
    parts = nodes.given_back(nodes.values(values, "the solution")).values()
    for place, shape, part in zip(merged.places, merged.shapes, parts, strict=True):
        place.view(found, shape)[...] = part
    return np.asarray(found[0])


def _of_all_blocks(solve: Callable[[], AdaptResult], layout: MultiBlock, merged: Merged) -> LayoutAdaptResult:
    """Adapt the block, and return the result as one on several; so with that of an error on the way."""

    def apart(values: Array) -> dict[str, Array]:
        return {name: part[0] for name, part in zip(layout.names, merged.split([values[None]]), strict=True)}

    def taken_apart(found: AdaptResult) -> LayoutAdaptResult:
        grid, start = (layout.moved(merged.split([one.planes])) for one in (found.grid, found.start))
        told = {"status": found.status, "message": found.message, "history": found.history}
        return LayoutAdaptResult(
            grid=grid,
            start=start,
            values=apart(found.values),
            density=apart(found.density),
            **told,  # type: ignore[arg-type]
        )

    try:
        return taken_apart(solve())
    except Exception as error:
        best = getattr(error, "result", None)
        if isinstance(best, AdaptResult):
            error.result = taken_apart(best)  # type: ignore[attr-defined]
        raise
