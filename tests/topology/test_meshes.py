"""Meshes of quadrilaterals as layouts: straight and curved ones, MFEM's own, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from layouts import valences
from support import NO_SHARED, SHARED

import gridgen_sym as gg
from gridgen_sym.layouts.lagrange import interpolation, lobatto_points

HEAD = """MFEM mesh v1.0

# a comment

dimension
2

elements
2
1 3 3 2 0 5
1 3 2 1 4 0

boundary
3
7 1 3 2
7 1 2 1
8 1 5 3

vertices
6
"""
#: The vertices of two squares side by side: numbers do not follow the places.
PLACES = np.array([[1, 1], [2, 0], [1, 0], [0, 0], [2, 1], [0, 1]], dtype=float)
STRAIGHT = HEAD + "2\n" + "\n".join(f"{x} {y}" for x, y in PLACES) + "\n"
#: Edges as the elements name them.
EDGES = ((3, 2), (2, 0), (0, 5), (5, 3), (2, 1), (1, 4), (4, 0))


def bent(places):
    x, y = places.T
    return np.stack((x + 0.2 * y**2, y + 0.1 * x**3), axis=-1)


def curved(order, ordering=0):
    """The mesh with the nodes of a map that is cubic."""
    at = lobatto_points(order)[1:-1]
    parts = [PLACES]
    for one, other in EDGES:
        low, high = PLACES[min(one, other)], PLACES[max(one, other)]
        parts.append(low + at[:, None] * (high - low))
    for x0 in (0, 1):
        parts.append(np.stack([(x0 + x, y) for y in at for x in at]) if order > 1 else np.empty((0, 2)))
    nodes = bent(np.concatenate(parts))
    values = nodes.T.ravel() if ordering == 0 else nodes.ravel()
    head = f"\nnodes\nFiniteElementSpace\nFiniteElementCollection: H1_2D_P{order}\nVDim: 2\nOrdering: {ordering}\n\n"
    return HEAD + head + "\n".join(map(repr, values.tolist())) + "\n"


def read(tmp_path, text, **given):
    path = tmp_path / "two.mesh"
    path.write_text(text, encoding="ascii")
    return gg.read_layout(path, **given)


def test_quadrilaterals_become_blocks(tmp_path):
    layout = read(tmp_path, STRAIGHT, refine=4)
    assert [grid.shape for grid in layout.blocks] == [(5, 5), (5, 5)]
    assert len(layout.bonds) == 1
    assert {name: len(parts) for name, parts in layout.boundaries.items()} == {"7": 2, "8": 1}
    along = np.linspace(0, 1, 5)
    for grid, x in zip(layout.blocks, (0, 1), strict=True):
        assert grid.xy == pytest.approx(np.stack(np.meshgrid(x + along, along, indexing="ij"), axis=-1))
    assert read(tmp_path, STRAIGHT).blocks[0].shape == (5, 5)


def test_sets_of_attributes_name_boundaries(tmp_path):
    """Ours are read with their names, and a set may hold several attributes."""
    named = STRAIGHT.replace("vertices", 'bdr_attribute_sets\n1\n"wall" 2 7 8\n\nvertices')
    assert {name: len(parts) for name, parts in read(tmp_path, named).boundaries.items()} == {"wall": 3}
    gg.layout("tee", across=4, height=1.0, branch=1.0).write(tmp_path / "tee.mesh")
    assert set(gg.read_layout(tmp_path / "tee.mesh", refine=2).boundaries) == {"inlet", "outlet", "branch", "wall"}


@pytest.mark.parametrize(("order", "ordering"), [(3, 0), (4, 0), (5, 1)])
def test_nodes_lie_on_the_curved_map(tmp_path, order, ordering):
    layout = read(tmp_path, curved(order, ordering), refine=7)
    along = np.linspace(0, 1, 8)
    for grid, x in zip(layout.blocks, (0, 1), strict=True):
        exact = bent(np.stack(np.meshgrid(x + along, along, indexing="ij"), axis=-1).reshape(-1, 2))
        assert grid.xy.reshape(-1, 2) == pytest.approx(exact, abs=1e-13)


def test_lobatto_points_are_those_of_the_tables():
    assert lobatto_points(1) == pytest.approx([0, 1])
    assert lobatto_points(2) == pytest.approx([0, 0.5, 1])
    assert 2 * lobatto_points(4) - 1 == pytest.approx([-1, -np.sqrt(3 / 7), 0, np.sqrt(3 / 7), 1])
    points, at = lobatto_points(3), np.linspace(0, 1, 6)
    assert interpolation(points, at) @ points**3 == pytest.approx(at**3)


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (("MFEM mesh v1.0", "MFEM NURBS mesh v1.0"), "its first line must be 'MFEM mesh v1.0'"),
        (("dimension\n2", "dimension\n3"), "its dimension must be 2; came 3"),
        (("1 3 3 2 0 5", "1 2 3 2 0"), "element 0 is '1 2 3 2 0': expected the shape 3 with 4 vertices"),
        (("1 3 3 2 0 5", "1 3 3 2 0 9"), "elements name vertices up to 9, and there are 6"),
        (("elements\n2", "elements\n9"), "it announces 9 rows of elements, and has 2"),
        (("boundary\n3", "edge\n3"), "cut short, or no mesh of MFEM"),
        (("1.0 1.0\n", ""), "expected 6 finite nodes"),
        (("1.0 1.0", "1.0 nan"), "expected 6 finite nodes"),
        (("elements\n2\n", "elements\n3\n1 3 5 0 2 3\n"), "the edge between the vertices"),
    ],
)
def test_what_is_no_mesh_is_told(tmp_path, change, told):
    assert change[0] in STRAIGHT
    with pytest.raises(gg.GridgenError, match=told):
        read(tmp_path, STRAIGHT.replace(*change))


def test_other_nodes_are_told(tmp_path):
    with pytest.raises(gg.GridgenError, match="its nodes are those of 'L2_2D_P3'; expected Linear, Quadratic or H1"):
        read(tmp_path, curved(3).replace("H1_2D_P3", "L2_2D_P3"))
    with pytest.raises(gg.GridgenError, match="expected 15 finite nodes"):
        read(tmp_path, curved(3).replace("H1_2D_P3", "H1_2D_P2"))
    with pytest.raises(gg.GridgenError, match=r"refine must be a whole number, at least 2 for .mesh; came 1"):
        read(tmp_path, STRAIGHT, refine=1)


needs_meshes = pytest.mark.skipif(not (SHARED / "mfem").is_dir(), reason=NO_SHARED.format("mfem"))


@needs_meshes
@pytest.mark.slow
def test_a_curved_mesh_with_singular_nodes_is_smoothed():
    """224 curved quadrilaterals, 8 x 8 cells each, with the boundary fixed."""
    start = gg.read_layout(SHARED / "mfem" / "icf.mesh", refine=8)
    assert len(start) == 224
    assert set(np.concatenate([one.ravel() for one in valences(start)])) >= {3, 4}
    found = gg.optimize(start, "winslow")
    assert found.converged
    assert found.quality.valid
    assert found.energy < 0.6 * gg.energy(start, "winslow")


@needs_meshes
def test_an_inverted_mesh_becomes_valid():
    start = gg.read_layout(SHARED / "mfem" / "jagged.mesh", refine=2)
    assert gg.quality(start).folded_cells == 10
    found = gg.optimize(start, "winslow")
    assert found.converged
    assert found.quality.valid
    assert "was folded at the start" in found.message
