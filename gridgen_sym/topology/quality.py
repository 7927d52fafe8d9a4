"""How good a grid of one or several blocks is."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from typing import Any, overload

import numpy as np

from ..grids import Grid, Quality
from ..grids import quality as quality_of_block
from .multiblock import MultiBlock


@dataclass(frozen=True, slots=True)
class LayoutQuality:
    """The measures of several blocks as one grid; print it to read them. Ratios of neighbors are within blocks.

    The attributes have the meaning that they have in `Quality`.

    Attributes:
        blocks: the measures of each block, by name.
        cells, folded_cells: the numbers of cells in all blocks.
        min_jacobian, mean_jacobian, max_jacobian: of all corners.
        min_scaled_jacobian: of all corners.
        mean_condition, max_condition: of all corners.
        min_angle, max_angle: in degrees.
        max_aspect_ratio, max_area_ratio: of all cells.
        mean_non_orthogonality, max_non_orthogonality: in degrees, of all corners.
    """

    blocks: Mapping[str, Quality] = field(repr=False)
    cells: int
    folded_cells: int
    min_jacobian: float
    mean_jacobian: float
    max_jacobian: float
    min_scaled_jacobian: float
    mean_condition: float
    max_condition: float
    min_angle: float
    max_angle: float
    max_aspect_ratio: float
    max_area_ratio: float
    mean_non_orthogonality: float
    max_non_orthogonality: float

    @property
    def valid(self) -> bool:
        """Whether no cell is folded."""
        return self.folded_cells == 0

    def as_dict(self) -> dict[str, Any]:
        """Return the measures as JSON has them, by the names of the attributes; `blocks` has those of each block.

        What is infinite is None.
        """
        numbers = {one.name: getattr(self, one.name) for one in fields(self) if one.name != "blocks"}
        plain = {name: value if math.isfinite(value) else None for name, value in numbers.items()}
        return {"valid": self.valid, **plain, "blocks": {name: block.as_dict() for name, block in self.blocks.items()}}

    def summary(self) -> str:
        """Return the measures as a report of several lines."""
        rows = (
            ("blocks", f"{len(self.blocks)}"),
            ("cells", f"{self.cells}"),
            ("folded cells", f"{self.folded_cells}"),
            ("Jacobian  min, mean, max", f"{self.min_jacobian:.6g}  {self.mean_jacobian:.6g}  {self.max_jacobian:.6g}"),
            ("scaled Jacobian  min", f"{self.min_scaled_jacobian:.6g}"),
            ("condition  mean, max", f"{self.mean_condition:.6g}  {self.max_condition:.6g}"),
            ("angle in degrees  min, max", f"{self.min_angle:.2f}  {self.max_angle:.2f}"),
            ("aspect ratio  max", f"{self.max_aspect_ratio:.6g}"),
            ("area ratio of neighbors  max", f"{self.max_area_ratio:.6g}"),
            ("degrees off 90  mean, max", f"{self.mean_non_orthogonality:.2f}  {self.max_non_orthogonality:.2f}"),
        )
        return "\n".join([*(f"{label:<30}{text}" for label, text in rows), self.describe_folds()])

    def __str__(self) -> str:
        """Return the report."""
        return self.summary()

    def describe_folds(self, limit: int = 5) -> str:
        """Report how many cells are folded, and where the first ones are, block by block."""
        if self.valid:
            return f"valid: no folded cell among {self.cells}"
        lines = [f"not valid: {self.folded_cells} of {self.cells} cells are folded (J <= 0 at a corner)"]
        for name, block in self.blocks.items():
            if not block.valid:
                lines += [f"block {name}: {block.describe_folds(limit)}"]
        return "\n".join(lines)


@overload
def quality(grid: Grid) -> Quality: ...


@overload
def quality(grid: MultiBlock) -> LayoutQuality: ...


def quality(grid: Grid | MultiBlock) -> Quality | LayoutQuality:
    """Measure a grid of one or several blocks; never warns, whatever edges have no length.

    Raises:
        GridgenError: if it is none.
    """
    if not isinstance(grid, MultiBlock):
        return quality_of_block(grid)
    blocks = {name: quality_of_block(block) for name, block in zip(grid.names, grid.blocks, strict=True)}
    weights = [one.cells for one in blocks.values()]

    def mean(of: Callable[[Quality], float]) -> float:
        return float(np.average([of(one) for one in blocks.values()], weights=weights))

    def least(of: Callable[[Quality], float]) -> float:
        return min(of(one) for one in blocks.values())

    def most(of: Callable[[Quality], float]) -> float:
        return max(of(one) for one in blocks.values())

    return LayoutQuality(
        blocks=blocks,
        cells=sum(weights),
        folded_cells=sum(one.folded_cells for one in blocks.values()),
        min_jacobian=least(lambda one: one.min_jacobian),
        mean_jacobian=mean(lambda one: one.mean_jacobian),
        max_jacobian=most(lambda one: one.max_jacobian),
        min_scaled_jacobian=least(lambda one: one.min_scaled_jacobian),
        mean_condition=mean(lambda one: one.mean_condition),
        max_condition=most(lambda one: one.max_condition),
        min_angle=least(lambda one: one.min_angle),
        max_angle=most(lambda one: one.max_angle),
        max_aspect_ratio=most(lambda one: one.max_aspect_ratio),
        max_area_ratio=most(lambda one: one.max_area_ratio),
        mean_non_orthogonality=mean(lambda one: one.non_orthogonality.mean),
        max_non_orthogonality=most(lambda one: one.non_orthogonality.largest),
    )
