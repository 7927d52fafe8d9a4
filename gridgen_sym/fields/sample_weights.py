"""How values between samples depend on the samples: as sparse matrices, whose rows are points and columns samples.

Interpolation is linear in the samples. These are the weights of the interpolants of `sampled`, for derivatives of grids
in samples.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from ..arrays import Array

_Indices = npt.NDArray[np.intp]


def matrix_of(weights: Array, columns: _Indices, count: int) -> Any:  # noqa: ANN401 - scipy.sparse has no types
    """Return the matrix (points, count) of some weights (k, points) of each point, and the samples that have them."""
    from scipy.sparse import csr_matrix

    rows = np.broadcast_to(np.arange(weights.shape[1]), weights.shape)
    return csr_matrix((weights.ravel(), (rows.ravel(), columns.ravel())), shape=(weights.shape[1], count))


def bilinear_weights(axes: list[Array], x: Array, y: Array) -> Any:  # noqa: ANN401
    """Return the weights of a bilinear interpolant on a raster at points within it, any shape."""
    cells, parts = [], []
    for axis, place in zip(axes, (x.ravel(), y.ravel()), strict=True):
        k = np.clip(np.searchsorted(axis, place, side="right") - 1, 0, len(axis) - 2)
        cells.append(k)
        parts.append((place - axis[k]) / (axis[k + 1] - axis[k]))
    (i, j), (s, t), width = cells, parts, len(axes[1])
    weights = np.stack(((1 - s) * (1 - t), (1 - s) * t, s * (1 - t), s * t))
    columns = np.stack([(i + a) * width + j + b for a in (0, 1) for b in (0, 1)])
    return matrix_of(weights, columns, len(axes[0]) * width)


def spline_weights(axes: list[Array], x: Array, y: Array, orders: tuple[int, int]) -> Any:  # noqa: ANN401
    """Return the weights of a derivative of a bicubic spline on a raster at points, as a linear operator.

    The spline is that of SciPy's `RectBivariateSpline`: its knots leave out the second and the last but one sample.

    Args:
        axes: of the raster, increasing.
        x: the points, within the raster.
        y: the same.
        orders: of the derivative, along each axis.
    """
    from scipy.interpolate import BSpline, make_interp_spline
    from scipy.sparse.linalg import LinearOperator

    bases, factors = [], []
    for axis, place, order in zip(axes, (x.ravel(), y.ravel()), orders, strict=True):
        spline = make_interp_spline(axis, np.eye(len(axis)), k=3)
        spline = spline.derivative(order) if order else spline
        design, width = BSpline.design_matrix(place, spline.t, spline.k), spline.k + 1
        bases.append((design.data.reshape(-1, width), design.indices.reshape(-1, width)))
        factors.append(spline.c[: design.shape[1]])
    (weight_x, i), (weight_y, j) = bases
    (across, along), count = factors, len(factors[1])
    weights = (weight_x[:, :, None] * weight_y[:, None, :]).reshape(len(i), -1).T
    columns = (i[:, :, None] * count + j[:, None, :]).reshape(len(i), -1).T
    basis = matrix_of(weights, columns, len(across) * count)
    shape = (len(axes[0]), len(axes[1]))

    def multiply(samples: Array) -> Array:
        return np.asarray(basis @ (across @ samples.reshape(shape) @ along.T).ravel())

    def transposed(values: Array) -> Array:
        return np.asarray(across.T @ (basis.T @ values.ravel()).reshape(len(across), count) @ along).ravel()

    return LinearOperator((len(i), shape[0] * shape[1]), multiply, transposed, dtype=float)


def triangle_weights(triangles: Any, simplices: _Indices, points: Array) -> Any:  # noqa: ANN401
    """Return the weights of a linear interpolant on triangles.

    Args:
        triangles: SciPy's Delaunay triangulation.
        simplices: (n,), in which each point lies.
        points: (n, 2).
    """
    transform = triangles.transform[simplices]
    first = np.einsum("nab,nb->na", transform[:, :2], points - transform[:, 2])
    weights = np.column_stack((first, 1 - first.sum(axis=1))).T
    return matrix_of(weights, triangles.simplices[simplices].T, len(triangles.points))


def cell_weights(i: _Indices, j: _Indices, s: Array, t: Array, shape: tuple[int, int]) -> Any:  # noqa: ANN401
    """Return the weights of nodes (ni, nj) at logical coordinates of cells, linear in two triangles of each."""
    lower = t <= s
    a, c = np.where(lower, 1 - s, 1 - t), np.where(lower, t, s)
    b, d = np.where(lower, s - t, 0.0), np.where(lower, 0.0, t - s)
    columns = np.stack([(i + p) * shape[1] + j + q for p, q in ((0, 0), (1, 0), (1, 1), (0, 1))])
    return matrix_of(np.stack((a, b, c, d)), columns, shape[0] * shape[1])


def nodal_weights(shape: tuple[int, int]) -> Any:  # noqa: ANN401
    """Return the weights of cells (ni-1, nj-1) at nodes (ni, nj): the mean over the cells around each node."""
    ni, nj = shape
    i, j = (index.ravel() for index in np.meshgrid(np.arange(ni), np.arange(nj), indexing="ij"))
    rows = [np.clip(i + a, 0, ni - 2) for a in (-1, 0)]
    columns = [np.clip(j + b, 0, nj - 2) for b in (-1, 0)]
    cells = np.stack([p * (nj - 1) + q for p in rows for q in columns])
    return matrix_of(np.full(cells.shape, 0.25), cells, (ni - 1) * (nj - 1))
