"""Corrections of first heights at the walls of several blocks, one solution after the other.

The minimum has not quite the heights of its target: where a wall bends within few cells, or beside nodes that are held.
Where corrections do not help, as beside a corner whose sides have their own nodes, they end.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Self

import numpy as np

from ...arrays import Array, Mask
from ...boundary.sides import Sides
from ...boundary.wall import Wall
from ...fields.wall_cells import first_heights, height_factors, scaled_heights

#: A correction has not helped where an error is larger than the first number, and did not fall by the second.
_LARGE, _HELPS = 0.1, 0.8
#: After so many corrections that did not help. The first ones may not, while neighbors are still far off.
_MOST = 4


@dataclass(slots=True)
class WallCorrections:
    """The walls that targets are made for.

    Attributes:
        asked: what is wanted, of the blocks that have walls.
        walls: the same with corrected heights.
        errors: for block and side the last errors of the logarithms of heights.
        failures: how many corrections have not helped.
    """

    asked: Mapping[str, Sides[Wall | None]]
    walls: dict[str, Sides[Wall | None]]
    errors: dict[tuple[str, str], Array] = field(default_factory=dict)
    failures: dict[tuple[str, str], Array] = field(default_factory=dict)

    @classmethod
    def of(cls, asked: Mapping[str, Sides[Wall | None]]) -> Self:
        """Begin with what is wanted."""
        return cls(asked, dict(asked))

    def correct(self, found: Mapping[str, Array], fixed: Mapping[str, Mask]) -> float:
        """Correct the walls by a grid, and return the largest error of a height that may become better, as a part.

        Args:
            found: (2, ni, nj) of the blocks.
            fixed: their masks of nodes that do not move. At the end of a connection the first node off a wall moves.
        """
        worst = 0.0
        for name, walls in self.walls.items():
            stays = fixed[name]
            beside = stays[:, 1], stays[-2], stays[:, -2], stays[1]
            heights = first_heights(found[name])
            changed = {}
            for side, wall, wanted, height, held in zip(
                Sides._fields, walls, self.asked[name], heights, beside, strict=True
            ):
                if wall is not None and wanted is not None:
                    changed[side], error = self._corrected((name, side), wall, wanted, height, held)
                    worst = max(worst, error)
            self.walls[name] = walls._replace(**changed)
        return worst

    def _corrected(
        self, key: tuple[str, str], wall: Wall, wanted: Wall, heights: Array, held: Mask
    ) -> tuple[Wall, float]:
        """Return a corrected wall, and the largest error that may become smaller, as a part."""
        index, factor = height_factors(wanted, heights)
        error = np.abs(np.log(factor))
        before = self.errors.get(key, np.full_like(error, np.inf))
        failures = self.failures.get(key, np.where(held[index] != 0, _MOST, 0))
        failures = np.where(error > np.maximum(_HELPS * before, _LARGE), failures + 1, failures)
        hopeless = failures >= _MOST
        self.errors[key], self.failures[key] = error, failures
        changed = scaled_heights(wall, np.where(hopeless, 1.0, factor), len(heights))
        return changed, float(np.expm1(error[~hopeless].max(initial=0.0)))
