"""Contract the places of inner nodes, by what the cells of a grid say of each other's nodes.

In a valid grid no inner node is as far in any direction as some boundary node. For the edges from an inner node to its
four neighbors follow each other counter-clockwise, each less than 180 degrees after the one before: they do not all
lie in one half-plane. So every inner node lies in the convex hull of the boundary nodes, whether these cross or not.
Where the boundary does not meet itself, the cells of a valid grid lie side by side in its inside (the map is one to
one on the boundary, and nowhere turned over, so it is one to one): there every inner node is, and the segment between
two nodes of a cell does not lead through what lies outside.

From there the places are contracted. If nothing is left for a node, there is no valid grid: this is a proof, for all
signs are those of whole numbers. The same rules, with a part of what is expected of each Jacobian instead of zero,
prove that every grid has a sliver.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from fractions import Fraction
from itertools import permutations

from ..boundary.polygon import first_crossing
from ..grids.grid import Grid, boundary_indices
from .cuts import common_part
from .expected_jacobians import expected_jacobians
from .lattice import Lattice, Point, Polygon, convex_hull, doubled_area, simpler
from .neck import Node
from .pieces import inside_pieces, outside_pieces
from .places import Place, Places, Rule, box_of, overlap

#: A node is told to its neighbors when its place has become smaller by this factor, in per cent.
_SMALLER = 90
#: Of what is outside, that counts for a cell which has a corner at a boundary node so many cells from it.
_NEAR = 9
#: The inside of a boundary is cut into pieces if it has no more nodes: the time for that grows with their square.
_MOST_NODES = 400
#: A place is divided if that gives no more parts: work grows with their square.
_MOST_PARTS = 16


class OutOfWork(Exception):  # noqa: N818 - no error
    """As many rules have been used as were allowed."""


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

    def __init__(
        self,
        grid: Grid,
        cells: Iterable[Node],
        work: int,
        *,
        share: float = 0.0,
        sight: bool = True,
        check: Callable[[], object] | None = None,
    ) -> None:
        """Take the rules of the cells, each by its first node, of a grid whose inner nodes do not matter.

        Args:
            grid: has the boundary.
            cells: those whose corners count.
            work: how many rules may be used.
            share: corner Jacobians exceed this part of what is expected of them; 0 says that they are positive.
            sight: whether nodes of a cell must see each other, too.
            check: called again and again; what it raises ends the work.
        """
        self.cells, self.work, self._check = sorted(cells), work, check
        index = boundary_indices(*grid.shape)
        ring = grid.planes[:, index[:, 0], index[:, 1]].T
        self.lattice = Lattice(ring)
        points = self.lattice.points(ring)
        fixed = dict(zip(map(tuple, index.tolist()), points, strict=True))
        self.hull = simpler(convex_hull(points))
        nodes = sorted({node for cell in self.cells for node in nodes_of(cell)})
        self.free = [node for node in nodes if node not in fixed]
        whole = Place.of((self.hull,), 0)
        self.start: Places = {node: Place.of(((fixed[node],),), 0) if node in fixed else whole for node in nodes}
        least = self._least_jacobians(grid, share, points)
        self._rules = [rule for rule in self._corner_rules(least) if rule.node not in fixed]
        self._corners = len(self._rules)
        self._inside: list[Polygon] = []
        if sight and first_crossing(ring) is None:
            self._inside = inside_pieces(points) if len(points) <= _MOST_NODES else []
            seen = {rule[:2]: rule for rule in self._sight_rules(fixed) if rule.node not in fixed and rule.obstacles}
            self._rules += seen.values()
        self._with: dict[Node, list[int]] = {node: [] for node in nodes}
        for number, rule in enumerate(self._rules):
            for node in rule.others:
                self._with[node].append(number)

    def _least_jacobians(self, grid: Grid, share: float, ring: list[Point]) -> list[list[int]]:
        """Return what the Jacobians at the corners of each cell must exceed, rounded down."""
        parts, inside = share * expected_jacobians(grid), Fraction(max(doubled_area(tuple(ring)), 0), 2)
        return [[int(Fraction(part) * inside) for part in parts[:, i, j]] for i, j in self.cells]

    def _corner_rules(self, least: list[list[int]]) -> Iterator[Rule]:
        """Return what the corners of the cells say."""
        for number, cell in enumerate(self.cells):
            nodes = nodes_of(cell)
            for k in range(4):
                corner = nodes[k - 1], nodes[k], nodes[(k + 1) % 4]
                for m in range(3):
                    yield Rule(corner[m], (corner[m - 2], corner[m - 1]), (), 1 << number, least[number][k])

    def _sight_rules(self, fixed: dict[Node, Point]) -> Iterator[Rule]:
        """Return what it says that nodes of a cell see each other, past what is outside near them."""
        at = {point: node for node, point in fixed.items()}
        pieces = [(piece, box_of(piece), [at[point] for point in piece]) for piece in outside_pieces(list(at))]
        for number, (i, j) in enumerate(self.cells):
            near = tuple(
                (piece, box)
                for piece, box, nodes in pieces
                if any(max(abs(p - i), abs(q - j)) <= _NEAR for p, q in nodes)
            )
            for node, other in permutations(nodes_of((i, j)), 2):
                yield Rule(node, (other,), near, 1 << number)

    def divide(self, places: Places) -> int | None:
        """Leave, in place, of each place only what is inside the boundary, as soon as that has few parts, and contract.

        Returns:
            As `contract`.

        Raises:
            OutOfWork: as `contract`.
        """
        whole = set(self.free) if self._inside else set()
        while whole:
            before = len(whole)
            for node in sorted(whole):
                parts = self._inside_parts(places[node])
                if not parts:
                    return places[node].cells
                if len(parts) <= _MOST_PARTS:
                    places[node] = Place.of(parts, places[node].cells)
                    whole.remove(node)
            if len(whole) == before:
                break
            if (why := self.contract(places)) is not None:
                return why
        return None

    def _inside_parts(self, place: Place) -> tuple[Polygon, ...]:
        """Return what of a place is inside the boundary."""
        near = [piece for piece in self._inside if overlap(place.box, box_of(piece))]
        self._use(len(near))
        parts = (common_part(place.hull, piece) for piece in near)
        return tuple(part for part in parts if len(part) > 2)

    def _use(self, work: int) -> None:
        """Count work that is to be done."""
        if self._check is not None:
            self._check()
        self.work -= work
        if self.work < 0:
            raise OutOfWork

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
                if number not in queued:
                    queued.add(number)
                    (corners if number < self._corners else sights).append(number)

        wait(range(len(self._rules)) if changed is None else self._with[changed])
        while corners or sights:
            number = (corners or sights).popleft()
            queued.discard(number)
            rule = self._rules[number]
            parts, work = rule.left(places)
            self._use(work)
            if parts is None:
                continue
            if not parts:
                return rule.reasons(places)
            before, place = places[rule.node], Place.of(parts, rule.reasons(places))
            if place.area >= before.area:
                continue
            places[rule.node] = place
            if 100 * place.area < _SMALLER * told.setdefault(rule.node, before.area):
                told[rule.node] = place.area
                wait(self._with[rule.node])
        return None

    def named(self, why: int) -> tuple[Node, ...]:
        """Return the cells that bits stand for."""
        return tuple(cell for number, cell in enumerate(self.cells) if why >> number & 1)


def nodes_of(cell: Node) -> tuple[Node, Node, Node, Node]:
    """Return the nodes of a cell counter-clockwise."""
    i, j = cell
    return (i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)
