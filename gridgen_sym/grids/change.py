"""What a solver has made of a grid: the measures of quality that a user must not lose unawares, before and after."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ..arrays import Array
from .grid import Grid
from .orthogonality import SIDES

#: What is worse by more than this factor is reported.
_WORSE = 2.0
#: A mean deviation below this, in degrees, counts as this: right angles to a tenth of a degree may become 3 degrees.
_FEW_DEGREES = 5.0
#: First heights at a side that is no wall are reported where they are this many times those of the start.
_LOST = 10.0
#: Heights at a wall that are off by more than this factor are reported.
_UNMET = 1.2
#: So many rows of cells are measured at a time: their arrays stay in the cache.
_ROWS = 32


@dataclass(frozen=True, slots=True)
class Measures:
    """Measures of one grid, as those of `Quality`, which has more and takes ten times as long.

    Attributes:
        min_scaled_jacobian: the smallest J / (|g1| |g2|) of a corner.
        max_area_ratio: the largest ratio of the areas of two neighbors; infinite where an area is not positive.
        mean_non_orthogonality: the mean deviation of corners from 90 degrees, in degrees.
        first_heights: the median of the first heights at each side, by its name.
        wall_factors: at each wall the factor >= 1 between the first heights and those asked for, its median over the
            wall's nodes between the corners of the block.
    """

    min_scaled_jacobian: float
    max_area_ratio: float
    mean_non_orthogonality: float
    first_heights: Mapping[str, float] = field(hash=False)
    wall_factors: Mapping[str, float] = field(hash=False)

    @classmethod
    def of(cls, grid: Grid, asked: Mapping[str, Array] | None = None) -> Measures:
        """Measure a grid.

        Args:
            grid: any grid.
            asked: first heights asked for, by side, one per node of the side; NaN where nothing is asked.
        """
        with np.errstate(all="ignore"):
            scaled, deviation, areas = _corners(grid.planes)
            heights = {side: _first_heights(grid.planes, side) for side in SIDES}
            factors = {side: _factor(heights[side], values) for side, values in (asked or {}).items()}
            medians = {side: float(np.median(height[1:-1])) for side, height in heights.items()}
            return cls(scaled, _area_ratio(areas), deviation, medians, factors)

    @property
    def valid(self) -> bool:
        """Whether no cell is folded."""
        return self.min_scaled_jacobian > 0


@dataclass(frozen=True, slots=True)
class Change:
    """The measures of a start and of what a solver has made of it.

    Attributes:
        before: of the start.
        after: of the result.
        sizes_asked: whether the areas of cells were asked for, by a weight, fields or a target: then they, and first
            heights, are not called worse.
    """

    before: Measures
    after: Measures
    sizes_asked: bool = False

    @property
    def worse(self) -> tuple[str, ...]:
        """What is worse by more than a factor 2 than in a valid start, each as a phrase with its numbers.

        Nothing where the start, or the result, is folded: there is no comparison. A mean non-orthogonality below 5
        degrees counts as 5. At a side that is no wall, first heights are reported above 10 times those of the start.
        """
        before, after = self.before, self.after
        if not (before.valid and after.valid):
            return ()
        found = []
        if after.min_scaled_jacobian < before.min_scaled_jacobian / _WORSE:
            found.append(f"the smallest scaled Jacobian {_from_to(before, after, 'min_scaled_jacobian')}")
        if not self.sizes_asked and after.max_area_ratio > _WORSE * before.max_area_ratio:
            found.append(f"the largest area ratio of neighbors {_from_to(before, after, 'max_area_ratio')}")
        if after.mean_non_orthogonality > _WORSE * max(before.mean_non_orthogonality, _FEW_DEGREES):
            found.append(f"the mean non-orthogonality {_from_to(before, after, 'mean_non_orthogonality')} degrees")
        for side, factor in after.wall_factors.items():
            if factor > _WORSE * before.wall_factors[side]:
                first = f"from {before.wall_factors[side]:.3g} to {factor:.3g}"
                found.append(f"the factor between the first heights at {side} and those asked for {first}")
        if not self.sizes_asked:
            found += [self._lost(side) for side in SIDES if side not in after.wall_factors and self._is_lost(side)]
        return tuple(found)

    @property
    def warning(self) -> str:
        """One sentence on what is worse, and one on walls whose heights are not those asked for; mostly empty."""
        sentences = [f"Worse than the start: {'; '.join(self.worse)}."] if self.worse else []
        off = {side: factor for side, factor in self.after.wall_factors.items() if factor > _UNMET}
        if off:
            factors = ", ".join(f"{factor:.3g} at {side}" for side, factor in off.items())
            sentences.append(f"First heights differ from those asked for by a factor of {factors}.")
        return " ".join(sentences)

    def summary(self) -> str:
        """Return the measures before and after, in one line."""
        before, after = self.before, self.after
        parts = [
            f"scaled Jacobian min {before.min_scaled_jacobian:.4g} -> {after.min_scaled_jacobian:.4g}",
            f"area ratio max {before.max_area_ratio:.4g} -> {after.max_area_ratio:.4g}",
            f"degrees off 90 mean {before.mean_non_orthogonality:.2f} -> {after.mean_non_orthogonality:.2f}",
        ]
        for side, factor in after.wall_factors.items():
            parts.append(f"{side}, first height off by a factor {before.wall_factors[side]:.4g} -> {factor:.4g}")
        return "from the start: " + ", ".join(parts)

    def _is_lost(self, side: str) -> bool:
        return self.after.first_heights[side] > _LOST * self.before.first_heights[side]

    def _lost(self, side: str) -> str:
        first, last = self.before.first_heights[side], self.after.first_heights[side]
        kept = f'walls={{"{side}": Wall(first=...)}}'
        return f"the first heights at {side} from {first:.3g} to {last:.3g} ({kept} keeps them)"


def _from_to(before: Measures, after: Measures, name: str) -> str:
    return f"from {getattr(before, name):.3g} to {getattr(after, name):.3g}"


def _corners(planes: Array) -> tuple[float, float, Array]:
    """Return the smallest scaled Jacobian, the mean deviation from 90 degrees, and the areas (ni-1, nj-1) of cells."""
    ni, nj = planes.shape[1:]
    areas = np.empty((ni - 1, nj - 1))
    smallest, total = np.inf, 0.0
    for first in range(0, ni - 1, _ROWS):
        rows = planes[:, first : first + _ROWS + 1]
        xi, eta = np.diff(rows, axis=1), np.diff(rows, axis=2)
        xi /= (xi_length := np.hypot(*xi))
        eta /= (eta_length := np.hypot(*eta))
        area = np.zeros((xi.shape[1], nj - 1))
        for a in (slice(None, -1), slice(1, None)):
            for b in (slice(None, -1), slice(1, None)):
                sine = xi[0][:, a] * eta[1][b] - xi[1][:, a] * eta[0][b]
                sine[np.isnan(sine)] = 0.0  # An edge has no length.
                smallest = min(smallest, float(sine.min()))
                area += sine * xi_length[:, a] * eta_length[b]
                np.minimum(np.abs(sine, out=sine), 1.0, out=sine)
                total += float(np.arccos(sine, out=sine).sum())
        areas[first : first + _ROWS] = area / 4
    return smallest, float(np.degrees(total / (4 * areas.size))), areas


def _area_ratio(areas: Array) -> float:
    if not (areas > 0).all():
        return float(np.inf)
    size = np.log(areas)
    return float(np.exp(max(np.abs(np.diff(size, axis=axis)).max(initial=0.0) for axis in (0, 1))))


def _first_heights(planes: Array, side: str) -> Array:
    """Return the distance of each node of a side to the next one on its line."""
    inwards = {"bottom": planes, "top": planes[:, :, ::-1]}
    inwards |= {"left": planes.transpose(0, 2, 1), "right": planes[:, ::-1].transpose(0, 2, 1)}
    return np.asarray(np.hypot(*(inwards[side][:, :, 1] - inwards[side][:, :, 0])))


def _factor(heights: Array, asked: Array) -> float:
    """Return the median factor >= 1 between heights and those asked for, between the corners of the block."""
    apart = np.abs(np.log(heights / asked))[1:-1]
    known = apart[~np.isnan(apart)]
    return float(np.exp(np.median(known))) if known.size else 1.0
