"""Fields known by samples only: on a grid, at scattered points or on a raster, as functions of x and y.

SciPy interpolates. Values between samples are linear by default, so that no weight becomes negative between
positive samples; a `smooth` field is a cubic that has the derivatives that a differentiated weight needs. Outside the
samples (of scattered points: outside their convex hull; of a valid grid: outside its boundary) the nearest counts, and
unless that is asked for, grids with nodes there are refused.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ..arrays import Array, real_array
from ..errors import GridgenError
from ..grids import Grid, quality
from ..grids.grid import check_grid
from ..runtime.process import interruptible
from .function import difference
from .gaps import filled, gap_at
from .outside import ROUNDING, Outside, check_choice
from .sample_weights import bilinear_weights, cell_weights, nodal_weights, spline_weights, triangle_weights
from .structured import StructuredInterpolation

if TYPE_CHECKING:
    from ..geography import Projection

#: Fewer samples span no plane, and less than a grid of cubics in either direction.
_FEWEST_POINTS, _FEWEST_SMOOTH = 3, 4


@dataclass(frozen=True, slots=True, eq=False)
class SampledField:
    """A function of x and y that interpolates samples; call it with two arrays.

    Attributes:
        kind: what the samples are, in words.
        beyond: what counts outside the samples: `error` refuses grids with nodes there, `nearest` takes the nearest
            sample. A call takes the nearest one always.
        middle: of the samples along x: halfway between the least and the greatest.
        shape: of the samples.
        turned: the axes along which they were given in decreasing order; `weights` are of increasing ones.
    """

    kind: str
    beyond: Outside
    _derivative: Callable[[Array, Array, int, int], Array] | None
    _value: Callable[[Array, Array], Array]
    _covers: Callable[[Array, Array], npt.NDArray[np.bool_]]
    _missing: Callable[[Array, Array], npt.NDArray[np.bool_]] | None = None
    middle: float = 0.0
    _weights: Callable[[Array, Array, str], Any] | None = None
    shape: tuple[int, ...] = ()
    turned: tuple[int, ...] = ()

    def along(self, samples: Array, x: Array, y: Array, key: str = "") -> Array:
        """Return how the values at points, or their derivatives along `x` or `y`, change with the samples."""
        return np.asarray(self._operator(x, y, key) @ np.flip(samples, self.turned).ravel()).reshape(x.shape)

    def transposed(self, values: Array, x: Array, y: Array, key: str = "") -> Array:
        """Return the derivatives in the samples of the sum of numbers times values at points, or times derivatives."""
        found = self._operator(x, y, key).T @ values.ravel()
        return np.flip(np.asarray(found).reshape(self.shape), self.turned)

    def _operator(self, x: Array, y: Array, along: str) -> Any:  # noqa: ANN401 - scipy.sparse has no types
        """Return the matrix (points, samples) of the values at points, or of their derivatives along `x` or `y`.

        Raises:
            GridgenError: for cubics on triangles, whose slopes SciPy finds by iteration, and rasters with gaps.
        """
        if self._weights is None:
            raise GridgenError(
                f"a field sampled {self.kind}, smooth on triangles or with missing samples, has no derivatives in its "
                "samples: give a raster without gaps, or drop mode='differentiated'"
            )
        return self._weights(x, y, along)

    def __call__(self, x: Array, y: Array) -> Array:
        """Return the values at points; outside the samples, the nearest one."""
        return self._value(x, y)

    def values(self, x: Array, y: Array) -> Array:
        """Return the values at points, as a call does."""
        return self._value(x, y)

    def derivatives(self, x: Array, y: Array, along: tuple[str, ...]) -> list[npt.ArrayLike]:
        """Return the derivatives along `x`, `y`, `xx`, `xy` or `yy`: exact ones of a spline, else by differences."""
        if self._derivative is None:
            return [difference(self._value, x, y, key) for key in along]
        return [self._derivative(x, y, key.count("x"), key.count("y")) for key in along]

    def outside(self, x: Array, y: Array) -> int:
        """Return how many points lie outside the samples, where the nearest value is taken."""
        return int((~self._covers(x, y)).sum())

    def covers(self, x: Array, y: Array) -> npt.NDArray[np.bool_]:
        """Return which points lie in the samples, their edge included."""
        return self._covers(x, y)

    def missing(self, x: Array, y: Array) -> npt.NDArray[np.bool_]:
        """Return at which points the nearest sample of a raster is NaN: these are not in the samples."""
        return np.zeros(np.shape(x), dtype=bool) if self._missing is None else self._missing(x, y)

    def on_plane(self, projection: Projection) -> SampledField:
        """Return a field that is known in longitude and latitude as one in the plane of a projection, in its unit.

        Samples may count longitudes from 0 or from -180. Derivatives are taken by differences.

        Args:
            projection: of longitude and latitude onto the plane.
        """

        def places(x: Array, y: Array) -> tuple[Array, Array]:
            lon, lat = np.moveaxis(projection.to_geographic(np.stack((x, y), axis=-1)), -1, 0)
            return self.middle + (lon - self.middle + 180) % 360 - 180, lat

        return replace(
            self,
            _derivative=None,
            _value=lambda x, y: self(*places(x, y)),
            _covers=lambda x, y: self.covers(*places(x, y)),
            _missing=lambda x, y: self.missing(*places(x, y)),
        )

    def __repr__(self) -> str:
        """Say what it is."""
        return f"<field sampled {self.kind}>"


def scattered_field(
    points: npt.ArrayLike, values: npt.ArrayLike, *, smooth: bool = False, outside: Outside = "error"
) -> SampledField:
    """Interpolate samples at scattered points on their Delaunay triangles.

    Linear on each triangle (SciPy's `LinearNDInterpolator`), or `smooth`: Clough and Tocher's cubic, which has
    continuous slopes (`CloughTocher2DInterpolator`). Radial basis functions were not taken: they cost the cube of
    the number of points and overshoot at fronts.

    Args:
        points: (n, 2), at least three, not all on one line.
        values: (n,).
        smooth: whether slopes must be continuous.
        outside: refuse nodes outside the samples (`error`), or take the `nearest` sample: outside the convex hull.

    Raises:
        GridgenError: for other shapes, samples that are not finite, or points on one line.
    """
    check_choice(outside)
    position, value = real_array(points, "the points of samples"), real_array(values, "the values of samples")
    if (
        position.ndim != 2
        or position.shape[1] != 2
        or value.shape != position.shape[:1]
        or len(position) < _FEWEST_POINTS
    ):
        raise GridgenError(
            f"scattered samples need points of shape (n, 2) and values of shape (n,), n at least {_FEWEST_POINTS}; "
            f"came {position.shape} and {value.shape}"
        )
    _check_finite(np.column_stack((position, value)), "point")
    return _triangulated(position, value, f"at {len(position)} points", outside, smooth=smooth)


def grid_field(grid: Grid, values: npt.ArrayLike, *, smooth: bool = False, outside: Outside = "error") -> SampledField:
    """Interpolate values at the nodes of a grid, or in its cells.

    Linear in the two triangles of each cell; outside the grid the nearest point of its boundary counts. A `smooth`
    field, and one on a folded grid, is made of the nodes as `scattered_field` does. A point is in a valid grid up to a
    tenth of the cell beside it: two grids of one domain cut its curves at different nodes.

    Args:
        grid: the grid of the samples.
        values: (ni, nj), one per node, or (ni-1, nj-1), one per cell.
        smooth: whether slopes must be continuous.
        outside: refuse nodes outside the samples (`error`), or take the `nearest` sample.

    Raises:
        GridgenError: for values of another shape, or that are not finite.
    """
    check_grid(grid)
    check_choice(outside)
    value, (ni, nj) = real_array(values, "the values of samples"), grid.shape
    given = value.shape
    if given == (ni - 1, nj - 1):
        value = nodal(value)
    if value.shape != (ni, nj):
        raise GridgenError(
            f"values on a grid must be one per node, shape {(ni, nj)}, or one per cell, shape {(ni - 1, nj - 1)}; "
            f"came {value.shape}"
        )
    _check_finite(value[..., np.newaxis], "node")
    kind = f"on a grid of {ni} x {nj} nodes"
    cells = StructuredInterpolation(grid) if quality(grid).valid else None
    if cells is not None and not smooth:

        def weights(x: Array, y: Array, along: str) -> Any:  # noqa: ANN401
            return cell_weights(*cells.located(x, y), (ni, nj))

        made = SampledField(kind, outside, None, partial(cells.values, value), cells.covers, _weights=weights)
    else:
        made = _triangulated(grid.xy.reshape(-1, 2), value.ravel(), kind, outside, smooth=smooth)
        made = made if cells is None else replace(made, _covers=cells.covers)
    return replace(made, shape=given, _weights=made._weights if given == (ni, nj) else _of_cells(made, (ni, nj)))


def raster_field(
    x: npt.ArrayLike,
    y: npt.ArrayLike,
    values: npt.ArrayLike,
    *,
    smooth: bool = False,
    outside: Outside = "error",
) -> SampledField:
    """Interpolate a rectilinear raster, such as an elevation model.

    Samples may be missing (NaN), as on land: where the nearest sample is, a point is outside of the samples.

    Bilinear (SciPy's `RegularGridInterpolator`), or `smooth`: the bicubic spline `RectBivariateSpline`, whose
    derivatives are exact.

    Args:
        x: (nx,), strictly increasing or strictly decreasing.
        y: (ny,), the same.
        values: (nx, ny): the first axis is x. Images are often stored vice versa: pass their transpose.
        smooth: whether first and second derivatives must be continuous.
        outside: refuse nodes outside the samples (`error`), or take the `nearest` value of the raster's edge.

    Raises:
        GridgenError: for other shapes, coordinates that are not in order, or samples that are infinite or all NaN.
    """
    check_choice(outside)
    axes = [real_array(axis, f"the raster's {name}") for axis, name in ((x, "x"), (y, "y"))]
    value = real_array(values, "the raster's values")
    fewest = _FEWEST_SMOOTH if smooth else 2
    for axis, name in zip(axes, "xy", strict=True):
        steps = np.diff(axis) if axis.ndim == 1 else np.zeros(1)
        if axis.ndim != 1 or len(axis) < fewest or not (np.all(steps > 0) or np.all(steps < 0)):
            raise GridgenError(f"the raster's {name} must be at least {fewest} coordinates in order, shape (n,)")
    if value.shape != (len(axes[0]), len(axes[1])):
        other = " Pass the transpose of the values." if value.shape == (len(axes[1]), len(axes[0])) else ""
        raise GridgenError(
            f"the raster's values must have the shape (nx, ny) = {(len(axes[0]), len(axes[1]))}; came {value.shape}."
            f"{other}"
        )
    value, gaps = filled(value)
    _check_finite(value[..., np.newaxis], "sample")
    turned = tuple(k for k in range(2) if axes[k][0] > axes[k][-1])
    for k in turned:
        axes[k] = axes[k][::-1]
    made = (_spline if smooth else _bilinear)(axes, np.flip(value, turned), outside)
    if gaps is None:
        return replace(made, middle=_middle(axes[0]), turned=turned)
    gaps = np.flip(gaps, turned)
    gap, inside = gap_at(axes, gaps), _inside(axes)
    return replace(
        made,
        middle=_middle(axes[0]),
        _missing=lambda x, y: inside(x, y) & gap(x, y),
        _covers=lambda x, y: inside(x, y) & ~gap(x, y),
        _weights=None,
    )


def negative(field: SampledField) -> SampledField:
    """Return a sampled field with the other sign: depths from heights."""

    def derivative(x: Array, y: Array, dx: int, dy: int) -> Array:
        assert field._derivative
        return -field._derivative(x, y, dx, dy)

    def weights(x: Array, y: Array, along: str) -> Any:  # noqa: ANN401
        return -1.0 * field._operator(x, y, along)

    own = derivative if field._derivative else None
    return replace(field, _value=lambda x, y: -field(x, y), _derivative=own, _weights=field._weights and weights)


def nodal(cells: Array) -> Array:
    """Return values per cell, (ni-1, nj-1), as values per node, (ni, nj): the mean over the cells around each node."""
    padded = np.pad(cells, 1, mode="edge")
    mean: Array = (padded[1:, 1:] + padded[:-1, 1:] + padded[1:, :-1] + padded[:-1, :-1]) / 4
    return mean


def _check_finite(samples: Array, what: str) -> None:
    bad = ~np.isfinite(samples).all(axis=-1)
    if bad.any():
        first = np.argwhere(bad)[0]
        where = int(first[0]) if len(first) == 1 else tuple(int(k) for k in first)
        raise GridgenError(
            f"samples must be finite: {what} {where} is not, the first of {int(bad.sum())}: leave such samples out, "
            "or fill them"
        )


def _of_cells(made: SampledField, shape: tuple[int, int]) -> Callable[[Array, Array, str], Any] | None:
    """Return the weights of cells, given those of nodes (ni, nj)."""
    weights = made._weights
    return None if weights is None else lambda x, y, along: weights(x, y, along) @ nodal_weights(shape)


def _triangulated(points: Array, values: Array, kind: str, outside: Outside, *, smooth: bool) -> SampledField:
    from scipy.interpolate import CloughTocher2DInterpolator, LinearNDInterpolator
    from scipy.spatial import ConvexHull, Delaunay, QhullError, cKDTree

    try:
        triangles = interruptible(partial(Delaunay, points))
    except QhullError as error:
        raise GridgenError("samples must not all lie on one line: give points that span the plane") from error
    inside = interruptible(partial(CloughTocher2DInterpolator if smooth else LinearNDInterpolator, triangles, values))
    tree: Any = cKDTree(points)
    middle, extent = points.mean(axis=0), float(np.ptp(points, axis=0).max())

    def value(x: Array, y: Array) -> Array:
        found: Array = inside(x, y)
        lost = np.isnan(found)
        if lost.any():  # A point on an edge of the hull may be outside by rounding.
            moved = [one[lost] + ROUNDING * (to - one[lost]) for one, to in zip((x, y), middle, strict=True)]
            found[lost] = inside(*moved)
            lost = np.isnan(found)
        if lost.any():
            found[lost] = values[tree.query(np.stack((x[lost], y[lost]), axis=-1))[1]]
        return found

    def covers(x: Array, y: Array) -> npt.NDArray[np.bool_]:
        within = np.asarray(triangles.find_simplex(np.stack((x, y), axis=-1)) >= 0)
        if not within.all():
            farthest = np.full(x.shape, -np.inf)
            for a, b, c in ConvexHull(points).equations:
                np.maximum(farthest, a * x + b * y + c, out=farthest)
            within |= farthest <= ROUNDING * extent
        return within

    def weights(x: Array, y: Array, along: str) -> Any:  # noqa: ANN401
        place = np.stack((x.ravel(), y.ravel()), axis=-1)
        for to in (middle, points[tree.query(place)[1]]):  # As above, but the nearest sample is a corner of a triangle.
            lost = triangles.find_simplex(place) < 0
            place = np.where(lost[:, None], place + (ROUNDING if to is middle else 1.0) * (to - place), place)
        return triangle_weights(triangles, triangles.find_simplex(place), place)

    made = SampledField(kind, outside, None, value, covers, middle=_middle(points[:, 0]), shape=values.shape)
    return made if smooth else replace(made, _weights=weights)


def _clipped(axes: list[Array]) -> Callable[[Array, Array], tuple[Array, Array]]:
    """Return what moves points outside a raster to the nearest point of its edge."""
    return lambda x, y: (np.clip(x, axes[0][0], axes[0][-1]), np.clip(y, axes[1][0], axes[1][-1]))


def _inside(axes: list[Array]) -> Callable[[Array, Array], npt.NDArray[np.bool_]]:
    slack = ROUNDING * max(float(np.ptp(axis)) for axis in axes)
    (left, right), (low, high) = ((axis[0] - slack, axis[-1] + slack) for axis in axes)
    return lambda x, y: (x >= left) & (x <= right) & (y >= low) & (y <= high)


def _middle(x: Array) -> float:
    return float(x.min() + x.max()) / 2


def _raster_kind(axes: list[Array]) -> str:
    return f"on a raster of {len(axes[0])} x {len(axes[1])} points"


def _bilinear(axes: list[Array], values: Array, outside: Outside) -> SampledField:
    from scipy.interpolate import RegularGridInterpolator

    interpolator, clip = RegularGridInterpolator(axes, values), _clipped(axes)
    return SampledField(
        _raster_kind(axes),
        outside,
        None,
        lambda x, y: interpolator(np.stack(clip(x, y), axis=-1)),
        _inside(axes),
        _weights=lambda x, y, along: bilinear_weights(axes, *clip(x, y)),
        shape=values.shape,
    )


def _spline(axes: list[Array], values: Array, outside: Outside) -> SampledField:
    from scipy.interpolate import RectBivariateSpline

    spline, clip, inside = RectBivariateSpline(*axes, values), _clipped(axes), _inside(axes)

    def derivative(x: Array, y: Array, dx: int, dy: int) -> Array:
        slope: Array = spline.ev(*clip(x, y), dx=dx, dy=dy)
        # Beyond an edge the field is constant across it.
        for k, (position, order) in enumerate(((x, dx), (y, dy))):
            if order:
                slope = np.where((position < axes[k][0]) | (position > axes[k][-1]), 0.0, slope)
        return slope

    def weights(x: Array, y: Array, along: str) -> Any:  # noqa: ANN401
        return spline_weights(axes, *clip(x, y), (along.count("x"), along.count("y")))

    value = partial(_at_clipped, spline.ev, clip)
    return SampledField(_raster_kind(axes), outside, derivative, value, inside, _weights=weights, shape=values.shape)


def _at_clipped(function: Callable[..., Array], clip: Callable[..., tuple[Array, Array]], x: Array, y: Array) -> Array:
    return function(*clip(x, y))
