"""Targets: what the cells of a grid should be like, as a matrix W per corner.

The columns of W are the edge vectors that a corner should have, up to a rotation where the functional does not see it;
functionals are then of T = A W⁻¹ instead of A (P. Knupp's target-matrix paradigm, SIAM J. Sci. Comput. 23, 2001).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import Array
from ..errors import GridgenError, UnusableValueError
from ..grids import Grid
from ..grids.grid import check_grid, corner_edges
from .field import VARIABLES, Domain, Field, components_of
from .scalar import ScalarField, as_scalar


@dataclass(frozen=True, slots=True, eq=False)
class Target:
    """The edge vectors that cells should have: two lengths and the angle between them, or a matrix.

    Attributes:
        w1: length of the edges along xi: a number, a formula in xi and eta (in [0, 1]), a function of these arrays, or
            an array per node, cell or corner.
        w2: the same along eta.
        angle: between them, in degrees, in the same forms.
    """

    w1: Any
    w2: Any
    angle: Any = 90.0
    _matrix: tuple[Domain, tuple[ScalarField, ...]] | None = None

    @classmethod
    def of(cls, grid: Grid) -> Target:
        """Return the target whose corners are those of a reference grid of the same shape.

        Raises:
            GridgenError: if a corner of the reference grid is folded; it is named.
        """
        check_grid(grid)
        return cls.matrix(corner_edges(grid.x, grid.y), "logical")

    @classmethod
    def matrix(cls, source: Any, domain: Domain = "logical") -> Target:  # noqa: ANN401
        """Return the target of a matrix W, row by row: x of the edges along xi and along eta, then y of both.

        Args:
            source: four formulas, a function that returns four components, or an array (4, ...), per node, cell or
                corner, as for a `Field` of the kind `matrix`.
            domain: `logical`: functions are of xi and eta; `physical`: of x and y, evaluated again between steps.
        """
        made = components_of(Field(source, domain), "W", "matrix")
        return cls(None, None, None, (domain, made.parts))

    @property
    def domain(self) -> Domain:
        """What its functions are of."""
        return self._matrix[0] if self._matrix else "logical"

    def parts(self) -> tuple[ScalarField, ...]:
        """Return the two lengths and the angle, or the four components of the matrix."""
        if self._matrix:
            return self._matrix[1]
        names = ("w1 of the target", "w2 of the target", "the angle of the target")
        given = zip((self.w1, self.w2, self.angle), names, strict=True)
        return tuple(as_scalar(one, name, VARIABLES["logical"]) for one, name in given)

    def inverse(self, plane: Callable[[ScalarField], Array], shape: tuple[int, int]) -> tuple[Array, ...]:
        """Return the inverse of W: its four components, row by row, all per node, per cell or per corner.

        Args:
            plane: evaluates a part.
            shape: (ni, nj).

        Raises:
            GridgenError: where det W is not positive.
        """
        w11, w12, w21, w22 = self._entries([plane(part) for part in self.parts()], shape)
        determinant = w11 * w22 - w12 * w21
        bad = ~(determinant > 0)
        if bad.any():
            index = tuple(int(k) for k in np.argwhere(bad)[0])
            raise UnusableValueError(
                f"the target must have cells of positive area; det W is {determinant[index]:.6g} at "
                f"{location(determinant, shape)} {index}: lengths must be positive, the angle between 0 and 180 "
                "degrees, and a reference grid unfolded"
            )
        return w22 / determinant, -w12 / determinant, -w21 / determinant, w11 / determinant

    def _entries(self, planes: list[Array], shape: tuple[int, int]) -> list[Array]:
        planes = common_location(planes, shape)
        if self._matrix:
            return planes
        w1, w2, angle = planes
        angle = np.deg2rad(angle)
        return [w1, w2 * np.cos(angle), np.zeros_like(w1), w2 * np.sin(angle)]


def common_location(planes: list[Array], shape: tuple[int, int]) -> list[Array]:
    """Return planes at one location: where they are, if that is one, else at the corners (4, ni-1, nj-1)."""
    if len({plane.shape for plane in planes}) == 1:
        return planes
    return [_at_corners(plane, shape) for plane in planes]


def _at_corners(plane: Array, shape: tuple[int, int]) -> Array:
    if plane.ndim == 3:
        return plane
    if plane.shape != shape:
        return np.stack([plane] * 4)
    return np.stack([plane[:-1, :-1], plane[1:, :-1], plane[1:, 1:], plane[:-1, 1:]])


def location(plane: Array, shape: tuple[int, int]) -> str:
    """Return what an entry of a plane belongs to."""
    return "corner" if plane.ndim == 3 else "node" if plane.shape == shape else "cell"


def as_target(given: object) -> Target | None:
    """Return a target, or None.

    Raises:
        GridgenError: for what is no target.
    """
    if given is None or isinstance(given, Target):
        return given
    if isinstance(given, Grid):
        return Target.of(given)
    raise GridgenError(
        f"target must be a Target, such as Target.of(grid), Target(w1, w2, angle=90) or Target.matrix(...); came "
        f"{type(given).__name__}"
    )
