"""The true error of nodal values on a grid, where the function that they stand for is known."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..errors import GridgenError, quoted
from ..fields.scalar import ScalarField, Source, as_scalar
from ..grids import Grid, quality
from ..grids.grid import check_grid
from .recovery import nodal_values


def interpolation_error(
    grid: Grid, function: ScalarField | Source, values: npt.ArrayLike | None = None, *, points: int = 8
) -> float:
    """Return the L2 norm over the grid of a function minus the bilinear interpolant of nodal values.

    With the values of a solver it is the error of the solution as finite elements
    see it; with those of the function itself, the error of representing the function on the grid.

    Args:
        grid: the grid.
        function: a function of two arrays (x, y), a formula in x and y as text, a SymPy expression, or samples.
        values: (ni, nj), the nodal values; by default those of the function.
        points: Gauss points along each direction of a cell. With 8, a front that is thinner than the cell is seen.

    Raises:
        GridgenError: for a folded grid, for no points, for values of another shape or not finite, of the nodes or of
            the function, and for text that is no formula.
    """
    check_grid(grid)
    if not quality(grid).valid:
        raise GridgenError("on a folded grid nodal values are no function of position: use gridgen_sym.untangle")
    if not isinstance(points, (int, np.integer)) or points < 1:
        raise GridgenError(f"points is a whole number of Gauss points, at least 1; came {quoted(points)}")
    exact = as_scalar(function, "the function")
    if exact.per_node:
        raise GridgenError(
            "the function must be known everywhere: pass nodal values as `values`, or as samples of a grid"
        )
    u = nodal_values(grid, exact.values(grid.x, grid.y) if values is None else values)
    nodes = np.concatenate((grid.planes, u[np.newaxis]))
    a, b, c, d = nodes[:, :-1, :-1], nodes[:, 1:, :-1], nodes[:, 1:, 1:], nodes[:, :-1, 1:]
    abscissas, weights = np.polynomial.legendre.leggauss(points)
    total = 0.0
    for p, along in zip((abscissas + 1) / 2, weights / 2, strict=True):
        for q, across in zip((abscissas + 1) / 2, weights / 2, strict=True):
            x, y, interpolated = a * (1 - p) * (1 - q) + b * p * (1 - q) + c * p * q + d * (1 - p) * q
            x_xi, y_xi, _ = (b - a) * (1 - q) + (c - d) * q
            x_eta, y_eta, _ = (d - a) * (1 - p) + (c - b) * p
            error = exact.values(x, y, "Gauss point of a cell") - interpolated
            total += along * across * float((error**2 * (x_xi * y_eta - x_eta * y_xi)).sum())
    return float(np.sqrt(total))
