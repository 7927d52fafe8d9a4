"""From a block of PLOT3D in space to a plane grid: the plane may lie in any of its indices and coordinates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Mask
from ..errors import GridgenError
from ..grids.grid import Grid, corner_jacobians
from .checks import plane_grid

_INDICES, _COORDINATES = "ijk", "xyz"
_PLANAR = (0, 1)


@dataclass(frozen=True, slots=True)
class Plane:
    """A grid from a file, and how it lay there.

    Attributes:
        grid: its nodes.
        blanked: 1 where iblank is not 0, shape (ni, nj); None without iblank.
        across: the index that is constant: 0, 1 or 2.
        coordinates: those that are taken as x and y.
        layer: whether the file has a layer of cells of this plane.
    """

    grid: Grid
    blanked: Mask | None
    across: int
    coordinates: tuple[int, int]
    layer: bool

    @property
    def remark(self) -> str:
        """What a user must know of its orientation; empty for a plane k = 1 in x and y."""
        if self.across == 2 and self.coordinates == _PLANAR and not self.layer:
            return ""
        along = [name for axis, name in enumerate(_INDICES) if axis != self.across]
        first, second = (_COORDINATES[axis] for axis in self.coordinates)
        turn = "counter-clockwise" if corner_jacobians(self.grid.x, self.grid.y).sum() > 0 else "clockwise"
        return (
            f"the grid is the plane {_INDICES[self.across]} = 1{' of a layer of cells' * self.layer} in {first} and "
            f"{second}: xi runs along {along[0]}, eta along {along[1]}, {first} and {second} are taken as x and y, and "
            f"its cells run {turn}"
        )


def plane_of(values: Sequence[Array], sizes: tuple[int, int, int], dimension: int, *, holes: bool) -> Plane:
    """Return the plane of a block.

    Args:
        values: its coordinates, flat, i running fastest, and iblank, if there is one.
        sizes: (ni, nj, nk).
        dimension: how many of `values` are coordinates.
        holes: whether nodes that iblank blanks out are kept.

    Raises:
        GridgenError: for a volume, a surface that lies in no coordinate plane, and holes that are not to be kept.
    """
    across, layer = _constant_index(sizes)
    planes = [_cut(flat, sizes, across, 0) for flat in values]
    coordinates = _PLANAR if dimension == 2 else _varying(planes[:3])
    if layer:
        _check_layer([_cut(flat, sizes, across, 1) for flat in values[:dimension]], planes, coordinates)
    constant = next((planes[axis] for axis in range(dimension) if axis not in coordinates), None)
    grid = plane_grid(planes[coordinates[0]], planes[coordinates[1]], constant)
    blanked = _field(planes[-1], keep=holes) if len(values) > dimension else None
    return Plane(grid, blanked, across, coordinates, layer)


def _constant_index(sizes: tuple[int, int, int]) -> tuple[int, bool]:
    """Return the index across the plane, and whether two planes of nodes lie along it."""
    for depth in (1, 2):
        flat = [axis for axis in range(3) if sizes[axis] == depth]
        if len(flat) == 1:
            return flat[0], depth == 2
    shown = " x ".join(map(str, sizes))
    if sizes.count(1) > 1:
        raise GridgenError(f"the block has {shown} nodes, which is a line; expected one plane")
    raise GridgenError(
        f"the block is a volume with {sizes[2]} k planes ({shown} nodes); expected 1, or 1 of i or j: cut out one plane"
    )


def _cut(flat: Array, sizes: tuple[int, int, int], across: int, at: int) -> Array:
    """Return a plane of a block as a view (ni, nj) over its other two indices."""
    place: list[slice | int] = [slice(None)] * 3
    place[2 - across] = at
    plane: Array = flat.reshape(sizes[::-1])[tuple(place)].T
    return plane


def _is_constant(plane: Array) -> bool:
    return bool((plane == plane[0, 0]).all())


def _varying(planes: Sequence[Array]) -> tuple[int, int]:
    """Return the two coordinates of the plane that a surface lies in; x and y where it lies in none."""
    if _is_constant(planes[2]) or not np.isfinite(planes[2]).all():
        return _PLANAR
    others = [axis for axis in _PLANAR if _is_constant(planes[axis])]
    # Where all three vary, or only one does, z is what is wrong.
    return (1 - others[0], 2) if len(others) == 1 else _PLANAR


def _check_layer(second: Sequence[Array], first: Sequence[Array], coordinates: tuple[int, int]) -> None:
    """Refuse a layer of cells whose two planes of nodes differ in the plane's own coordinates."""
    for axis in range(3):
        if np.array_equal(second[axis], first[axis]) is not (axis in coordinates):
            how = "differ" if axis in coordinates else "agree"
            raise GridgenError(
                f"the block is a volume, two planes of nodes that {how} in {_COORDINATES[axis]}: cut out one plane"
            )


def _field(iblank: Array, *, keep: bool) -> Mask:
    """Return where nodes are not blanked out; refuse holes, which iblank = 0 marks, unless they are to be kept."""
    if not (iblank % 1 == 0).all():
        raise GridgenError(
            "a plane of iblank would fit its header, but its numbers are not whole: write the file again"
        )
    holes = np.argwhere(iblank == 0)
    if len(holes) and not keep:
        i, j = holes[0].tolist()
        raise GridgenError(
            f"its iblank marks {len(holes)} nodes as holes (0), the first of which is node ({i}, {j}): a grid has no "
            "holes. Cut out a block without any, or read it with the form 'holes', which keeps these nodes; "
            "gridgen_sym.read_masks(path) returns which they are"
        )
    mask: Mask = (iblank != 0).astype(np.uint8)
    return mask
