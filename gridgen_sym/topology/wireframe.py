"""Layouts from points, curves between them, and blocks between curves; what blocks share is connected."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..boundary.sides import Sides, grid_of_sides, ring_of_sides
from ..errors import GridgenError, quoted
from ..grids.grid import SMALLEST
from .connection import Connection, PartLike
from .curve_names import Curve, CurveNames
from .edge_cells import EqualSides, carried_over
from .multiblock import MultiBlock
from .rings import BlockLike, Use, rings, side_lists


@dataclass(frozen=True, slots=True)
class Periodic:
    """Two curves that are the same up to a motion, as of `Connection`: it takes the first to the second."""

    curves: tuple[str, str]
    translation: tuple[float, float] = (0.0, 0.0)
    rotation: float = 0.0
    center: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Wireframe:
    """The description of a layout.

    Between two points a curve can be called `A-B`; one that is not drawn is a straight line.

    Attributes:
        points: places by name.
        curves: what is drawn, by name.
        blocks: for each name four points, counter-clockwise, or the curves of bottom, right, top and left: each a name,
            or several that follow each other.
        cells: numbers of cells of curves; they are carried over to opposite sides.
        boundaries: parts of the outer boundary by name, each a sequence of curves.
        periodic: pairs of curves that are connected up to a motion.
    """

    points: Mapping[str, tuple[float, float]]
    curves: Mapping[str, Curve]
    blocks: Mapping[str, BlockLike]
    cells: Mapping[str, int]
    boundaries: Mapping[str, Sequence[str]]
    periodic: Sequence[Periodic] = ()

    def layout(self, refine: int = 1) -> MultiBlock:
        """Return the blocks, each filled by transfinite interpolation; curves of two blocks are connections.

        Args:
            refine: a factor for all numbers of cells.

        Raises:
            GridgenError: for names that are unknown, sides that do not join, numbers of cells that contradict each
                other or are missing, and curves of more than two blocks.
        """
        names = CurveNames(self.points, self.curves)
        listed = {block: side_lists(block, given, tuple(self.points)) for block, given in self.blocks.items()}
        found = {
            block: [[names.find(curve, f"block {block}") for curve in side] for side in sides]
            for block, sides in listed.items()
        }
        ways = {block: rings(block, sides, names.ends) for block, sides in found.items()}
        given = {curve: refine * count for curve, count in _counts(self.cells, names).items()}
        counts = carried_over(given, [*_opposite(found), *_equal(self.periodic, names)])
        nodes = {curve: names.nodes(curve, counts[curve]) for curve in names.ends if curve in counts}
        walked, grids = {}, {}
        for block, possible in ways.items():
            walked[block], lines = _counterclockwise(block, possible, nodes)
            grids[block] = grid_of_sides(lines)
        uses = _uses(walked, counts, names)
        outer = {
            name: [_only(uses, names.find(curve, f"boundary {name}"), f"boundary {name}") for curve in given]
            for name, given in self.boundaries.items()
        }
        periodic = self._periodic(uses, names)
        return MultiBlock(grids, [*self._shared(uses), *periodic], boundaries=outer)

    def _shared(self, uses: Mapping[str, Sequence[PartLike]]) -> list[Connection]:
        found = []
        for curve, parts in uses.items():
            if not parts:
                raise GridgenError(f"the curve {curve} belongs to no block: remove it, or correct a block")
            if len(parts) > 2:
                told = ", ".join(f"{part[1]} of {part[0]}" for part in parts)
                raise GridgenError(f"the curve {curve} is in {len(parts)} sides, {told}: at most two can share it")
            if len(parts) == 2:
                found.append(Connection(*parts))
        return found

    def _periodic(self, uses: Mapping[str, Sequence[PartLike]], names: CurveNames) -> list[Connection]:
        found = []
        for pair in self.periodic:
            one, other = (_only(uses, names.find(curve, "periodic"), "periodic") for curve in pair.curves)
            found.append(
                Connection(one, other, translation=pair.translation, rotation=pair.rotation, center=pair.center)
            )
        return found


def _counts(cells: Mapping[str, int], names: CurveNames) -> dict[str, int]:
    """Return what is said of numbers of cells, checked."""
    found: dict[str, int] = {}
    for name, count in cells.items():
        if not isinstance(count, int) or isinstance(count, bool) or count < 1:
            raise GridgenError(f"cells of {name} must be a whole number, at least 1; came {quoted(count)}")
        curve = names.find(name, "cells")
        if found.setdefault(curve, count) != count:
            raise GridgenError(f"cells of {curve} are said twice: {found[curve]} and {count}")
    return found


def _opposite(curves: Mapping[str, Sequence[Sequence[str]]]) -> list[EqualSides]:
    return [
        EqualSides(f"block {block}", pair, (tuple(one), tuple(other)))
        for block, (bottom, right, top, left) in curves.items()
        for pair, one, other in ((("bottom", "top"), bottom, top), (("left", "right"), left, right))
    ]


def _equal(periodic: Sequence[Periodic], names: CurveNames) -> list[EqualSides]:
    pairs = [[names.find(curve, "periodic") for curve in pair.curves] for pair in periodic]
    return [EqualSides("periodic curves", ("one", "the other"), ((one,), (other,))) for one, other in pairs]


def _joined(pieces: Sequence[Array]) -> Array:
    """Return the nodes of pieces that follow each other."""
    return np.concatenate([pieces[0], *(piece[1:] for piece in pieces[1:])])


def _counterclockwise(
    block: str, ways: Sequence[Sides[tuple[Use, ...]]], nodes: Mapping[str, Array]
) -> tuple[Sides[tuple[Use, ...]], Sides[Array]]:
    """Return the way round a block that encloses the smallest positive area, and the nodes of its sides."""
    found = []
    for way in ways:
        lines = Sides(*(_joined([nodes[use.curve][:: 1 if use.forwards else -1] for use in side]) for side in way))
        x, y = ring_of_sides(lines).T
        found.append((float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))), way, lines))
    for side, line in found[0][2]._asdict().items():
        if len(line) < SMALLEST:
            raise GridgenError(f"{side} of block {block} has 1 cell; expected at least {SMALLEST - 1} along every side")
    positive = [one for one in found if one[0] > 0]
    if not positive:
        raise GridgenError(f"block {block} runs clockwise: give its points or sides in the opposite order")
    return min(positive, key=lambda one: one[0])[1:]


def _uses(
    walked: Mapping[str, Sides[tuple[Use, ...]]], counts: Mapping[str, int], names: CurveNames
) -> dict[str, list[PartLike]]:
    """Return for each curve the parts of sides that it is."""
    uses: dict[str, list[PartLike]] = {curve: [] for curve in names.ends}
    for block, sides in walked.items():
        for side, walk in sides._asdict().items():
            first = 0
            for use in walk:
                last = first + counts[use.curve]
                uses[use.curve].append((block, side, (first, last)))
                first = last
    return uses


def _only(uses: Mapping[str, Sequence[PartLike]], curve: str, where: str) -> PartLike:
    """Return the one part of a side that a curve of the outer boundary is."""
    parts = uses.get(curve, ())
    if len(parts) != 1:
        raise GridgenError(
            f"{curve} of {where} must be a side of one block, and no connection; it is in {len(parts)} sides"
        )
    return parts[0]
