"""How good a grid is: folded cells and the usual measures, over all corners of all cells."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from .grid import Grid, check_grid, corner_jacobians, folded_corners
from .orthogonality import Deviation, SideQuality, corner_deviation, side_qualities


@dataclass(frozen=True, slots=True)
class Quality:
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

    Raises:
        GridgenError: if `grid` is no Grid.
    """
    check_grid(grid)
    with np.errstate(all="ignore"):  # Divisions by 0 are meant, and their results are replaced below.
        jacobians = corner_jacobians(grid.x, grid.y)
        xi_edges, eta_edges = _edges(grid)
        folded = np.argwhere(folded_corners(jacobians).any(axis=0))
        return Quality(
            cells=jacobians[0].size,
            folded_cells=len(folded),
            min_jacobian=float(jacobians.min()),
            mean_jacobian=float(jacobians.mean()),
            max_jacobian=float(jacobians.max()),
            **_corner_measures(jacobians, xi_edges, eta_edges),
            max_aspect_ratio=_aspect_ratio(xi_edges, eta_edges),
            max_area_ratio=_area_ratio(jacobians.mean(axis=0)),
            non_orthogonality=corner_deviation(grid),
            sides=side_qualities(grid),
            folded=folded,
            folded_centers=_centers(grid, folded),
        )


def _edges(grid: Grid) -> tuple[Array, Array]:
    """Return the edge vectors along xi, shape (2, ni-1, nj), and along eta, shape (2, ni, nj-1)."""
    return np.diff(grid.planes, axis=1), np.diff(grid.planes, axis=2)


def _corner_measures(jacobians: Array, xi_edges: Array, eta_edges: Array) -> dict[str, Any]:
    """Return the measures that each corner has for itself: scaled Jacobian, condition number, angle."""
    low, high = slice(None, -1), slice(1, None)
    corners = ((low, low, False), (low, high, True), (high, high, False), (high, low, True))
    scaled, angles, conditions = [], [], []
    for J, (xi_edge, eta_edge, turned) in zip(jacobians, corners, strict=True):
        g1, g2 = xi_edges[:, :, xi_edge], eta_edges[:, eta_edge]
        g11, g22, g12 = (g1**2).sum(axis=0), (g2**2).sum(axis=0), (g1 * g2).sum(axis=0)
        product = np.sqrt(g11) * np.sqrt(g22)
        scaled.append(np.where(product > 0, J / product, 0.0).min())
        # At the corners 1 and 3 one of the two edges points into the corner: the inner angle is the
        # supplement.
        angle = np.arctan2(J, -g12 if turned else g12) % (2 * np.pi)
        angles.append(np.where(product > 0, angle, 0.0))
        conditions.append(np.where(J > 0, (g11 + g22) / J, np.inf))
    finite = np.concatenate([c[np.isfinite(c)] for c in conditions])
    return {
        "min_scaled_jacobian": float(min(scaled)),
        "mean_condition": float(finite.mean()) if finite.size else np.inf,
        "max_condition": float(max(c.max() for c in conditions)),
        "min_angle": float(np.degrees(min(a.min() for a in angles))),
        "max_angle": float(np.degrees(max(a.max() for a in angles))),
    }


def _aspect_ratio(xi_edges: Array, eta_edges: Array) -> float:
    """Return the largest aspect ratio of a cell."""
    xi, eta = np.hypot(*xi_edges), np.hypot(*eta_edges)
    width, height = xi[:, :-1] + xi[:, 1:], eta[:-1] + eta[1:]
    return _largest_ratio(width, height)


def _area_ratio(area: Array) -> float:
    """Return the largest ratio of the areas of two neighbors."""
    if not (area > 0).all():
        return np.inf
    return max(_largest_ratio(area[1:], area[:-1]), _largest_ratio(area[:, 1:], area[:, :-1]))


def _largest_ratio(a: Array, b: Array) -> float:
    """Return the largest of a/b and b/a; inf where one of them is 0."""
    small, large = np.minimum(a, b), np.maximum(a, b)
    return float(np.where(small > 0, large / small, np.inf).max())


def _centers(grid: Grid, cells: NDArray[np.intp]) -> Array:
    """Return the means of the four nodes of the given cells, shape (n, 2)."""
    i, j = cells.T
    nodes = grid.planes[:, [i, i + 1, i + 1, i], [j, j, j + 1, j + 1]]
    return np.asarray(nodes.mean(axis=1).T)


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
