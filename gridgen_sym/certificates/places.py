"""Where an inner node can be, and what its neighbors say of that.

A place is a polygon, not always convex: convex parts that hold the node in every valid grid. What a rule cuts off is
never possible. At every corner of a cell J = turn(p, q, r) > 0 for three nodes. A node of which no place of the other
two makes J positive cannot be where it is; and J is affine in each of the nodes, so that corners of their convex hulls
decide. And where the boundary does not meet itself, a node must see each of the others of its cells.
"""

from __future__ import annotations

from typing import NamedTuple

from .cuts import possible_part, visible_part
from .lattice import Point, Polygon, convex_hull, doubled_area, simpler
from .neck import Node

#: Smallest and largest x, and y.
Box = tuple[int, int, int, int]


class Place(NamedTuple):
    """Where a node can be.

    Attributes:
        parts: convex polygons, of which one holds the node; or a point.
        cells: a bit for every cell by which it was contracted.
        hull: the convex hull of the parts.
        box: of the hull.
        area: twice the sum of the areas of the parts.
    """

    parts: tuple[Polygon, ...]
    cells: int
    hull: Polygon
    box: Box
    area: int

    @classmethod
    def of(cls, parts: tuple[Polygon, ...], cells: int) -> Place:
        """Return the place with its hull, box and area."""
        hull = parts[0] if len(parts) == 1 else convex_hull([point for part in parts for point in part])
        return cls(parts, cells, hull, box_of(hull), sum(map(doubled_area, parts)))


Places = dict[Node, Place]


class Rule(NamedTuple):
    """What other nodes say of the place of one.

    Attributes:
        node: the one.
        others: two of them are at a corner of a cell with it: turn(node, *others) > `least`. One must be seen from it.
        obstacles: what may hide the one other node, each with its box.
        cell: a bit that stands for the cell.
        least: what the Jacobian at the corner must exceed.
    """

    node: Node
    others: tuple[Node, ...]
    obstacles: tuple[tuple[Polygon, Box], ...]
    cell: int
    least: int = 0

    def left(self, places: Places) -> tuple[tuple[Polygon, ...] | None, int]:
        """Return what is left of the node's place, None for all, and how much work that was."""
        place, others = places[self.node], [places[node] for node in self.others]
        left: list[Polygon] = []
        work, same = 0, True
        for part in place.parts:
            if self.obstacles:
                rest, more = _seen(part, others[0], self.obstacles)
            else:
                rest, more = possible_part(part, others[0].hull, others[1].hull, self.least), 1
            work += more
            same = same and rest is None
            if rest is None or len(rest) > 2:
                left.append(part if rest is None else rest)
        return None if same else tuple(left), work

    def reasons(self, places: Places) -> int:
        """Return the cells, as bits, from which it follows."""
        why = self.cell
        for node in (self.node, *self.others):
            why |= places[node].cells
        return why


def _seen(region: Polygon, other: Place, obstacles: tuple[tuple[Polygon, Box], ...]) -> tuple[Polygon | None, int]:
    """Return a polygon with all q in `region` that see some point of a place, None for all, and the work."""
    found: list[Point] = []
    work = 1
    for part in other.parts:
        left, around = region, box_of(region + part)
        for obstacle, box in obstacles:
            if overlap(around, box):
                lit = visible_part(left, part, obstacle)
                # What a large obstacle hides takes the longer to tell.
                work += 1 + len(obstacle) ** 2 // 256
                left = left if lit is None else lit
                if not left:
                    break
        if left is region:
            return None, work
        found += left
    return simpler(convex_hull(found)), work


def box_of(polygon: Polygon) -> Box:
    """Return the smallest and largest x, and y, of a polygon."""
    x, y = zip(*polygon, strict=True)
    return min(x), max(x), min(y), max(y)


def overlap(one: Box, other: Box) -> bool:
    """Return whether two boxes have more than a side in common."""
    return one[1] > other[0] and one[0] < other[1] and one[3] > other[2] and one[2] < other[3]
