"""Where inner nodes can be: for each a convex polygon that holds it in every valid grid with the same boundary nodes.

In a valid grid no inner node is as far in any direction as some boundary node. For the edges from an inner node to its
four neighbors follow each other counter-clockwise, each less than 180 degrees after the one before: they do not all
lie in one half-plane. So every inner node lies in the convex hull of the boundary nodes, whether these cross or not.

From there the polygons are contracted. At every corner of a cell J = turn(p, q, r) > 0 for three nodes. A node q of
which no place of the other two, in their polygons, makes J positive cannot be where it is; and J is affine in each of
the nodes, so that corners of the polygons decide. What is cut off is never possible. If nothing is left for a node,
there is no valid grid: this is a proof, for all signs are those of whole numbers.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from itertools import combinations

from .grid import Grid
from .lattice import Lattice, Polygon, convex_hull, doubled_area, possible_part
from .neck import Node

#: The place of a node: its polygon, and a bit for every cell whose corners it follows from.
Place = tuple[Polygon, int]
Places = dict[Node, Place]

#: A node is told to its neighbors when its polygon has become smaller by this factor.
_SMALLER = 0.99


class OutOfWork(Exception):  # noqa: N818 - no error
    """As many corners have been looked at as were allowed."""


class Network:
    """Some cells of a grid, and what their corners say of the places of its inner nodes.

    Attributes:
        cells: each by its first node (i, j).
        lattice: the whole numbers that stand for coordinates.
        hull: the convex hull of the boundary nodes.
        free: the inner nodes of these cells.
        start: the places that they have without looking at any corner; of a boundary node, where it is.
        work: how many corners may still be looked at.
    """

    def __init__(self, grid: Grid, cells: Iterable[Node], work: int) -> None:
        """Take the cells, each by its first node, of a grid whose inner nodes do not matter."""
        self.cells, self.work = sorted(cells), work
        ni, nj = grid.shape
        index = [(i, j) for i in range(ni) for j in range(nj) if i in (0, ni - 1) or j in (0, nj - 1)]
        ring = grid.planes[:, [i for i, _ in index], [j for _, j in index]].T
        self.lattice = Lattice(ring)
        points = self.lattice.points(ring)
        self.hull, fixed = convex_hull(points), dict(zip(index, points, strict=True))
        nodes = sorted({node for cell in self.cells for node in _nodes_of(cell)})
        self.free = [node for node in nodes if node not in fixed]
        self.start: Places = {node: ((fixed[node],) if node in fixed else self.hull, 0) for node in nodes}
        # What turn(node, a, c) > 0 says of a free node, as (node, a, c, cell); and the numbers of those using a node.
        self._corners: list[tuple[Node, Node, Node, int]] = []
        self._with: dict[Node, list[int]] = {node: [] for node in nodes}
        for number, cell in enumerate(self.cells):
            for triangle in combinations(_nodes_of(cell), 3):
                for k in range(3):
                    node, a, c = triangle[k], triangle[(k + 1) % 3], triangle[(k + 2) % 3]
                    if node not in fixed:
                        self._with[a].append(len(self._corners))
                        self._with[c].append(len(self._corners))
                        self._corners.append((node, a, c, 1 << number))

    def contract(self, places: Places, changed: Node | None = None) -> int | None:
        """Contract places, in place, until corners say no more.

        Args:
            places: of every node.
            changed: the node that may say something new to the others; None for all.

        Returns:
            None, or the cells, as bits, of which not all can be valid: the proof that some node has no place.

        Raises:
            OutOfWork: if too many corners had to be looked at; `places` hold what is known.
        """
        told: dict[Node, int] = {}
        waiting = deque(range(len(self._corners)) if changed is None else self._with[changed])
        queued = set(waiting)
        while waiting:
            number = waiting.popleft()
            queued.discard(number)
            if self.work <= 0:
                raise OutOfWork
            self.work -= 1
            node, a, c, cell = self._corners[number]
            region, why = places[node]
            part = possible_part(region, places[a][0], places[c][0])
            if part is None:
                continue
            why |= places[a][1] | places[c][1] | cell
            if len(part) < 3:
                return why
            before, area = doubled_area(region), doubled_area(part)
            if area >= before:
                continue
            places[node] = (part, why)
            if area < _SMALLER * told.setdefault(node, before):
                told[node] = area
                fresh = [other for other in self._with[node] if other not in queued]
                queued.update(fresh)
                waiting.extend(fresh)
        return None

    def named(self, why: int) -> tuple[Node, ...]:
        """Return the cells that bits stand for."""
        return tuple(cell for number, cell in enumerate(self.cells) if why >> number & 1)


def _nodes_of(cell: Node) -> tuple[Node, Node, Node, Node]:
    """Return the nodes of a cell counter-clockwise."""
    i, j = cell
    return (i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)
