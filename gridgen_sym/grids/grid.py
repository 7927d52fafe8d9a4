"""The grid: node coordinates in two contiguous planes, checked once, and the Jacobians at its corners."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Array, real_array
from ..errors import GridgenError, quoted

SMALLEST = 3  # Fewer nodes along an axis leave no free node.


@dataclass(frozen=True, slots=True, init=False, eq=False, repr=False)
class Grid:
    """A structured quadrilateral grid: an immutable value.

    Axis 0 is xi (`ni` nodes), axis 1 is eta (`nj` nodes); the sides are ``bottom = xy[:, 0]``, ``top = xy[:,
    -1]``, ``left = xy[0, :]`` and ``right = xy[-1, :]``. Two grids are equal when their shapes and all
    coordinates are.

    Attributes:
        planes: read-only coordinates, shape (2, ni, nj), C order: first the plane of x, then that of y, so
            that kernels run over unit stride.
    """

    planes: Array

    def __init__(self, xy: ArrayLike) -> None:
        """Copy and check node coordinates.

        Args:
            xy: shape (ni, nj, 2), at least 3 x 3 nodes, real and finite.

        Raises:
            GridgenError: for another shape, a type that is no real number, or a NaN or infinite coordinate
                (the message names the first such node).
        """
        array = real_array(xy, "a grid's node coordinates", copy=False)
        if array.ndim != 3 or array.shape[2] != 2:
            raise GridgenError(
                f"a grid's node coordinates must have the shape (ni, nj, 2), but came with {array.shape}: "
                "stack x and y along the last axis, or use Grid.from_planes(x, y)"
            )
        self._store(np.array(np.moveaxis(array, -1, 0), order="C"))

    @classmethod
    def from_planes(cls, x: ArrayLike, y: ArrayLike) -> Grid:
        """Copy and check two planes of coordinates, each of shape (ni, nj).

        Raises:
            GridgenError: as for `Grid`, and when the two shapes differ.
        """
        px, py = real_array(x, "a grid's plane x", copy=False), real_array(y, "a grid's plane y", copy=False)
        if px.ndim != 2 or px.shape != py.shape:
            raise GridgenError(
                f"the planes x and y must have one shape (ni, nj), but came with {px.shape} and {py.shape}"
            )
        grid = object.__new__(cls)
        planes = np.empty((2, *px.shape))
        planes[0], planes[1] = px, py
        grid._store(planes)
        return grid

    def _store(self, planes: Array) -> None:
        """Keep `planes` (2, ni, nj), contiguous and referred to by nothing else, once they are known to be a grid."""
        _, ni, nj = planes.shape
        if min(ni, nj) < SMALLEST:
            raise GridgenError(
                f"a grid needs at least {SMALLEST} x {SMALLEST} nodes, but came with {ni} x {nj}: "
                "with fewer it has no inner node to move"
            )
        bad = ~np.isfinite(planes).all(axis=0)
        if bad.any():
            i, j = (int(index) for index in np.argwhere(bad)[0])
            raise GridgenError(
                f"every node must be finite, but node ({i}, {j}) is ({planes[0, i, j]}, {planes[1, i, j]}), "
                f"the first of {int(bad.sum())} such nodes: repair or interpolate them"
            )
        planes.setflags(write=False)
        object.__setattr__(self, "planes", planes)

    @property
    def x(self) -> Array:
        """The x coordinates: a read-only view of shape (ni, nj)."""
        plane: Array = self.planes[0]
        return plane

    @property
    def y(self) -> Array:
        """The y coordinates: a read-only view of shape (ni, nj)."""
        plane: Array = self.planes[1]
        return plane

    @property
    def xy(self) -> Array:
        """The node coordinates: a new array of shape (ni, nj, 2), free to be changed."""
        return np.stack((self.planes[0], self.planes[1]), axis=-1)

    @property
    def shape(self) -> tuple[int, int]:
        """The numbers of nodes (ni, nj) along xi and eta."""
        _, ni, nj = self.planes.shape
        return ni, nj

    def write(self, path: str | PathLike[str]) -> None:
        """Write the grid to a file of the kind that the suffix names; see `gridgen_sym.write`."""
        write_to_file(self, path)

    def __eq__(self, other: object) -> bool:
        """Whether `other` is a grid with the same coordinates."""
        return np.array_equal(self.planes, other.planes) if isinstance(other, Grid) else NotImplemented

    def __hash__(self) -> int:
        """Agree with `==`, under which -0.0 and 0.0 are one number."""
        return hash((self.shape, (self.planes + 0.0).tobytes()))

    def __repr__(self) -> str:
        """Report the size and the extent, not the thousands of numbers."""
        (x0, x1), (y0, y1) = ((float(p.min()), float(p.max())) for p in self.planes)
        ni, nj = self.shape
        return f"Grid({ni} x {nj} nodes, x in [{x0:g}, {x1:g}], y in [{y0:g}, {y1:g}])"

    def _repr_html_(self) -> str:
        """Show the grid in a notebook: to zoom, and to point at cells."""
        return grid_to_html(self)

    def __reduce__(self) -> tuple[Callable[..., Grid], tuple[Array, Array]]:
        """Pickle through the constructor, which restores the read-only flag that NumPy's pickling drops."""
        return Grid.from_planes, (self.planes[0], self.planes[1])


def write_to_file(made: object, path: str | PathLike[str]) -> None:
    """Write a grid of one or several blocks to a file of the kind that the suffix names."""
    _writer(made, path)


def write_grids_with(writer: Callable[[Any, str | PathLike[str]], None]) -> None:
    """Set what writes grids: `io` does, since file formats know grids, and grids no file format."""
    global _writer
    _writer = writer


def _no_writer(_: object, path: str | PathLike[str]) -> None:
    raise GridgenError(f"cannot write {path}: no file formats are loaded; import gridgen_sym.io")


_writer: Callable[[Any, str | PathLike[str]], None] = _no_writer


def grid_to_html(made: object) -> str:
    """Return what a notebook shows of a grid of one or several blocks."""
    return _html_of(made)


def show_grids_with(html_of: Callable[[Any], str]) -> None:
    """Set what notebooks show of grids: `plotting` knows pages and grids, and grids know no pages."""
    global _html_of
    _html_of = html_of


_html_of: Callable[[Any], str] = repr


def check_grid(grid: object) -> None:
    """Raise a `GridgenError` unless `grid` is one, and not an array, say, or several blocks."""
    if not isinstance(grid, Grid):
        blocks = getattr(grid, "blocks", None)
        if isinstance(blocks, tuple):  # A MultiBlock, of which this package does not know.
            raise GridgenError(
                f"expected a grid of one block, came a MultiBlock of {len(blocks)}: this is for one block; pass one of "
                "layout.blocks"
            )
        raise GridgenError(f"expected a Grid, came {type(grid).__name__}: make one with gridgen_sym.Grid(xy)")


def check_counts(ni: int, nj: int) -> None:
    """Raise a `GridgenError` unless `ni` and `nj` are numbers of nodes that a grid can have."""
    for axis, count in (("ni", ni), ("nj", nj)):
        if not isinstance(count, int | np.integer) or count < SMALLEST:
            raise GridgenError(f"{axis} must be a whole number of nodes, at least {SMALLEST}, but is {quoted(count)}")


def boundary_indices(ni: int, nj: int) -> NDArray[np.intp]:
    """Return the indices (i, j) of the boundary nodes counter-clockwise from (0, 0), shape (2 (ni + nj) - 4, 2)."""
    i, j = np.arange(ni - 1), np.arange(nj - 1)
    zero_i, zero_j = np.zeros_like(i), np.zeros_like(j)
    sides = ((i, zero_i), (zero_j + ni - 1, j), (ni - 1 - i, zero_i + nj - 1), (zero_j, nj - 1 - j))
    return np.concatenate([np.stack(side, axis=-1) for side in sides])


def folded_corners(jacobians: Array) -> NDArray[np.bool_]:
    """Return which corners are folded: those where J > 0 does not hold, so that NaN counts as folded.

    This is the one predicate of a folded corner.

    Args:
        jacobians: of corners, of any shape, as from `corner_jacobians`.
    """
    return ~np.asarray(jacobians > 0)


def corner_edges(x: Array, y: Array) -> Array:
    """Return the edge vectors at the four corners of every cell, in the order of `corner_jacobians`.

    Args:
        x: the x coordinates, shape (ni, nj).
        y: the y coordinates, shape (ni, nj).

    Returns:
        x_xi, x_eta, y_xi and y_eta, the Jacobian matrix row by row: (4, 4, ni-1, nj-1), corners along the second axis.
    """
    low, high = slice(None, -1), slice(1, None)
    corners = ((low, low), (low, high), (high, high), (high, low))
    rows = []
    for plane in (x, y):
        along_xi, along_eta = plane[1:] - plane[:-1], plane[:, 1:] - plane[:, :-1]
        rows.append(np.stack([along_xi[:, xi_edge] for xi_edge, _ in corners]))
        rows.append(np.stack([along_eta[eta_edge] for _, eta_edge in corners]))
    return np.stack(rows)


def corner_jacobians(x: Array, y: Array) -> Array:
    """Return the Jacobian J = x_xi y_eta - x_eta y_xi at the four corners of every cell.

    One-sided differences along increasing xi and eta, with unit steps in the index: J is twice the signed
    area of the triangle at that corner, and all four are positive exactly when the cell is convex and not
    inverted.

    Args:
        x: the x coordinates, shape (ni, nj).
        y: the y coordinates, shape (ni, nj).

    Returns:
        An array of shape (4, ni-1, nj-1). For cell (i, j) the corners follow counter-clockwise, at the nodes
        0: (i, j), 1: (i+1, j), 2: (i+1, j+1), 3: (i, j+1).

    Raises:
        GridgenError: for what is no such array.
    """
    if not (isinstance(x, np.ndarray) and isinstance(y, np.ndarray) and x.ndim == 2 and x.shape == y.shape):
        raise GridgenError(
            f"corner_jacobians needs two arrays of one shape (ni, nj), such as grid.x and grid.y; came "
            f"{quoted(x)} and {quoted(y)}"
        )
    x_xi, y_xi = x[1:] - x[:-1], y[1:] - y[:-1]
    x_eta, y_eta = x[:, 1:] - x[:, :-1], y[:, 1:] - y[:, :-1]
    low, high = slice(None, -1), slice(1, None)
    return np.stack(
        [
            x_xi[:, xi_edge] * y_eta[eta_edge] - x_eta[eta_edge] * y_xi[:, xi_edge]
            for xi_edge, eta_edge in ((low, low), (low, high), (high, high), (high, low))
        ]
    )
