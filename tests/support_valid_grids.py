"""Random valid grids with whole-number coordinates, up to nearly folded ones: what no proof may exclude."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

import gridgen_sym as gg


def cell_nodes(i, j):
    """The nodes of a cell counter-clockwise."""
    return (i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)


def corners_of(shape):
    """The three nodes of the Jacobian at each corner of each cell, by cell."""
    cells = [(i, j) for i in range(shape[0] - 1) for j in range(shape[1] - 1)]
    return {
        cell: [(nodes[k - 1], nodes[k], nodes[(k + 1) % 4]) for k in range(4)]
        for cell in cells
        for nodes in [cell_nodes(*cell)]
    }


def jacobian(p, q, r):
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])


class ExactGrid:
    """A valid grid of whole numbers.

    Attributes:
        shape: the numbers of nodes (ni, nj).
        nodes: (x, y) of each node (i, j).
        corners: as `corners_of`.
    """

    def __init__(self, shape, nodes):
        self.shape, self.nodes, self.corners = shape, nodes, corners_of(shape)

    def jacobians(self, cell):
        """The four corner Jacobians of a cell, exact."""
        return [jacobian(*(self.nodes[node] for node in corner)) for corner in self.corners[cell]]

    @property
    def valid(self):
        return all(value > 0 for cell in self.corners for value in self.jacobians(cell))

    @property
    def doubled_area(self):
        """Twice the area inside the boundary."""
        return sum(values[0] + values[2] for values in map(self.jacobians, self.corners))

    def grid(self, scale=1.0):
        """The grid in floating-point numbers, without an error."""
        xy = np.array([[self.nodes[i, j] for j in range(self.shape[1])] for i in range(self.shape[0])], dtype=float)
        return gg.Grid(scale * xy)

    def move(self, node, step, part):
        """Move a node by a part of how far it can go in a direction; not where rounding would fold a cell."""
        largest, around = Fraction(1), []
        for corners in self.corners.values():
            around += [corner for corner in corners if node in corner]
        before = self.nodes[node]
        after = before[0] + step[0], before[1] + step[1]
        for corner in around:
            value = jacobian(*(self.nodes[n] for n in corner))
            slope = jacobian(*(after if n == node else self.nodes[n] for n in corner)) - value
            if slope < 0:
                largest = min(largest, Fraction(value, -slope))
        self.nodes[node] = tuple(round(x + part * largest * dx) for x, dx in zip(before, step, strict=True))
        if any(jacobian(*(self.nodes[n] for n in corner)) <= 0 for corner in around):
            self.nodes[node] = before


def start_of(random, shape, size):
    """A square, a ring or a spiral that overlaps itself, rounded to whole numbers."""
    s, t = np.meshgrid(np.linspace(0, 1, shape[0]), np.linspace(0, 1, shape[1]), indexing="ij")
    around = random.choice([0.0, 0.0, 0.6, 1.7, 2.3]) * np.pi
    x, y = (s, t) if around == 0 else ((1 + 2 * t) * np.cos(-around * s), (1 + 2 * t) * np.sin(-around * s))
    found = {
        (i, j): (round(size * float(x[i, j])), round(size * float(y[i, j])))
        for i in range(shape[0])
        for j in range(shape[1])
    }
    return ExactGrid(shape, found)


def random_valid_grid(seed, most=(6, 5), moves=120):
    """A valid grid of whole numbers whose nodes, of the boundary, too, were moved at random, often as far as they go.

    Some are of few units, so that many of their nodes stand on one line and many Jacobians are 1.
    """
    random = np.random.default_rng(seed)
    shape = int(random.integers(3, most[0] + 1)), int(random.integers(3, most[1] + 1))
    size = int(random.choice([20, 2**10, 2**40]))
    exact = start_of(random, shape, size)
    if not exact.valid:
        exact = ExactGrid(shape, {(i, j): (4 * i, 4 * j) for i in range(shape[0]) for j in range(shape[1])})
        size = 4 * max(shape)
    parts = [Fraction(1, 2), Fraction(9, 10), Fraction(999, 1000), 1 - Fraction(1, 2**20)]
    nodes = list(exact.nodes)
    for _ in range(int(random.integers(0, moves))):
        step = tuple(int(value) for value in np.rint(size * random.normal(size=2)))
        exact.move(nodes[random.integers(len(nodes))], step, parts[random.integers(len(parts))])
    assert exact.valid
    return exact


def scrambled(grid, seed):
    """The same boundary with inner nodes that fold nearly every cell, so that none is taken as a hint."""
    xy = grid.xy
    inner = xy[1:-1, 1:-1].reshape(-1, 2)
    xy[1:-1, 1:-1] = np.random.default_rng(seed).permutation(inner).reshape(xy[1:-1, 1:-1].shape)
    xy[1, 1] = xy[0, 0]
    return gg.Grid(xy)


def bent_grid(seed, most=(9, 8), moves=150, most_of_the_way=6):
    """A valid grid whose nodes, of the boundary, too, were moved at random by up to 0.6 of how far they can go."""
    random = np.random.default_rng(seed)
    shape = int(random.integers(3, most[0] + 1)), int(random.integers(3, most[1] + 1))
    size = 2**20
    exact = start_of(random, shape, size)
    if not exact.valid:
        exact = ExactGrid(shape, {(i, j): (size * i, size * j) for i in range(shape[0]) for j in range(shape[1])})
    nodes = list(exact.nodes)
    for _ in range(int(random.integers(0, moves))):
        step = tuple(int(value) for value in np.rint(size * random.normal(size=2)))
        exact.move(nodes[random.integers(len(nodes))], step, Fraction(int(random.integers(1, most_of_the_way + 1)), 10))
    return exact.grid(2.0**-20)


def of_its_boundary(grid):
    """The transfinite interpolation of a grid's boundary."""
    xy = grid.xy
    return gg.transfinite(xy[:, 0], xy[:, -1], xy[0], xy[-1])
