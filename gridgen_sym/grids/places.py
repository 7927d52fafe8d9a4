"""Where inner nodes can be: for each a convex polygon that holds it in every valid grid with the same boundary nodes.

In a valid grid no inner node is as far in any direction as some boundary node. For the edges from an inner node to its
four neighbors follow each other counter-clockwise, each less than 180 degrees after the one before: they do not all
lie in one half-plane. So every inner node lies in the convex hull of the boundary nodes, whether these cross or not.

From there the polygons are contracted. At every corner of a cell J = turn(p, q, r) > 0 for three nodes. A node of
which no place of the other two, in their polygons, makes J positive cannot be where it is; and J is affine in each of
the nodes, so that corners of the polygons decide. Where the boundary does not meet itself, the cells of a valid grid
lie side by side in its inside (the map is one to one on the boundary, and nowhere turned over, so it is one to one),
and the segment between two nodes of a cell does not lead through what lies outside: each must see the other.

What is cut off is never possible. If nothing is left for a node, there is no valid grid: this is a proof, for all
signs are those of whole numbers.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from itertools import combinations, permutations
from typing import NamedTuple

from .grid import Grid, boundary_indices
from .lattice import Lattice, Point, Polygon, convex_hull, doubled_area, possible_part, simpler, visible_part
from .neck import Node
from .obstacles import outside_pieces
from .polygon import first_crossing

#: Smallest and largest x, and y.
Box = tuple[int, int, int, int]


class Place(NamedTuple):
    """Where a node can be.

    Attributes:
        region: a convex polygon, or a point.
        cells: a bit for every cell by which it was contracted.
        box: of the region.
    """

    region: Polygon
    cells: int
    box: Box

    @classmethod
    def of(cls, region: Polygon, cells: int) -> Place:
        """Return the place with its box."""
        return cls(region, cells, _box(region))


Places = dict[Node, Place]

#: A node is told to its neighbors when its polygon has become smaller by this factor, in per cent.
_SMALLER = 99
#: Of what is outside, that counts for a cell which has a corner at a boundary node so many cells from it.
_NEAR = 9


class OutOfWork(Exception):  # noqa: N818 - no error
    """As many rules have been used as were allowed."""


class Rule(NamedTuple):
    """What other nodes say of the place of one.

    Attributes:
        node: the one.
        others: two of them are at a corner of a cell with it: turn(node, *others) > 0. One must be seen from it.
        obstacle: what may hide the one other node.
        cell: a bit that stands for the cell.
        box: of the obstacle.
    """

    node: Node
    others: tuple[Node, ...]
    obstacle: Polygon
    cell: int
    box: Box

    def may_say_something(self, places: Places) -> bool:
        """Return whether the obstacle is perhaps between the nodes."""
        if not self.obstacle:
            return True
        (a, b, c, d), (p, q, r, s), (x, y, z, w) = places[self.node].box, places[self.others[0]].box, self.box
        return max(b, q) > x and min(a, p) < y and max(d, s) > z and min(c, r) < w

    def part(self, places: Places) -> Polygon | None:
        """Return what is left of the node's place: None for all."""
        region, *others = (places[node].region for node in (self.node, *self.others))
        return visible_part(region, others[0], self.obstacle) if self.obstacle else possible_part(region, *others)

    def reasons(self, places: Places) -> int:
        """Return the cells, as bits, from which it follows."""
        why = self.cell
        for node in (self.node, *self.others):
            why |= places[node].cells
        return why


class Network:
    """Some cells of a grid, and the rules for the places of its inner nodes.

    Attributes:
        cells: each by its first node (i, j).
        lattice: the whole numbers that stand for coordinates.
        hull: of the boundary nodes, convex, perhaps with less corners than their convex hull.
        free: the inner nodes of these cells.
        start: the places that they have without any rule; of a boundary node, where it is.
        work: how many rules may still be used.
    """

    def __init__(self, grid: Grid, cells: Iterable[Node], work: int, *, sight: bool = True) -> None:
        """Take the rules of the cells, each by its first node, of a grid whose inner nodes do not matter.

        Args:
            grid: has the boundary.
            cells: those whose corners count.
            work: how many rules may be used.
            sight: whether nodes of a cell must see each other, too.
        """
        self.cells, self.work = sorted(cells), work
        index = boundary_indices(*grid.shape)
        ring = grid.planes[:, index[:, 0], index[:, 1]].T
        self.lattice = Lattice(ring)
        points = self.lattice.points(ring)
        fixed = dict(zip(map(tuple, index.tolist()), points, strict=True))
        self.hull = simpler(convex_hull(points))
        nodes = sorted({node for cell in self.cells for node in nodes_of(cell)})
        self.free = [node for node in nodes if node not in fixed]
        whole = Place.of(self.hull, 0)
        self.start: Places = {node: Place.of((fixed[node],), 0) if node in fixed else whole for node in nodes}
        self._rules = [rule for rule in self._corner_rules() if rule.node not in fixed]
        self._corners = len(self._rules)
        if sight and first_crossing(ring) is None:
            seen = {rule[:3]: rule for rule in self._sight_rules(fixed) if rule.node not in fixed}
            self._rules += seen.values()
        self._with: dict[Node, list[int]] = {node: [] for node in nodes}
        for number, rule in enumerate(self._rules):
            for node in rule.others:
                self._with[node].append(number)

    def _corner_rules(self) -> Iterator[Rule]:
        """Return what the corners of the cells say."""
        for number, cell in enumerate(self.cells):
            for corner in combinations(nodes_of(cell), 3):
                for k in range(3):
                    yield Rule(corner[k], (corner[k - 2], corner[k - 1]), (), 1 << number, (0, 0, 0, 0))

    def _sight_rules(self, fixed: dict[Node, Point]) -> Iterator[Rule]:
        """Return what it says that nodes of a cell see each other, past what is outside near them."""
        at = {point: node for node, point in fixed.items()}
        pieces = [(piece, _box(piece), [at[point] for point in piece]) for piece in outside_pieces(list(at))]
        for number, (i, j) in enumerate(self.cells):
            near = [
                (piece, box)
                for piece, box, nodes in pieces
                if any(max(abs(p - i), abs(q - j)) <= _NEAR for p, q in nodes)
            ]
            for node, other in permutations(nodes_of((i, j)), 2):
                yield from (Rule(node, (other,), piece, 1 << number, box) for piece, box in near)

    def contract(self, places: Places, changed: Node | None = None) -> int | None:
        """Contract places, in place, until no rule says more.

        Args:
            places: of every node.
            changed: the node that may say something new to the others; None for all.

        Returns:
            None, or the cells, as bits, of which not all can be valid: the proof that some node has no place.

        Raises:
            OutOfWork: if too many rules had to be used; `places` hold what is known.
        """
        told: dict[Node, int] = {}
        corners: deque[int] = deque()
        sights: deque[int] = deque()  # Slower, and often without news: last.
        queued: set[int] = set()

        def wait(numbers: Iterable[int]) -> None:
            for number in numbers:
                if number not in queued and self._rules[number].may_say_something(places):
                    queued.add(number)
                    (corners if number < self._corners else sights).append(number)

        wait(range(len(self._rules)) if changed is None else self._with[changed])
        while corners or sights:
            number = (corners or sights).popleft()
            queued.discard(number)
            if self.work <= 0:
                raise OutOfWork
            rule = self._rules[number]
            # What a large obstacle hides takes the longer to tell.
            self.work -= 1 + len(rule.obstacle) ** 2 // 256
            part = rule.part(places)
            if part is None:
                continue
            if len(part) < 3:
                return rule.reasons(places)
            before, area = doubled_area(places[rule.node].region), doubled_area(part)
            if area >= before:
                continue
            places[rule.node] = Place.of(part, rule.reasons(places))
            if 100 * area < _SMALLER * told.setdefault(rule.node, before):
                told[rule.node] = area
                wait(self._with[rule.node])
        return None

    def named(self, why: int) -> tuple[Node, ...]:
        """Return the cells that bits stand for."""
        return tuple(cell for number, cell in enumerate(self.cells) if why >> number & 1)


def nodes_of(cell: Node) -> tuple[Node, Node, Node, Node]:
    """Return the nodes of a cell counter-clockwise."""
    i, j = cell
    return (i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)


def _box(polygon: Polygon) -> Box:
    """Return the smallest and largest x, and y, of a polygon."""
    x, y = zip(*polygon, strict=True)
    return min(x), max(x), min(y), max(y)
