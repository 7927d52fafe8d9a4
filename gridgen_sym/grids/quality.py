"""How good a grid is: folded cells and the usual measures, over all corners of all cells."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from .grid import Grid, check_grid
from .measures import GROUPS
from .orthogonality import Deviation, SideQuality


class _OfGrid:
    """Attributes that are computed of a grid when they are first asked for."""

    __slots__ = ("_grid",)
    _grid: Grid

    def __getattr__(self, name: str) -> Any:  # noqa: ANN401
        """Compute a measure, and those of its group: this is called for attributes that are not there yet."""
        if name not in GROUPS:
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}", name=name, obj=self)
        with np.errstate(all="ignore"):  # Divisions by 0 are meant, and their results are replaced.
            for found, value in GROUPS[name](self._grid).items():
                object.__setattr__(self, found, value)
        return object.__getattribute__(self, name)


@dataclass(frozen=True, slots=True)
class Quality(_OfGrid):
    """The measures of one grid; print it to read them.

    A corner's J is that of `corner_jacobians`, its edge vectors g1 (along xi) and g2 (along eta) are the two
    edges of the cell that meet there, g11 = g1.g1, g22 = g2.g2. A cell's area is its signed area, the mean of
    its four J.

    Attributes:
        cells: the number of cells.
        folded_cells: cells with J <= 0 at any corner; 0 for a valid grid.
        min_jacobian: the smallest corner J.
        mean_jacobian: the mean corner J, which is the mean cell area.
        max_jacobian: the largest corner J.
        min_scaled_jacobian: the smallest J / (|g1| |g2|), the sine of the corner's angle; 0 where an edge has
            no length.
        mean_condition: the mean of K = (g11 + g22) / J >= 2 over the corners with J > 0; inf if there are
            none.
        max_condition: the largest K; inf when any corner has J <= 0.
        min_angle: the smallest inner angle of a cell in degrees, in [0, 360]; 0 at a corner with an edge of
            no length.
        max_angle: the largest inner angle in degrees; over 180 at a reflex corner, about 270 in a cell turned
            over.
        max_aspect_ratio: over the cells, the largest ratio >= 1 between the mean lengths of the two edges
            along xi and of the two along eta; inf if one of these is 0.
        max_area_ratio: over pairs of cells with a common edge, the largest ratio >= 1 of their areas; inf if
            any cell's area is not positive.
        non_orthogonality: how far the angles of corners are from 90 degrees: the mean, 95 % of them, the largest.
        sides: first heights, growth and angles at each side, by `bottom`, `right`, `top` and `left`.
        folded: the indices (i, j) of the folded cells, shape (folded_cells, 2), in order.
        folded_centers: the means of their four nodes, shape (folded_cells, 2).
    """

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
    non_orthogonality: Deviation
    sides: Mapping[str, SideQuality] = field(repr=False, compare=False)
    folded: NDArray[np.intp] = field(repr=False, compare=False)
    folded_centers: Array = field(repr=False, compare=False)

    @property
    def valid(self) -> bool:
        """Whether no cell is folded."""
        return self.folded_cells == 0

    def as_dict(self) -> dict[str, Any]:
        """Return the measures as JSON has them: numbers, lists and mappings, by the names of the attributes.

        What is infinite is None.
        """
        named = asdict(replace(self, sides=dict(self.sides)))
        plain: dict[str, Any] = _plain({"valid": self.valid, **named})
        return plain

    def summary(self) -> str:
        """Return the measures as a report of several lines."""
        rows = (
            ("cells", f"{self.cells}"),
            ("folded cells", f"{self.folded_cells}"),
            ("Jacobian  min, mean, max", _numbers(self.min_jacobian, self.mean_jacobian, self.max_jacobian)),
            ("scaled Jacobian  min", _numbers(self.min_scaled_jacobian)),
            ("condition  mean, max", _numbers(self.mean_condition, self.max_condition)),
            ("angle in degrees  min, max", f"{self.min_angle:.2f}  {self.max_angle:.2f}"),
            ("aspect ratio  max", _numbers(self.max_aspect_ratio)),
            ("area ratio of neighbors  max", _numbers(self.max_area_ratio)),
            ("degrees off 90  mean, 95 %", _degrees(self.non_orthogonality)),
            *((f"{side.side}: first height", _side(side)) for side in self.sides.values()),
        )
        lines = [f"{label:<30}{text}" for label, text in rows]
        return "\n".join([*lines, self.describe_folds()])

    def __str__(self) -> str:
        """Return the report."""
        return self.summary()

    def describe_folds(self, limit: int = 5) -> str:
        """Report how many cells are folded and where the first `limit` of them are (indices and centers)."""
        if self.valid:
            return f"valid: no folded cell among {self.cells}"
        verb = "is" if self.folded_cells == 1 else "are"
        lines = [f"not valid: {self.folded_cells} of {self.cells} cells {verb} folded (J <= 0 at a corner)"]
        for (i, j), (x, y) in zip(self.folded[:limit], self.folded_centers[:limit], strict=True):
            lines.append(f"  cell ({i}, {j}) at ({x:.6g}, {y:.6g})")
        rest = self.folded_cells - max(limit, 0)
        if 0 < rest < self.folded_cells:
            lines.append(f"  and {rest} more")
        return "\n".join(lines)


def quality(grid: Grid) -> Quality:
    """Measure a grid; never warns, whatever edges have no length.

    A measure is computed when it is first asked for, with others of its kind.

    Raises:
        GridgenError: if `grid` is no Grid.
    """
    check_grid(grid)
    found = object.__new__(Quality)
    object.__setattr__(found, "_grid", grid)
    return found


def _plain(value: Any) -> Any:  # noqa: ANN401 - whatever a measure is made of
    """Return a value without arrays, tuples and infinite numbers."""
    if isinstance(value, dict):
        return {name: _plain(part) for name, part in value.items()}
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [_plain(part) for part in value]
    return None if isinstance(value, float) and not np.isfinite(value) else value


def _degrees(deviation: Deviation) -> str:
    return f"{deviation.mean:.2f}  {deviation.percentile_95:.2f}, at most {deviation.largest:.2f}"


def _side(side: SideQuality) -> str:
    """Return the measures of a side in one line."""
    _, growth, largest = side.growth
    heights = "  ".join(f"{height:.3g}" for height in side.first_heights)
    return f"{heights}; growth {growth:.3g} to {largest:.3g}; degrees off normal {_degrees(side.non_orthogonality)}"


def _numbers(*values: float) -> str:
    """Return numbers as text for the report."""
    return "  ".join(f"{value:.6g}" for value in values)
