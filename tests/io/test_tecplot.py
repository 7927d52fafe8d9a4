"""Tecplot texts: what is written, what other programs write, and what is refused."""

from __future__ import annotations

import io

import numpy as np
import pytest
from support_files import LAYOUTS, SWAN

import gridgen_sym as gg
from gridgen_sym.io import holds_grid
from gridgen_sym.io.format import Blocks
from gridgen_sym.io.formats import tecplot


def decoded(text):
    return tecplot.decode(io.BytesIO(text.encode()))


def rows(*columns):
    return "\n".join(" ".join(repr(float(value)) for value in row) for row in zip(*columns, strict=True))


X, Y = SWAN.x.T.ravel(), SWAN.y.T.ravel()
OTHER = f"""TITLE     = "what a ZONE is"
VARIABLES = "X [m]"
"Y [m]"
"pressure, total"
DATASETAUXDATA Common.Ref="1"
ZONE T="the \\"first\\" one"
 STRANDID=0, SOLUTIONTIME=0
 I=5, J=4, K=1, ZONETYPE=Ordered
 DATAPACKING=POINT
 DT=(SINGLE SINGLE
 DOUBLE )
{rows(X, Y, X + 1)}
ZONE T="surface", I=20, F=POINT
{rows(X, Y, X)}
zone i=5 j=4 f=block, t=second
{" ".join(map(repr, map(float, X + 2)))}
{" ".join(map(repr, map(float, Y)))}
20*1.5
"""


def test_a_text_of_another_writer(capsys):
    found = decoded(OTHER)
    assert found.names == ('the "first" one', "second")
    assert found.grids[0] == SWAN
    assert np.array_equal(found.grids[1].x, SWAN.x + 2)
    assert "zones that are lines are left out: 'surface'" in capsys.readouterr().err


def test_the_text_that_is_written():
    lines = b"".join(tecplot.encode(Blocks((SWAN,), ('a "b"',)))).decode().splitlines()
    assert lines[:2] == ['TITLE = "grid"', 'VARIABLES = "x" "y"']
    assert lines[2] == 'ZONE T="a \\"b\\"", I=5, J=4, ZONETYPE=ORDERED, DATAPACKING=BLOCK, DT=(DOUBLE DOUBLE)'
    assert [float(line) for line in lines[3:]] == [*X, *Y]


@pytest.mark.parametrize("name", LAYOUTS)
def test_layouts_are_read_as_they_were_written(tmp_path, name):
    made = LAYOUTS[name]()
    for suffix in (".tec", ".dat"):
        gg.write(made, tmp_path / f"file{suffix}")
        back = gg.read(tmp_path / f"file{suffix}", layout=isinstance(made, gg.MultiBlock))
        assert back == made


def test_where_the_packing_is_not_said_the_first_line_says_it():
    for packing in ("", ", DATAPACKING=POINT"):
        text = f"VARIABLES = x, y\nZONE I=5, J=4{packing}\n{rows(X, Y)}\n"
        assert decoded(text).grids == (SWAN,)
    text = f"VARIABLES = x, y\nZONE I=5, J=4\n{' '.join(map(repr, map(float, [*X, *Y])))}\n"
    assert decoded(text).grids == (SWAN,)


def test_a_plane_in_space():
    text = f"VARIABLES = z y x\nZONE I=5, K=4, F=POINT\n{rows(Y, 0 * X + 2, X)}\n"
    assert decoded(text).grids == (SWAN,)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"X [m]"', '"r"', "its variables are 'r', 'Y"),
        ("VARIABLES", "NAMES", "it has no names of variables; expected VARIABLES"),
        (
            "I=5, J=4, K=1",
            "I=5, J=5, K=1",
            "zone 1 has 60 numbers, and 3 variables at 25 nodes need 75, so that 15 are miss",
        ),
        ("I=5, J=4, K=1", "I=5, J=3, K=1", "zone 1 has 60 .* so that 15 are too many"),
        ("I=5, J=4, K=1", "I=5.5, J=4", "zone 1 has I='5.5'; expected a whole number"),
        ("I=5, J=4, K=1", "I=1000000, J=1000000", "need 3000000000000, so that"),
        ("ZONETYPE=Ordered", "ZONETYPE=FEQUADRILATERAL", "zone 1 is unstructured"),
        ("f=block", "f=feblock", "zone 3 is unstructured"),
        (" DATAPACKING=POINT", " VARLOCATION=([3]=CELLCENTERED)", "zone 1 has cell-centered variables"),
        (" DATAPACKING=POINT", " VARSHARELIST=([1,2]=1)", "zone 1 shares variables with another zone"),
        ("0.25 0.0 1.25", "0.25 x 1.25", "line 13: could not convert string to float: 'x'"),
        ("20*1.5\n", "ZONE I=5, J=4\n", "line 56: no numbers follow the header of zone 4"),
    ],
)
def test_a_text_with_a_fault(old, new, message):
    assert old in OTHER
    with pytest.raises(gg.GridgenError, match=message):
        decoded(OTHER.replace(old, new))


def test_only_texts_of_tecplot_are_grids_among_dat_files(tmp_path):
    (tmp_path / "naca.dat").write_text("NACA 0012\n1.0 0.0\n0.0 0.0\n")
    (tmp_path / "grid.dat").write_text(OTHER)
    assert not holds_grid(tmp_path / "naca.dat")
    assert holds_grid(tmp_path / "grid.dat")
