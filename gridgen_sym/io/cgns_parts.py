"""Boundaries and connections in CGNS: ranges of nodes of a zone, and parts of the sides of a block."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..boundary.sides import Sides
from ..errors import GridgenError
from ..messages import report
from ..topology.connection import Motion, SidePart
from ..topology.copies import Bond
from .boundary_kinds import Kind, kind_of
from .cgns_tree import add, children, content, integers, name_of, text, words_of
from .format import Blocks

#: What a boundary is whose name says nothing of it.
_UNNAMED_KIND = "BCTypeUserDefined"
#: Those of an angle: mass, length, time and temperature have none.
_UNITS = ("Null", "Null", "Null", "Null", "Degree")


@dataclass(frozen=True, slots=True)
class Zone:
    """How a block lies in its zone.

    Attributes:
        number: of the block.
        name: of the zone.
        sizes: how many nodes it has along each index.
        axes: the indices that are xi and eta.
    """

    number: int
    name: str
    sizes: tuple[int, ...]
    axes: tuple[int, int]

    @property
    def shape(self) -> tuple[int, int]:
        """The numbers of nodes along xi and eta."""
        return self.sizes[self.axes[0]], self.sizes[self.axes[1]]

    def part(self, node: Any, extra: int = 0) -> tuple[SidePart, bool] | None:  # noqa: ANN401 - h5py's groups
        """Return the part of a side that a range of nodes is, and whether it runs backwards.

        Args:
            node: the range, counted from 1.
            extra: what is to be added to its end, for ranges of edges.

        Returns:
            None for the plane itself, which a layer of cells has twice.

        Raises:
            GridgenError: for what is no part of a side in the whole depth of the zone.
        """
        ends = content(node)
        what = f"the range {name_of(node)} of {name_of(node.parent)} in the zone {self.name}"
        if ends.shape != (2, len(self.sizes)) or ends.dtype.kind not in "iu":
            raise GridgenError(f"{what} has the shape {ends.shape[::-1]}; expected ({len(self.sizes)}, 2)")
        (first, last), limits = ends.astype(np.int64).tolist(), self.sizes
        if not all(1 <= n <= size for row in (first, last) for n, size in zip(row, limits, strict=True)):
            raise GridgenError(f"{what}, {first} to {last}, leaves its {' x '.join(map(str, limits))} nodes")
        across = [axis for axis in range(len(limits)) if axis not in self.axes]
        if any(sorted((first[axis], last[axis])) != [1, limits[axis]] for axis in across):
            if all(first[axis] == last[axis] for axis in across):
                return None
            raise GridgenError(f"{what}, {first} to {last}, is not as deep as the zone")
        for normal, along in ((0, 1), (1, 0)):
            at, (a, b) = self.axes[normal], (first[self.axes[along]], last[self.axes[along]])
            if first[at] == last[at] and first[at] in (1, limits[at]) and a != b:
                side = (("left", "right"), ("bottom", "top"))[normal][first[at] > 1]
                low, high = sorted((a, b))
                if high + extra <= limits[self.axes[along]]:
                    return SidePart(self.number, side, low - 1, high - 1 + extra), a > b
        raise GridgenError(f"{what}, {first} to {last}, is no part of a side")


def families(blocks: Blocks) -> list[str]:
    """Return the names of boundaries that are families: zones and families are side by side in the tree."""
    zones = {name for name, _ in blocks.described}
    return [name for name in blocks.boundaries if name not in zones]


def add_boundaries(zone: Any, blocks: Blocks, block: int) -> None:  # noqa: ANN401
    """Add the named boundaries of a block to its zone: those of a grid alone are its sides."""
    boundaries = blocks.boundaries
    if blocks.bonds is None and not boundaries:
        boundaries = {side: (whole_side(block, side, blocks.grids[block].shape),) for side in Sides._fields}
    parts = [(name, part) for name, given in boundaries.items() for part in given]
    own = [(number, name, part) for number, (name, part) in enumerate(parts, start=1) if part.block == block]
    if not own:
        return
    group = add(zone, "ZoneBC", "ZoneBC_t")
    with_family, used = set(families(blocks)), set[str]()
    for number, name, part in own:
        title = name if name not in used else f"{name[:24]} {number}"
        used.add(title)
        kind = kind_of(name)
        node = add(group, title, "BC_t", text(_UNNAMED_KIND if kind is Kind.GENERAL else kind.value))
        add(node, "PointRange", "IndexRange_t", _range(part, blocks.grids[block].shape))
        if name in with_family or not blocks.boundaries:
            add(node, "FamilyName", "FamilyName_t", text(name))
        add(node, "Ordinal", "Ordinal_t", integers(number))


def whole_side(block: int, side: str, shape: tuple[int, int]) -> SidePart:
    """Return a side as a part."""
    return SidePart(block, side, 0, shape[0 if side in ("bottom", "top") else 1] - 1)


def _range(part: SidePart, shape: tuple[int, int], *, backwards: bool = False) -> NDArray[np.int32]:
    """Return the first and the last node of a part, counted from 1; (2, 2)."""
    i, j = (index[[-1, 0] if backwards else [0, -1]] + 1 for index in part.indices(shape))
    return np.stack((i, j), axis=1).astype(np.int32)


def add_connections(zone: Any, blocks: Blocks, block: int) -> None:  # noqa: ANN401
    """Add the connections of a block to its zone; every connection stands in both zones."""
    if blocks.bonds is None:
        return
    group = add(zone, "ZoneGridConnectivity", "ZoneGridConnectivity_t")
    for number, bond in enumerate(blocks.bonds, start=1):
        for one, other, motion, title in (
            (bond.one, bond.other, bond.motion, f"Connection {number}"),
            (bond.other, bond.one, _inverse(bond.motion), f"Connection {number} donor"),
        ):
            if one.block == block:
                donor = blocks.described[other.block][0]
                node = add(group, title, "GridConnectivity1to1_t", text(donor))
                shapes = [blocks.grids[part.block].shape for part in (one, other)]
                add(node, "PointRange", "IndexRange_t", _range(one, shapes[0]))
                add(node, "PointRangeDonor", "IndexRange_t", _range(other, shapes[1], backwards=bond.reversed))
                add(node, "Transform", '"int[IndexDimension]"', integers(*_transform(one, other, bond.reversed)))
                add(node, "Ordinal", "Ordinal_t", integers(2 * number + (title[-1] == "r")))
                _add_motion(node, motion)


def _transform(one: SidePart, other: SidePart, backwards: bool) -> tuple[int, int]:
    """Return which index of the donor grows with i and with j of a zone, with a sign where it falls."""
    found = [0, 0]
    found[one.axis] = (1 + other.axis) * (-1 if backwards else 1)
    # Out of the zone leads into the donor.
    ends = [part.side in ("right", "top") for part in (one, other)]
    found[1 - one.axis] = (2 - other.axis) * (1 if ends[0] != ends[1] else -1)
    return found[0], found[1]


def _add_motion(node: Any, motion: Motion) -> None:  # noqa: ANN401
    if motion == Motion():
        return
    group = add(add(node, "GridConnectivityProperty", "GridConnectivityProperty_t"), "Periodic", "Periodic_t")
    add(group, "RotationCenter", "DataArray_t", np.zeros(2))
    # In the plane there is one angle, and the standard asks for as many numbers as there are coordinates.
    angle = add(group, "RotationAngle", "DataArray_t", np.array([motion.angle, 0.0]))
    units = np.stack([text(unit.ljust(32)) for unit in _UNITS])
    add(angle, "DimensionalUnits", "DimensionalUnits_t", units)
    add(group, "Translation", "DataArray_t", np.array(motion.shift))


def _inverse(motion: Motion) -> Motion:
    if motion == Motion():
        return motion
    x, y = (-Motion(-motion.angle).apply(np.array([motion.shift]))[0]).tolist()
    return Motion(-motion.angle, (x, y))


def boundaries_in(group: Any, zone: Zone) -> list[tuple[int, str, SidePart]]:  # noqa: ANN401
    """Return the named boundaries of a zone, with the ordinal of each; what is no range of nodes is reported."""
    found = []
    for zone_bc in children(group, "ZoneBC_t"):
        for node in children(zone_bc, "BC_t"):
            families = children(node, "FamilyName_t")
            name = words_of(families[0]) if families else name_of(node)
            if "PointRange" not in node:
                report(f"the boundary {name!r} of the zone {zone.name} is no range of nodes: it is left out")
                continue
            places = [words_of(place) for place in children(node, "GridLocation_t")]
            part = zone.part(node["PointRange"], extra=int(any(place.endswith("Center") for place in places)))
            ordinal = int(content(node["Ordinal"]).ravel()[0]) if "Ordinal" in node else 0
            if part is not None:
                found.append((ordinal, name, part[0]))
    return found


def connections_in(group: Any, zone: Zone, zones: Sequence[Zone]) -> list[tuple[int, Bond]] | None:  # noqa: ANN401
    """Return the connections of a zone, with the ordinal of each; None where it does not say."""
    groups = children(group, "ZoneGridConnectivity_t")
    if not groups:
        return None
    found = []
    for node in (node for one in groups for node in children(one, "GridConnectivity1to1_t")):
        donor = words_of(node).rpartition("/")[2]
        other_zone = next((other for other in zones if other.name == donor), None)
        if other_zone is None:
            raise GridgenError(f"the connection {name_of(node)} of the zone {zone.name} leads to no zone {donor!r}")
        one, other = zone.part(node["PointRange"]), other_zone.part(node["PointRangeDonor"])
        if one is None or other is None:
            continue
        bond = Bond(one[0], other[0], _motion_in(node))
        if bond.one.count != bond.other.count or bond.reversed is not (one[1] != other[1]):
            raise GridgenError(
                f"the ranges of the connection {name_of(node)} of the zone {zone.name} do not fit: expected as many "
                f"nodes in both, and {'opposite directions' if bond.reversed else 'the same direction'}"
            )
        ordinal = int(content(node["Ordinal"]).ravel()[0]) if "Ordinal" in node else 0
        found.append((ordinal, bond))
    return found


def _motion_in(node: Any) -> Motion:  # noqa: ANN401
    """Return the motion of a periodic connection, which takes its range to that of the donor."""
    for group in children(node, "GridConnectivityProperty_t"):
        for periodic in children(group, "Periodic_t"):
            center, angles, shift = (content(periodic[name]).ravel().astype(float) for name in _PERIODIC)
            angle = float(angles[np.argmax(np.abs(angles))])
            units = [words_of(unit) for unit in children(periodic["RotationAngle"], "DimensionalUnits_t")]
            if angle and not any("Degree" in unit for unit in units):
                angle = float(np.degrees(angle))
            moved = center[:2] - Motion(angle).apply(center[None, :2])[0] + shift[:2]
            return Motion(angle, (float(moved[0]), float(moved[1])))
    return Motion()


_PERIODIC = ("RotationCenter", "RotationAngle", "Translation")


def joined(bonds: Sequence[tuple[int, Bond]]) -> tuple[Bond, ...]:
    """Return connections once each: a file has them in both zones."""
    found: dict[tuple[SidePart, SidePart], Bond] = {}
    for _, bond in sorted(bonds, key=lambda pair: pair[0]):
        if (bond.other, bond.one) not in found:
            found.setdefault((bond.one, bond.other), bond)
    return tuple(found.values())
