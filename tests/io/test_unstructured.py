"""Grids as one list of nodes, cells and named boundary edges: what SU2, Gmsh, OpenFOAM and MFEM are given."""

from __future__ import annotations

import re

import numpy as np
import pytest
from support_files import LAYOUTS, SWAN, cascade, sector, turned

import gridgen_sym as gg
from gridgen_sym.io.boundary_kinds import Kind, kind_of
from gridgen_sym.io.format import Blocks
from gridgen_sym.io.unstructured import mesh_of

FORMATS = {".su2": "su2", ".msh": "gmsh", ".mesh": "mfem", ".polyMesh": "openfoam"}


each_layout = pytest.mark.parametrize("name", LAYOUTS)


def content(made):
    if isinstance(made, gg.Grid):
        return Blocks((made,))
    return Blocks(made.blocks, made.names, made.bonds, made.boundaries)


def area(points, cells):
    a, b, c, d = (points[cells[:, k]] for k in range(4))
    one, other = c - a, d - b
    return (one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]) / 2


def boundary_edges(cells):
    """The directed edges that belong to one cell alone, its node on the left."""
    directed = {(a, b) for cell in cells.tolist() for a, b in zip(cell, cell[1:] + cell[:1], strict=True)}
    return {(a, b) for a, b in directed if (b, a) not in directed}


@each_layout
def test_nodes_cells_and_edges(name):
    made = LAYOUTS[name]()
    mesh = mesh_of(content(made))
    blocks = (made,) if isinstance(made, gg.Grid) else made.blocks
    assert len(mesh.cells) == sum((ni - 1) * (nj - 1) for ni, nj in (grid.shape for grid in blocks)) == mesh.starts[-1]
    whole = sum(abs(area(grid.xy.reshape(-1, 2), one_block(grid)).sum()) for grid in blocks)
    assert area(mesh.points, mesh.cells).min() > 0
    assert area(mesh.points, mesh.cells).sum() == pytest.approx(whole, rel=1e-12)
    edges = [tuple(edge) for patch in mesh.patches for edge in patch.edges.tolist()]
    assert sorted(edges) == sorted(boundary_edges(mesh.cells))  # Each of them once, and the grid on its left.
    assert sorted({*mesh.cells.ravel().tolist()}) == list(range(len(mesh.points)))
    if name not in ("cascade", "sector") and isinstance(made, gg.MultiBlock):
        assert len(mesh.points) == made.node_count


def one_block(grid):
    numbers = np.arange(grid.x.size).reshape(grid.shape)
    corners = numbers[:-1, :-1], numbers[1:, :-1], numbers[1:, 1:], numbers[:-1, 1:]
    return np.stack([corner.ravel() for corner in corners], axis=1)


def test_names_of_boundaries():
    mesh = mesh_of(content(turned()))
    count = {patch.name: len(patch.edges) for patch in mesh.patches}
    assert count == {"wall": 8, "far": 8, "top_a": 4, "right_b": 4, "left_b": 4}
    left = next(patch for patch in mesh_of(content(SWAN)).patches if patch.name == "left")
    assert np.array_equal(mesh_of(content(SWAN)).points[left.edges[:, 0]], SWAN.xy[0, 1:])
    taken = gg.MultiBlock([SWAN], [], boundaries={"left": [(0, "left", (0, 1))]})
    assert [patch.name for patch in mesh_of(content(taken)).patches] == ["left", "bottom", "right", "top", "left_rest"]
    twice = gg.MultiBlock([SWAN], [], boundaries={"x": [(0, "left", (0, 2))], "y": [(0, "left", (1, 3))]})
    with pytest.raises(gg.GridgenError, match=r"nodes 1 to 3 have two names, the second of which is 'y'"):
        mesh_of(content(twice))


def test_periodic_parts_are_pairs_of_patches_edge_by_edge():
    for made, move in ((cascade(), lambda p: p - (0, 1)), (sector(), None)):
        mesh = mesh_of(content(made))
        pairs = {patch.name: patch for patch in mesh.patches if patch.partner}
        assert [*pairs][:2] == ["periodic_1", "periodic_1_shadow"]
        for patch in pairs.values():
            assert pairs[patch.partner].partner == patch.name
            if not patch.shadow:
                one, other = (mesh.points[each.edges] for each in (patch, pairs[patch.partner]))
                motion = move or patch.bond.motion.apply
                assert motion(one.reshape(-1, 2)) == pytest.approx(other[:, ::-1].reshape(-1, 2), abs=1e-12)


@pytest.mark.parametrize(
    ("name", "kind"),
    [("viscous_solid", Kind.WALL), ("Wall 1", Kind.WALL), ("far field", Kind.FARFIELD), ("x", Kind.GENERAL),
     ("symmetry_y_strong", Kind.SYMMETRY), ("Inlet", Kind.INFLOW), ("back_pressure", Kind.OUTFLOW)],
)  # fmt: skip
def test_the_kind_of_a_boundary_is_in_its_name(name, kind):
    assert kind_of(name) is kind


@pytest.mark.parametrize("suffix", FORMATS)
@pytest.mark.parametrize("name", ["a\nb", "", "\ud800"])
def test_names_that_a_format_cannot_hold(tmp_path, suffix, name):
    layout = gg.MultiBlock([SWAN], [], boundaries={name: [(0, "left")]})
    with pytest.raises(gg.GridgenError, match="cannot hold the boundary name"):
        layout.write(tmp_path / f"grid{suffix}")
    assert not list(tmp_path.iterdir())


def read_su2(text):
    """Nodes, cells and markers, by the description of the format alone."""
    words = iter(text.split())
    found = {}

    def number(key):
        assert next(words) == key + "="
        return int(next(words))

    assert number("NDIME") == 2
    cells = []
    for k in range(number("NELEM")):
        kind, *corners, own = (int(next(words)) for _ in range(6))
        assert (kind, own) == (9, k)
        cells.append(corners)
    points = [[float(next(words)), float(next(words))] for _ in range(number("NPOIN"))]
    for _ in range(number("NMARK")):
        assert next(words) == "MARKER_TAG="
        name = next(words)
        edges = [[int(next(words)) for _ in range(3)] for _ in range(number("MARKER_ELEMS"))]
        assert all(kind == 3 for kind, *_ in edges)
        found[name] = [edge[1:] for edge in edges]
    assert next(words, None) is None
    return np.array(points), np.array(cells), found


@each_layout
def test_a_mesh_of_su2(tmp_path, name):
    made = LAYOUTS[name]()
    gg.write(made, tmp_path / "grid.su2")
    mesh = mesh_of(content(made))
    points, cells, markers = read_su2((tmp_path / "grid.su2").read_text())
    assert np.array_equal(points, mesh.points)
    assert np.array_equal(cells, mesh.cells)
    assert markers == {patch.name: patch.edges.tolist() for patch in mesh.patches}
    with pytest.raises(gg.GridgenError, match="a SU2 mesh is only written; use one of"):
        gg.read(tmp_path / "grid.su2")


@each_layout
def test_a_mesh_of_mfem(tmp_path, name):
    """Our own reader, in which each quadrilateral becomes a block, finds corners and boundaries."""
    made = LAYOUTS[name]()
    gg.write(made, tmp_path / "grid.mesh")
    mesh = mesh_of(content(made))
    text = (tmp_path / "grid.mesh").read_text()
    found = gg.read_layout(tmp_path / "grid.mesh", refine=2)
    corners = np.stack([[block.xy[0, 0], block.xy[-1, 0], block.xy[-1, -1], block.xy[0, -1]] for block in found.blocks])
    assert np.array_equal(corners, mesh.points[mesh.cells])
    assert [len(parts) for parts in found.boundaries.values()] == [len(patch.edges) for patch in mesh.patches]
    sets = re.search(r"\nbdr_attribute_sets\n(\d+)\n((?:\".*\n)*)\nvertices\n", text)
    lines = [f'"{patch.name}" 1 {number}' for number, patch in enumerate(mesh.patches, start=1)]
    assert (int(sets[1]), sets[2].splitlines()) == (len(lines), lines)
    assert text.endswith("\nmfem_mesh_end\n")


def foam(path):
    """The numbers of a list of OpenFOAM, line by line."""
    text = path.read_text()
    count, body = re.search(r"\n\n(\d+)\n\(\n(.*)\n\)\n$", text, re.DOTALL).groups()
    rows = [re.sub(r"^4\(|[()]", " ", line).split() for line in body.split("\n")]
    assert len(rows) == int(count)
    return np.array(rows, dtype=float)


def patches_of(path):
    """The entries of the patches in a file `boundary`."""
    body = path.read_text().partition("\n(\n")[2]
    found = re.findall(r"^    (\S+)\n    \{\n(.*?)\n    \}$", body, re.DOTALL | re.MULTILINE)
    return {name: dict(re.findall(r"^        (\w+) +(.*);$", entries, re.MULTILINE)) for name, entries in found}


@each_layout
def test_the_folder_of_openfoam(tmp_path, name):
    """By the rules of the format: closed cells, order of faces, patches one after the other."""
    made = LAYOUTS[name]()
    folder = tmp_path / "constant" / "polyMesh"
    folder.parent.mkdir()
    for _ in range(2):  # Over the first.
        gg.write(made, folder)
    assert [p.name for p in folder.parent.iterdir()] == ["polyMesh"]
    assert sorted(p.name for p in folder.iterdir()) == ["boundary", "faces", "neighbour", "owner", "points"]
    points, faces = foam(folder / "points"), foam(folder / "faces").astype(int)
    owner, neighbor = (foam(folder / file).astype(int).ravel() for file in ("owner", "neighbour"))
    mesh, inner = mesh_of(content(made)), len(neighbor)
    a, b, c, d = (points[faces[:, k]] for k in range(4))
    normals, centers = np.cross(c - a, d - b) / 2, (a + b + c + d) / 4
    closed, volume = np.zeros((len(mesh.cells), 3)), np.zeros(len(mesh.cells))
    for cells, sign in ((owner, 1), (neighbor, -1)):
        np.add.at(closed, cells, sign * normals[: len(cells)])
        np.add.at(volume, cells, sign * (normals * centers).sum(axis=1)[: len(cells)] / 3)
    assert np.abs(closed).max() < 1e-14
    thickness = points[:, 2].max()
    assert volume == pytest.approx(area(mesh.points, mesh.cells) * thickness, rel=1e-9)
    assert (owner[:inner] < neighbor).all()
    order = np.lexsort((neighbor, owner[:inner]))
    assert np.array_equal(order, np.arange(inner))
    patches = patches_of(folder / "boundary")
    assert [*patches] == [*(patch.name for patch in mesh.patches), "frontAndBack"]
    start = inner
    for patch in patches.values():
        assert int(patch["startFace"]) == start
        start += int(patch["nFaces"])
    assert start == len(faces)
    assert patches["frontAndBack"]["type"] == "empty"
    assert {patch["type"] for name, patch in patches.items() if name.startswith("periodic")} <= {"cyclic"}
    assert all(patch["type"] == "wall" for name, patch in patches.items() if "wall" in name)
    if name == "cascade":
        for one, patch in patches.items():
            if patch["type"] == "cyclic":
                here, there = (slice(int(p["startFace"]), int(p["startFace"]) + int(p["nFaces"])) for p in
                               (patch, patches[patch["neighbourPatch"]]))  # fmt: skip
                separation = np.array(patch["separationVector"].strip("()").split(), dtype=float)
                assert centers[here] + separation == pytest.approx(centers[there])
                assert points[faces[here, 0]] + separation == pytest.approx(points[faces[there, 0]]), one


def test_other_files_in_the_folder_of_openfoam_are_kept(tmp_path):
    gg.write(SWAN, tmp_path / "polyMesh")
    (tmp_path / "polyMesh" / "cellZones").write_text("mine")
    with pytest.raises(gg.GridgenError, match="it also holds 'cellZones'"):
        gg.write(SWAN, tmp_path / "polyMesh")
    (tmp_path / "case.polyMesh").write_text("a file")
    with pytest.raises(gg.GridgenError, match="a file has this name"):
        gg.write(SWAN, tmp_path / "case.polyMesh")
    with pytest.raises(gg.GridgenError, match="cannot hold the boundary name 'far field'"):
        gg.write(gg.MultiBlock([SWAN], [], boundaries={"far field": [(0, "left")]}), tmp_path / "other.polyMesh")


@pytest.mark.extras
@each_layout
def test_gmsh_reads_what_is_written(tmp_path, name):
    import gmsh

    made = LAYOUTS[name]()
    gg.write(made, tmp_path / "grid.msh")
    mesh = mesh_of(content(made))
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(tmp_path / "grid.msh"))
        tags, flat, _ = gmsh.model.mesh.getNodes()
        points = np.empty((len(tags), 3))
        points[tags.astype(int) - 1] = flat.reshape(-1, 3)
        assert np.array_equal(points[:, :2], mesh.points)
        groups = {gmsh.model.getPhysicalName(*group): group for group in gmsh.model.getPhysicalGroups()}
        assert [*groups] == [*(patch.name for patch in mesh.patches), *mesh.names]
        for patch in mesh.patches:
            (curve,) = gmsh.model.getEntitiesForPhysicalGroup(*groups[patch.name])
            ((kind,), _, (nodes,)) = gmsh.model.mesh.getElements(1, curve)
            assert kind == 1
            assert np.array_equal(nodes.reshape(-1, 2) - 1, patch.edges)
        for block, begin, end in zip(mesh.names, mesh.starts[:-1], mesh.starts[1:], strict=True):
            (surface,) = gmsh.model.getEntitiesForPhysicalGroup(*groups[block])
            ((kind,), _, (nodes,)) = gmsh.model.mesh.getElements(2, surface)
            assert kind == 3
            assert np.array_equal(nodes.reshape(-1, 4) - 1, mesh.cells[begin:end])
    finally:
        gmsh.finalize()


@pytest.mark.extras
@each_layout
def test_vtk_reads_the_folder_of_openfoam(tmp_path, name):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOGeometry import vtkOpenFOAMReader

    made = LAYOUTS[name]()
    (tmp_path / "constant").mkdir()
    (tmp_path / "system").mkdir()
    (tmp_path / "system" / "controlDict").write_text(
        "FoamFile\n{\n version 2.0;\n format ascii;\n class dictionary;\n object controlDict;\n}\n"
        "application x;\nstartTime 0;\nendTime 1;\ndeltaT 1;\nwriteControl timeStep;\nwriteInterval 1;\n"
    )
    (tmp_path / "case.foam").write_text("")
    gg.write(made, tmp_path / "constant" / "polyMesh")
    mesh = mesh_of(content(made))
    reader = vtkOpenFOAMReader()
    reader.SetFileName(str(tmp_path / "case.foam"))
    reader.UpdateInformation()
    reader.EnableAllPatchArrays()
    reader.Update()
    output = reader.GetOutput()
    inner = output.GetBlock(0)
    assert inner.GetNumberOfCells() == len(mesh.cells)
    points = vtk_to_numpy(inner.GetPoints().GetData())
    assert points[: len(mesh.points), :2] == pytest.approx(mesh.points, rel=1e-6, abs=1e-6)
    found = {}
    for k in range(output.GetNumberOfBlocks()):
        block = output.GetBlock(k)
        if hasattr(block, "GetNumberOfBlocks"):
            for n in range(block.GetNumberOfBlocks()):
                found[block.GetMetaData(n).Get(block.NAME())] = block.GetBlock(n).GetNumberOfCells()
    expected = {patch.name: len(patch.edges) for patch in mesh.patches}
    assert {key: count for key, count in found.items() if key != "frontAndBack"} == expected


@pytest.mark.parametrize("suffix", [".mesh", ".msh"])
def test_meshes_of_quadrilaterals_are_read_as_layouts(tmp_path, suffix):
    """Each quadrilateral is a block; boundaries keep their names."""
    made = turned()
    gg.write(made, tmp_path / f"grid{suffix}")
    found = gg.read_layout(tmp_path / f"grid{suffix}", refine=2)
    mesh = mesh_of(content(made))
    assert len(found) == len(mesh.cells)
    assert {name: len(parts) for name, parts in found.boundaries.items()} == {
        patch.name: len(patch.edges) for patch in mesh.patches
    }
    with pytest.raises(gg.GridgenError, match=r"it describes a layout, which gridgen_sym\.read_layout reads"):
        gg.read(tmp_path / f"grid{suffix}")
