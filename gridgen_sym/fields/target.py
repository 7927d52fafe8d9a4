"""Targets: what the cells of a grid should be like, as a matrix W per corner.

The columns of W are the edge vectors that a corner should have, up to a rotation where the functional does not see it;
functionals are then of T = A W⁻¹ instead of A (P. Knupp's target-matrix paradigm, SIAM J. Sci. Comput. 23, 2001).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..arrays import Array
from ..errors import GridgenError, UnusableValueError, quoted
from ..grids import Grid, corner_jacobians
from ..grids.grid import check_grid, corner_edges
from .components import Components, components_of
from .field import VARIABLES, Domain, Field
from .locations import at_one_location, first_index, first_place, location
from .scalar import ScalarField, as_scalar
from .wall_cells import WallCells


@dataclass(frozen=True, slots=True, eq=False)
class Target:
    """The edge vectors that cells should have: two lengths and the angle between them, or a matrix.

    Attributes:
        w1: length of the edges along xi: a number, a formula in xi and eta (in [0, 1]), a function of these arrays, or
            an array per node, cell or corner. On a coarser grid of the same boundary edges are longer accordingly.
        w2: the same along eta.
        angle: between them, in degrees, in the same forms.
        parts: the two lengths and the angle, or the four components of the matrix.
        shape: (ni, nj) of the grid that its arrays belong to, if it was made of one.
    """

    w1: Any
    w2: Any
    angle: Any = 90.0
    parts: tuple[ScalarField, ...] = field(init=False, repr=False)
    shape: tuple[int, int] | None = field(default=None, kw_only=True)
    _matrix: Components | None = field(default=None, kw_only=True, repr=False)

    def __post_init__(self) -> None:
        """Read formulas."""
        if self._matrix:
            object.__setattr__(self, "parts", self._matrix.parts)
            return
        names = ("w1 of the target", "w2 of the target", "the angle of the target")
        given = zip((self.w1, self.w2, self.angle), names, strict=True)
        object.__setattr__(self, "parts", tuple(as_scalar(one, name, VARIABLES["logical"]) for one, name in given))

    @classmethod
    def of(cls, grid: Grid, angle: float | None = None) -> Target:
        """Return the target whose corners are those of a reference grid of the same shape.

        Args:
            grid: the reference grid.
            angle: in degrees, between edges of the lengths that they have in the reference grid: with 90 lines that are
                skew or have kinks there should cross at right angles. None for the angles of the reference grid.

        Raises:
            GridgenError: if a corner of the reference grid is folded; it is named. For an angle that is none.
        """
        check_grid(grid)
        folded = ~(corner_jacobians(grid.x, grid.y) > 0)
        if folded.any():
            place = first_place(folded, grid.shape, (grid.x, grid.y), "xy")
            raise GridgenError(f"the reference grid of a target must be valid; it is folded at {place}: untangle it")
        edges = corner_edges(grid.x, grid.y)
        if angle is not None:
            if not isinstance(angle, int | float) or not 0 < angle < 180:
                raise GridgenError(f"the angle of a target must be between 0 and 180 degrees; came {quoted(angle)}")
            w1, w2, turn = np.hypot(edges[0], edges[2]), np.hypot(edges[1], edges[3]), np.deg2rad(angle)
            edges = np.stack((w1, w2 * np.cos(turn), np.zeros_like(w1), w2 * np.sin(turn)))
        matrix = cls.matrix(edges)
        return replace(matrix, shape=grid.shape)

    @classmethod
    def matrix(cls, source: Any, domain: Domain = "logical") -> Target:  # noqa: ANN401
        """Return the target of a matrix W, row by row: x of the edges along xi and along eta, then y of both.

        Args:
            source: four formulas, a function that returns four components, or an array (4, ...), per node, cell or
                corner, as for a `Field` of the kind `matrix`.
            domain: `logical`: functions are of xi and eta; `physical`: of x and y, evaluated again between steps.
        """
        return cls(None, None, None, _matrix=components_of(Field(source, domain), "W", "matrix", "the target"))

    @classmethod
    def of_cells(cls, cells: WallCells) -> Target:
        """Return the target of the edge lengths and angles that walls ask for at every corner of one grid."""
        _, ni, nj = cells.along_xi.shape
        return replace(cls.matrix(cells.matrix()), shape=(ni + 1, nj + 1))

    @property
    def domain(self) -> Domain:
        """What its functions are of."""
        return self._matrix.domain if self._matrix else "logical"

    @property
    def lags(self) -> bool:
        """Whether it is held while the nodes move, and evaluated again where they come to."""
        return self._matrix is not None and self._matrix.lags

    def inverse(self, plane: Callable[[ScalarField], Array], shape: tuple[int, int]) -> tuple[Array, ...]:
        """Return the inverse of W: its four components, row by row, all per node, per cell or per corner.

        Args:
            plane: evaluates a part.
            shape: (ni, nj).

        Raises:
            GridgenError: where det W is not positive.
        """
        w11, w12, w21, w22 = self._entries([plane(part) for part in self.parts], shape)
        determinant = w11 * w22 - w12 * w21
        bad = ~(determinant > 0)
        if bad.any():
            index = first_index(bad)
            raise UnusableValueError(
                f"the target must have cells of positive area; det W is {determinant[index]:.6g} at "
                f"{location(determinant, shape)} {index}: lengths must be positive, the angle between 0 and 180 "
                "degrees, and a reference grid unfolded"
            )
        return w22 / determinant, -w12 / determinant, -w21 / determinant, w11 / determinant

    def _entries(self, planes: list[Array], shape: tuple[int, int]) -> list[Array]:
        planes = at_one_location(planes, shape)
        if self._matrix:
            return planes
        w1, w2, angle = planes
        angle = np.deg2rad(angle)
        return [w1, w2 * np.cos(angle), np.zeros_like(w1), w2 * np.sin(angle)]


def as_target(given: object, shape: tuple[int, int]) -> Target | None:
    """Return a target, or None.

    Args:
        given: a `Target`, a reference grid, or None.
        shape: (ni, nj) of the grid that it is for.

    Raises:
        GridgenError: for what is no target, or a reference grid of another shape.
    """
    made = Target.of(given) if isinstance(given, Grid) else given
    if made is not None and not isinstance(made, Target):
        raise GridgenError(
            f"target must be a Target, such as Target.of(grid), Target(w1, w2, angle=90) or Target.matrix(...); came "
            f"{quoted(given)}"
        )
    if made is not None and made.shape not in (None, shape):
        raise GridgenError(
            f"the reference grid of the target has {made.shape} nodes, and this grid {shape}: each of its cells is the "
            "target of one cell, so make one of as many nodes, or give lengths as formulas, Target(w1, w2)"
        )
    return made
