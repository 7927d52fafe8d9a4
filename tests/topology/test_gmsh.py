"""Meshes of Gmsh as layouts: both versions, text and binary, curved elements, names of boundaries, what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import gridgen_sym as gg
from gridgen_sym.cli import main
from gridgen_sym.io.gmsh_numbers import Bytes

#: Four quadratic quadrilaterals between y = 0 and 1 and from a circle to x = 2, as Gmsh 4.15 has written them.
DATA = Path(__file__).parent.parent / "io" / "data"
FILES = [f"arc_{version}_{form}.msh" for version in ("22", "41") for form in ("text", "binary")]


@pytest.mark.parametrize("name", FILES)
def test_versions_and_forms_hold_the_same(name):
    layout = gg.read_layout(DATA / name, refine=2)
    assert [grid.shape for grid in layout.blocks] == [(3, 3)] * 4
    assert len(layout.bonds) == 4
    assert {key: len(parts) for key, parts in layout.boundaries.items()} == {"outlet": 2, "the wall": 4, "9": 2}
    sides = {
        key: np.concatenate([part.nodes(layout.blocks) for part in parts]) for key, parts in layout.boundaries.items()
    }
    assert (sides["outlet"][:, 0] == 2).all()
    assert sorted(set(sides["the wall"][:, 1])) == [0, 1]
    # The inner nodes of curved edges lie on the circle, too.
    assert np.hypot(sides["9"][:, 0] + 1.2, sides["9"][:, 1] - 0.5) == pytest.approx(1.3, rel=1e-12)
    assert gg.quality(layout).valid


def test_our_own_files_are_read(tmp_path):
    """Every cell of a written layout becomes a block."""
    pipe = gg.layout("pipe", across=2, outwards=2)
    pipe.write(tmp_path / "pipe.msh")
    layout = gg.read_layout(tmp_path / "pipe.msh", refine=2)
    assert len(layout) == 20
    assert {name: len(parts) for name, parts in layout.boundaries.items()} == {"wall": 8}
    found = gg.optimize(layout, "winslow")
    assert found.converged
    assert found.quality.valid


def test_the_order_of_bytes_may_be_the_other():
    numbers = Bytes(np.array([1, 2], ">i4").tobytes() + np.array([0.5], ">f8").tobytes(), ">")
    assert numbers.integers(2).tolist() == [1, 2]
    assert numbers.reals(1).tolist() == [0.5]
    with pytest.raises(gg.GridgenError, match="fewer bytes than it announces"):
        numbers.tags(1)


def test_the_command_line_takes_meshes(tmp_path):
    out = tmp_path / "smooth.p2dfmt"
    given = ["grid", str(DATA / FILES[0]), "-f", "winslow", "--refine", "4", "-o", str(out)]
    done = CliRunner().invoke(main, given)
    assert done.exit_code == 0, done.output
    assert "4 blocks, 4 connections, 64 cells" in done.output
    assert set(gg.read(out).boundaries) == {"outlet", "the wall", "9"}


TEXT = (DATA / "arc_22_text.msh").read_text(encoding="ascii")


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (("2.2 0 8", "4.0 0 8"), "version 2.2 or 4.1: .* came '4.0 0 8'"),
        (("$MeshFormat", "$NoFormat"), "its section .NoFormat does not end"),
        ((" 10 2 ", " 9 2 "), r"elements of type 9 \(a triangle\)"),
        ((" 10 2 ", " 99 2 "), r"elements of type 99 \(another kind\)"),
        (("$EndElements", "$EndOthers"), "its section .Elements does not end"),
        (("$Nodes\n25", "$Nodes\n26"), "fewer numbers than it announces"),
        (("\n1 0 0 0\n", "\n1 0 0 1\n"), "in one plane z = constant"),
        (("\n1 0 0 0\n", "\n1 0 nan 0\n"), "must be finite"),
        (("\n1 0 0 0\n", "\n77 0 0 0\n"), "its elements name nodes that it does not have"),
        (("\n1 0 0 0\n", "\n1 zero 0 0\n"), "cut short, or no mesh of Gmsh"),
    ],
)
def test_what_is_no_mesh_of_quadrilaterals_is_told(tmp_path, change, told):
    assert change[0] in TEXT
    path = tmp_path / "other.msh"
    path.write_text(TEXT.replace(*change), encoding="ascii")
    with pytest.raises(gg.GridgenError, match=rf"cannot read the layout .*{told}"):
        gg.read_layout(path)


def test_a_mesh_of_lines_has_no_quadrilaterals(tmp_path):
    head, _, rest = TEXT.partition("$Elements")
    lines = [line for line in rest.splitlines() if " 8 2 " in line]
    path = tmp_path / "lines.msh"
    path.write_text(f"{head}$Elements\n{len(lines)}\n" + "\n".join(lines) + "\n$EndElements\n", encoding="ascii")
    with pytest.raises(gg.GridgenError, match="it has no quadrilaterals"):
        gg.read_layout(path)


@pytest.mark.extras
@pytest.mark.parametrize(("order", "below"), [(1, False), (2, True), (5, False)])
def test_what_gmsh_writes_is_read(tmp_path, order, below):
    """Nodes of all orders, unstructured quadrilaterals, two surfaces, a node on no element, files of all kinds."""
    import gmsh

    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        shape = gmsh.model.geo
        places = ((0, 0), (1, 0), (1, 1), (0, 1), (2.5, 0), (2.5, 1))
        a, b, c, d, e, f = (shape.addPoint(x, y, 0.7, 0.45) for x, y in places)
        low, between, top = shape.addLine(a, b), shape.addLine(b, c), shape.addLine(c, d)
        arc = shape.addCircleArc(d, shape.addPoint(0, 0.5, 0.7), a)
        right = [shape.addLine(b, e), shape.addLine(e, f), shape.addLine(f, c)]
        loops = [[low, between, top, arc], [*right, -between]]
        surfaces = [
            shape.addPlaneSurface([shape.addCurveLoop([-k for k in loop[::-1]] if below else loop)]) for loop in loops
        ]
        shape.synchronize()
        gmsh.model.addPhysicalGroup(1, [arc], 5, name="inlet")
        gmsh.model.addPhysicalGroup(1, [low, top, right[0], right[2]], 2, name="wall")
        gmsh.model.addPhysicalGroup(1, [between], 4, name="inside")
        gmsh.model.addPhysicalGroup(2, surfaces, 1)
        gmsh.option.setNumber("Mesh.RecombineAll", 1)
        gmsh.option.setNumber("Mesh.RecombinationAlgorithm", 2)
        gmsh.model.mesh.generate(2)
        gmsh.model.mesh.setOrder(order)
        used = np.unique(np.concatenate([gmsh.model.mesh.getElements(2, one)[2][0] for one in surfaces]))
        nodes = {tag: tuple(gmsh.model.mesh.getNode(tag)[0][:2]) for tag in used}
        for version, binary in ((2.2, 0), (2.2, 1), (4.1, 0), (4.1, 1)):
            gmsh.option.setNumber("Mesh.MshFileVersion", version)
            gmsh.option.setNumber("Mesh.Binary", binary)
            gmsh.write(str(tmp_path / f"{version}_{binary}.msh"))
    finally:
        gmsh.finalize()
    expected = np.array(sorted(nodes.values()))
    for path in sorted(tmp_path.iterdir()):
        layout = gg.read_layout(path, refine=max(order, 2))
        assert gg.quality(layout).valid
        assert set(layout.boundaries) == {"inlet", "wall"}
        if order > 1:
            found = np.unique(np.concatenate([block.xy.reshape(-1, 2) for block in layout.blocks]).round(10), axis=0)
            assert len(found) == len(expected)
            assert found[np.lexsort(found.T)] == pytest.approx(expected[np.lexsort(expected.T.round(10))], abs=1e-9)
