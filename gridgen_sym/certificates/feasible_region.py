"""Feasible regions of inner nodes, and the constraints that nodes of a cell put on each other.

A feasible region contains the node in every valid grid. It is a union of convex polygons, so it need not be convex.
A constraint clips the region of one node, given the regions of others. There are two kinds:

* A corner of a cell: J = turn(p, q, r) > 0 for its three nodes. A position of one node is infeasible if J <= 0 for all
  positions of the other two in their regions. J is affine in each node, so the corners of convex hulls decide.
* Visibility: where the boundary does not meet itself, the segment between two nodes of a cell stays inside. So a
  position is infeasible if obstacles, which lie outside the boundary, hide the whole region of the other node.

Why a region that shrinks to nothing is a proof, although some tests are strict and polygons are closed: all conditions
of a valid grid are strict. So a node of a valid grid may be moved a little in any direction, and what a constraint
leaves of a region that contains the node has a positive area.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from .clipping import clip_to_positive, clip_to_visible
from .integer_polygons import Point, Polygon, convex_hull, doubled_area, enclosing_polygon
from .node_constraints import Node

#: Smallest and largest x, smallest and largest y.
Box = tuple[int, int, int, int]


class FeasibleRegion(NamedTuple):
    """A set that contains a node in every valid grid.

    Attributes:
        parts: convex polygons, one of which contains the node; a single point for a boundary node.
        reasons: a bit for each cell whose constraints were used.
        hull: the convex hull of the parts.
        box: the bounding box of the hull.
        area: twice the sum of the areas of the parts.
    """

    parts: tuple[Polygon, ...]
    reasons: int
    hull: Polygon
    box: Box
    area: int

    @classmethod
    def of(cls, parts: tuple[Polygon, ...], reasons: int) -> FeasibleRegion:
        """Return the region of some parts, with its hull, box and area."""
        hull = parts[0] if len(parts) == 1 else convex_hull([point for part in parts for point in part])
        return cls(parts, reasons, hull, bounding_box(hull), sum(map(doubled_area, parts)))


Regions = dict[Node, FeasibleRegion]


class Constraint(NamedTuple):
    """A constraint on the region of one node, by the regions of others of the same cell.

    Attributes:
        node: the constrained node.
        others: for a corner two nodes, with turn(node, *others) > `least`; for visibility one, that the node must see.
        obstacles: for visibility, the convex polygons that may hide the other node, each with its bounding box.
        cell: the bit of the cell.
        least: the bound of the Jacobian at the corner, in integer units.
    """

    node: Node
    others: tuple[Node, ...]
    obstacles: tuple[tuple[Polygon, Box], ...]
    cell: int
    least: int = 0

    def clip(self, regions: Regions, check: Callable[[], object]) -> tuple[tuple[Polygon, ...] | None, int]:
        """Return the parts that are left of the node's region, None if nothing is clipped, and the cost of that.

        Args:
            regions: of all nodes.
            check: called often; what it raises ends the work.
        """
        region, others = regions[self.node], [regions[node] for node in self.others]
        left: list[Polygon] = []
        cost, same = 0, True
        for part in region.parts:
            check()
            if self.obstacles:
                rest, more = _clip_by_obstacles(part, others[0], self.obstacles, check)
            else:
                rest, more = clip_to_positive(part, others[0].hull, others[1].hull, self.least), 1
            cost += more
            same = same and rest is None
            if rest is None or len(rest) > 2:
                left.append(part if rest is None else rest)
        return None if same else tuple(left), cost

    def reasons(self, regions: Regions) -> int:
        """Return the cells, as bits, from which the result of `clip` follows."""
        found = self.cell
        for node in (self.node, *self.others):
            found |= regions[node].reasons
        return found


def _clip_by_obstacles(
    part: Polygon, other: FeasibleRegion, obstacles: tuple[tuple[Polygon, Box], ...], check: Callable[[], object]
) -> tuple[Polygon | None, int]:
    """Return a polygon with all points of `part` that see some point of a region, None for all, and the cost."""
    found: list[Point] = []
    cost = 1
    for target in other.parts:
        left, around = part, bounding_box(part + target)
        for obstacle, box in obstacles:
            if overlap(around, box):
                check()
                visible = clip_to_visible(left, target, obstacle)
                # The cost of a shadow grows with the number of corners of the obstacle, squared.
                cost += 1 + len(obstacle) ** 2 // 256
                left = left if visible is None else visible
                if not left:
                    break
        if left is part:
            return None, cost
        found += left
    return enclosing_polygon(convex_hull(found)), cost


def bounding_box(polygon: Polygon) -> Box:
    """Return the bounding box of a polygon."""
    x, y = zip(*polygon, strict=True)
    return min(x), max(x), min(y), max(y)


def overlap(one: Box, other: Box) -> bool:
    """Return whether two boxes have more than a side in common."""
    return one[1] > other[0] and one[0] < other[1] and one[3] > other[2] and one[2] < other[3]
