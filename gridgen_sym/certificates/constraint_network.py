"""Constraint propagation: the feasible regions of inner nodes are clipped by the constraints of the cells.

Every inner node of a valid grid lies in the convex hull of the boundary nodes, whether the boundary crosses itself or
not: the edges from an inner node to its four neighbors follow each other counter-clockwise, each by less than 180
degrees, so they do not all point into one half-plane, and no inner node is an extreme point.

If the boundary does not meet itself, the cells of a valid grid fill its inside, side by side: the piecewise map is
one-to-one on the boundary and nowhere reverses orientation, so it is one-to-one. Then every inner node is inside, and
the segment between two nodes of a cell does not lead through what is outside.

From there the regions are clipped. If nothing is left for a node, no valid grid exists. This is a proof: all signs are
those of integers. With a positive bound for the Jacobians the same constraints prove that every valid grid has a
sliver.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Container, Iterable, Iterator
from fractions import Fraction
from itertools import permutations

import numpy as np

from ..boundary.polygon import first_crossing
from ..grids.grid import Grid, boundary_indices
from .clipping import intersection
from .convex_decomposition import decompose_inside, decompose_outside
from .expected_jacobians import expected_jacobians
from .feasible_region import Box, Constraint, FeasibleRegion, Regions, bounding_box, overlap
from .integer_polygons import IntegerCoordinates, Point, Polygon, convex_hull, doubled_area, enclosing_polygon
from .node_constraints import Node

#: A node's constraints on its neighbors are applied again when its area has fallen to so many per cent.
_SMALLER = 90
#: Obstacles with a corner at a boundary node at most so many cells away count for a cell.
_NEAR = 9
#: Largest number of boundary nodes for which the inside is decomposed: the time for that grows with its square.
_MOST_NODES = 400
#: Largest number of parts of a region: the cost of its constraints grows with its square.
_MOST_PARTS = 16


class BudgetExceeded(Exception):  # noqa: N818 - no error
    """The budget of constraints is used up."""


class ConstraintNetwork:
    """Some cells of a grid, and the constraints that they put on the inner nodes.

    Attributes:
        cells: each by its first node (i, j).
        coordinates: the map from coordinates to integers.
        hull: a convex polygon that contains the boundary nodes.
        free: the inner nodes of these cells.
        start: the feasible regions before any constraint is applied; the point itself for a boundary node.
        budget: how many constraints may still be applied.
        jacobian_fraction: the fraction of the expected Jacobians that the Jacobians exceed.
    """

    def __init__(
        self,
        grid: Grid,
        cells: Iterable[Node],
        budget: int,
        *,
        jacobian_fraction: float = 0.0,
        visibility: bool = True,
        check: Callable[[], object] | None = None,
    ) -> None:
        """Collect the constraints of some cells.

        Args:
            grid: has the boundary nodes; its inner nodes do not matter.
            cells: the cells whose constraints are used, each by its first node.
            budget: how many constraints may be applied; a large obstacle counts as several.
            jacobian_fraction: the Jacobians exceed this fraction of `expected_jacobians`; 0: they are positive.
            visibility: whether nodes of a cell must also see each other.
            check: called often; what it raises ends the work.
        """
        self.cells, self.budget, self._check = sorted(cells), budget, check or _no_check
        self.jacobian_fraction = jacobian_fraction
        index = boundary_indices(*grid.shape)
        ring = grid.planes[:, index[:, 0], index[:, 1]].T
        self.coordinates = IntegerCoordinates(ring)
        points = self.coordinates.to_integers(ring)
        fixed = dict(zip(map(tuple, index.tolist()), points, strict=True))
        self.hull = enclosing_polygon(convex_hull(points))
        self._check()
        nodes = sorted({node for cell in self.cells for node in nodes_of(cell)})
        self._check()
        self.free = [node for node in nodes if node not in fixed]
        whole = FeasibleRegion.of((self.hull,), 0)
        self.start: Regions = {
            node: FeasibleRegion.of(((fixed[node],),), 0) if node in fixed else whole for node in nodes
        }
        self._constraints: list[Constraint] = []
        self._of_neighbors: dict[Node, list[int]] = {node: [] for node in nodes}
        self._add(self._corner_constraints(grid, points), fixed)
        self._corners = len(self._constraints)
        self._inside: list[tuple[Polygon, Box]] = []
        if visibility and first_crossing(ring, self._check) is None:
            if len(points) <= _MOST_NODES:
                self._inside = [(piece, bounding_box(piece)) for piece in decompose_inside(points, self._check)]
            self._add(self._visibility_constraints(fixed), fixed)

    def _add(self, constraints: Iterable[Constraint], fixed: Container[Node]) -> None:
        """Add constraints on inner nodes; not more than the budget, since these would never be applied."""
        for constraint in constraints:
            if len(self._constraints) >= self.budget:
                return
            if constraint.node not in fixed:
                for node in constraint.others:
                    self._of_neighbors[node].append(len(self._constraints))
                self._constraints.append(constraint)

    def _corner_constraints(self, grid: Grid, ring: list[Point]) -> Iterator[Constraint]:
        """Yield the constraints of the Jacobians at the corners of the cells."""
        bounds, area = self.jacobian_fraction * expected_jacobians(grid), Fraction(max(doubled_area(ring), 0), 2)
        for number, (i, j) in enumerate(self.cells):
            self._check()
            nodes = nodes_of((i, j))
            for k in range(4):
                least = int(Fraction(bounds[k, i, j]) * area)  # Rounded down: it must be exceeded.
                corner = nodes[k - 1], nodes[k], nodes[(k + 1) % 4]
                for m in range(3):
                    yield Constraint(corner[m], (corner[m - 2], corner[m - 1]), (), 1 << number, least)

    def _visibility_constraints(self, fixed: dict[Node, Point]) -> Iterator[Constraint]:
        """Yield the constraints that nodes of a cell see each other past the obstacles near them."""
        at = {point: node for node, point in fixed.items()}
        obstacles = [(piece, bounding_box(piece)) for piece in decompose_outside(list(at), self._check)]
        corners = np.array([at[point] for piece, _ in obstacles for point in piece]).reshape(-1, 2)
        owner = np.repeat(np.arange(len(obstacles)), [len(piece) for piece, _ in obstacles])
        seen: set[tuple[Node, Node]] = set()
        for number, cell in enumerate(self.cells):
            self._check()
            close = np.abs(corners - cell).max(axis=1, initial=0) <= _NEAR
            near = tuple(obstacles[k] for k in np.unique(owner[close]))
            for pair in permutations(nodes_of(cell), 2):
                if near and pair not in seen:
                    seen.add(pair)
                    yield Constraint(pair[0], pair[1:], near, 1 << number)

    def clip_to_inside(self, regions: Regions) -> int | None:
        """Clip the regions to the inside of the boundary, in place, where this gives few parts, and propagate.

        Returns:
            As `propagate`.

        Raises:
            BudgetExceeded: as `propagate`.
        """
        whole = set(self.free) if self._inside else set()
        while whole:
            before = len(whole)
            for node in sorted(whole):
                parts = self._parts_inside(regions[node])
                if not parts:
                    return regions[node].reasons
                if len(parts) <= _MOST_PARTS:
                    regions[node] = FeasibleRegion.of(parts, regions[node].reasons)
                    whole.remove(node)
            if len(whole) == before:
                break
            if (why := self.propagate(regions)) is not None:
                return why
        return None

    def _parts_inside(self, region: FeasibleRegion) -> tuple[Polygon, ...]:
        """Return the parts of a region that are inside the boundary."""
        near = [piece for piece, box in self._inside if overlap(region.box, box)]
        self._use(len(near))
        parts = (intersection(region.hull, piece) for piece in near)
        return tuple(part for part in parts if len(part) > 2)

    def _use(self, cost: int) -> None:
        """Take a cost from the budget."""
        self._check()
        self.budget -= cost
        if self.budget < 0:
            raise BudgetExceeded

    def propagate(self, regions: Regions, changed: Node | None = None) -> int | None:
        """Apply constraints to regions, in place, until none clips any more.

        Args:
            regions: of every node.
            changed: the node whose region has changed; None to apply all constraints.

        Returns:
            None, or cells, as bits, that cannot all meet their constraints: nothing is left of the region of a node.

        Raises:
            BudgetExceeded: `regions` are valid then, if not as small as they could be.
        """
        applied: dict[Node, int] = {}  # The area of a region when its neighbors were last asked to look at it.
        corners: deque[int] = deque()
        visibility: deque[int] = deque()  # Slower, and often without effect: last.
        queued: set[int] = set()

        def enqueue(numbers: Iterable[int]) -> None:
            for number in numbers:
                if number not in queued:
                    queued.add(number)
                    (corners if number < self._corners else visibility).append(number)

        enqueue(range(len(self._constraints)) if changed is None else self._of_neighbors[changed])
        while corners or visibility:
            number = (corners or visibility).popleft()
            queued.discard(number)
            constraint = self._constraints[number]
            parts, cost = constraint.clip(regions, self._check)
            self._use(cost)
            if parts is None:
                continue
            if not parts:
                return constraint.reasons(regions)
            before, region = regions[constraint.node], FeasibleRegion.of(parts, constraint.reasons(regions))
            if region.area >= before.area:
                continue
            regions[constraint.node] = region
            if 100 * region.area < _SMALLER * applied.setdefault(constraint.node, before.area):
                applied[constraint.node] = region.area
                enqueue(self._of_neighbors[constraint.node])
        return None

    def cells_of(self, bits: int) -> tuple[Node, ...]:
        """Return the cells that bits stand for."""
        return tuple(cell for number, cell in enumerate(self.cells) if bits >> number & 1)


def nodes_of(cell: Node) -> tuple[Node, Node, Node, Node]:
    """Return the nodes of a cell counter-clockwise."""
    i, j = cell
    return (i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)


def _no_check() -> None:
    """Let the work go on."""
