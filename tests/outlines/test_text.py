"""Outlines as text: columns of any order and name, marks of corners, islands; each against the curve it means."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import gridgen_sym as gg
from gridgen_sym.outlines import is_outline, outline_formats, read_content

BOX = [[0, 0], [2, 0], [2, 1], [0, 1], [0, 0.5]]
L_SHAPE = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]
L_MARKS = [1, 1, 1, -1, 1, 1]


def table(head, *rows):
    return "\n".join([*head, *(",".join(map(str, row)) for row in rows)]) + "\n"


@pytest.mark.parametrize(
    ("text", "geographic"),
    [
        ("x,y\n0,0\n2,0\n2,1\n0,1\n0,0.5\n", None),
        ("y,x\n0,0\n0,2\n1,2\n1,0\n0.5,0\n", None),
        ("lon,lat\n0,0\n2,0\n2,1\n0,1\n0,0.5\n", True),
        ('"Latitude","Longitude"\n"0","0"\n"0","2"\n"1","2"\n"1","0"\n"0.5","0"\n', True),
        ("id;X (m);Y (m)\n7;0;0\n8;2,0;0\n9;2;1\n10;0;1\n11;0;0,5\n", None),
        (",x,y,name\n0,0,0,a\n1,2,0,b\n2,2,1,c\n3,0,1,d\n4,0,0.5,e\n", None),
        ("FID,POINT_X,POINT_Y,POINT_Z\n1,0,0,-\n2,2,0,-\n3,2,1,-\n4,0,1,-\n5,0,0.5,-\n", None),
        ("easting northing\n0 0\n2 0\n2 1\n0 1\n0 0.5\n", None),
        ("0 0\t\n2 0\t\n2\t1\n 0 1\n0\t 0.5\n", None),
        ("1 0 0\n2 2 0\n3 2 1\n4 0 1\n5 0 0.5\n", None),
        ("0 0 0\n2 0 0\n2 1 0\n0 1 0\n0 0.5 0\n", None),
        ("% Matlab\n0 0\n2 0\n2 1\n0 1\n0 0.5\n", None),
    ],
)
def test_columns_are_found_by_name_or_by_number(tmp_path, text, geographic):
    path = tmp_path / "box.csv"
    path.write_text(text)
    found = read_content(path)
    assert found.points.tolist() == BOX
    assert found.corners is None
    assert found.geographic is geographic


def test_unknown_names_of_two_columns_are_taken_in_order_and_reported(tmp_path, capsys):
    path = tmp_path / "box.csv"
    path.write_text("foo,bar\n0,0\n2,0\n2,1\n0,1\n0,0.5\n")
    assert read_content(path).points.tolist() == BOX
    assert "the columns 'foo' and 'bar' are taken for x and y" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a,b,c\n0,0,0\n", "line 1 is 'a,b,c'; expected the header 'x,y', or 'lon,lat'"),
        ("x,y,x\n0,0,0\n", "among other names once each"),
        ("0 0 3\n2 0 4\n2 1 5\n0 1 6\n", "nothing shows what its 3 columns are"),
        ("0 0 1\n2 0 1\n2 1 1\n0 1 0\n", "nothing shows what its 3 columns are"),
        ("0 0\n2 0\n2 1 7\n0 1\n", "nothing shows what its 3 columns are"),
        ("0 0 0 0 0\n1 1 1 1 1\n", "line 1 is '0 0 0 0 0'; expected the header 'x,y'"),
    ],
)
def test_columns_in_doubt_are_refused(tmp_path, text, message):
    path = tmp_path / "box.txt"
    path.write_text(text)
    with pytest.raises(gg.GridgenError, match=message) as caught:
        read_content(path)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize(
    "text",
    [
        "# SeaGrid: lon lat isCorner\n0 0 1\n2 0 1\n2 1 1\n0 1 1\n0 0.5 0\n",
        "0 0.5\n0 0 1*\n2 0 1\n2 1 1\n0 1 1\n",  # gridgen-c's: marks may be missing, the asterisk is the first corner.
        "0 0.5\n0 0 1 *\n2 0 1\n2 1 1\n0 1 1\n0 0.5\n",
        "-0. 0 1\n2 0 1\n2 1 1*\n0 1 1\n0 .5\n0 0 1\n",
        "beta,y,x\n1,0,0\n1,0,2\n1,1,2\n1,1,0\n0,0.5,0\n",
        "x,y,corner\n0,0,1\n2,0,1\n2,1,1\n0,1,1\n0,.5,0\n0,0,1\n",
        "0,0,0,1\n1,2,0,1\n2,2,1,1\n3,0,1,1\n4,0,.5,0\n",
    ],
)
def test_marks_of_corners_are_those_of_the_points(tmp_path, text):
    path = tmp_path / "xy.0"
    path.write_text(text)
    outline = gg.Outline.read(path)
    start = BOX.index(outline.points[0].tolist())
    assert start == (2 if "2 1 1*" in text else 0)
    assert np.roll(outline.points, start, axis=0).tolist() == BOX
    assert [(k + start) % 5 for k in outline.corners] == [*range(start, 4), *range(start)]


def test_a_side_with_several_turns(tmp_path, capsys):
    """Of the five corners of an L one is within a side: the two choices are mirror images, and the rest is refused."""
    path = tmp_path / "l.xy"
    path.write_text("".join(f"{x} {y} {mark}\n" for (x, y), mark in zip(L_SHAPE, L_MARKS, strict=True)))
    outline = gg.Outline.read(path)
    assert "marked with 5 turns to the left and 1 to the right" in capsys.readouterr().err
    corners = [outline.points[k].tolist() for k in outline.corners]
    assert corners in ([[0, 0], [2, 0], [2, 1], [0, 2]], [[0, 0], [2, 0], [1, 2], [0, 2]])
    assert [1, 1] in outline.grid(9, 9).xy.reshape(-1, 2).tolist()  # The turn to the right is a node.


@pytest.mark.parametrize("long", [[9, 1], [1, 9]])
def test_corners_of_marks_are_the_same_in_either_direction(long):
    """Of an L with one long arm, whose two choices differ."""
    points, marks = np.array(L_SHAPE) * long, np.array(L_MARKS)
    outlines = [gg.Outline(np.roll(points, k, axis=0), np.roll(marks, k)) for k in range(6)]
    outlines += [gg.Outline(np.roll(points, k, axis=0)[::-1], np.roll(marks, k)[::-1]) for k in range(6)]
    chosen = [sorted(one.points[k].tolist() for k in one.corners) for one in outlines]
    assert all(one == chosen[0] for one in chosen)
    left_out = [2, 9] if long == [1, 9] else [9, 2]  # The arm keeps its end.
    assert left_out in points.tolist()
    assert (left_out in chosen[0]) is False


def test_turns_within_each_side_add_up_to_zero():
    """A comb: seven turns to the left and three to the right, of which no side may keep one over."""
    comb = [[0, 0], [5, 0], [5, 2], [4, 2], [4, 1], [3, 1], [3, 2], [2, 2], [2, 1], [0, 1]]
    marks = np.array([1, 1, 1, 1, -1, -1, 1, 1, -1, 1])
    for start in range(len(comb)):
        outline = gg.Outline(np.roll(comb, start, axis=0), np.roll(marks, start))
        shift = comb.index(outline.points[0].tolist())
        turns = np.roll(marks, -shift)
        cuts = [*outline.corners, len(comb)]
        assert all(turns[k] == 1 for k in outline.corners)
        assert [turns[a + 1 : b].sum() for a, b in pairwise(cuts)] == [0, 0, 0, 0]


@pytest.mark.parametrize(
    ("marks", "message"),
    [
        ([1, 1, 1, 1, 1, 0], "hold 5 times 1 and 0 times -1"),
        ([1, 1, 1, -1, 1, 0], "hold 4 times 1 and 1 times -1"),
        ([4 / 3, 0, 4 / 3, 0, 4 / 3, 0], r"turns of \[1.3333, 1.3333, 1.3333\] right angles"),
    ],
)
def test_marks_of_another_sum_or_angle_are_refused(marks, message):
    with pytest.raises(gg.GridgenError, match=message):
        gg.Outline(L_SHAPE, marks)


def test_islands_are_read_and_written(tmp_path):
    island = [[0.5, 0.2], [1, 0.2], [1, 0.6]]
    outline = gg.Outline(BOX, (0, 1, 2, 3), "box", islands=[[*island, island[0]]])
    assert [one.tolist() for one in outline.islands] == [island]
    outline.write(tmp_path / "box.csv")
    back = gg.Outline.read(tmp_path / "box.csv")
    assert back == outline
    assert back != gg.Outline(BOX, (0, 1, 2, 3))
    with pytest.raises(gg.GridgenError, match="island 0 of the outline 'box' needs finite points"):
        gg.Outline(BOX, (0, 1, 2, 3), "box", islands=[island[:2]])


def test_curves_that_nan_parts_are_the_largest_and_its_islands(tmp_path, capsys):
    path = tmp_path / "coast.dat"
    path.write_text(
        "NaN NaN\n0.5 0.2\n1 0.2\n1 0.6\nNaN NaN\n0 0\n2 0\n2 1\n0 1\n0 .5\nnan nan\n9 9\n9 8\n8 8\nNaN NaN\n"
    )
    found = read_content(path)
    assert found.points.tolist() == BOX
    assert [island.tolist() for island in found.islands] == [[[0.5, 0.2], [1, 0.2], [1, 0.6]]]
    assert "the largest of 2 separate curves is the outline; 1 left out" in capsys.readouterr().err


@pytest.mark.parametrize("names", [("x", "y"), ("lon", "lat"), ("xy",)])
def test_archives(tmp_path, names):
    columns = np.array(BOX).T
    arrays = {"xy": np.array(BOX)} if names == ("xy",) else dict(zip(names, columns, strict=True))
    path = tmp_path / "box.npz"
    np.savez(path, **arrays, corners=[0, 1, 2, 3])
    assert is_outline(path)
    outline = gg.Outline.read(path)
    assert outline.points.tolist() == BOX
    assert read_content(path).geographic is (True if names[0] == "lon" else None)
    gg.domain("square", 4, 4).write(tmp_path / "grid.npz")
    assert not is_outline(tmp_path / "grid.npz")
    np.savez(path, x=np.zeros((3, 3)), y=np.zeros((3, 3)))
    assert not is_outline(path)
    np.savez(path, x=np.zeros(3), y=np.zeros(4))
    with pytest.raises(gg.GridgenError, match=r"box.npz as a NumPy archive: its arrays x and y have the shapes \(3,\)"):
        read_content(path)


def section(count=20):
    from gridgen_sym.boundary.naca import naca_points

    return naca_points("2412", count=count)[::-1]


def test_sections_of_both_forms_are_one_curve(tmp_path):
    points = section()
    nose = int(points[:, 0].argmin())
    upper, lower = points[: nose + 1][::-1], points[nose:]
    lines = [" ".join(map(str, point)) for point in points.tolist()]
    (tmp_path / "selig.dat").write_text("\n".join(["NACA 2412", *lines]))
    rows = ["\n".join(" ".join(map(str, point)) for point in side.tolist()) for side in (upper, lower)]
    (tmp_path / "lednicer.dat").write_text(f"NACA 2412\n {len(upper)}. {len(lower)}.\n\n{rows[0]}\n\n{rows[1]}\n")
    for name in ("selig.dat", "lednicer.dat"):
        found = read_content(tmp_path / name)
        np.testing.assert_array_equal(found.points, points[:-1])  # The ends differ by rounding.
        assert found.name == "NACA 2412"
        assert gg.Outline.read(tmp_path / name, corners="auto").grid(21, 21).shape == (21, 21)
    from gridgen_sym.boundary.airfoil_section import AirfoilSection

    one, other = (AirfoilSection.of(tmp_path / name).points for name in ("selig.dat", "lednicer.dat"))
    np.testing.assert_array_equal(one, other)
    (tmp_path / "lednicer.dat").write_text(f"NACA 2412\n {len(upper)}. 99.\n\n{rows[0]}\n\n{rows[1]}\n")
    with pytest.raises(gg.GridgenError, match=r"as a section of an airfoil: its first pair \d+ 99 counts points"):
        read_content(tmp_path / "lednicer.dat")


def test_every_format_says_what_it_reads():
    root = Path(__file__).parents[2]
    for name, form in outline_formats().items():
        file, _, test = form.test.partition("::")
        assert f"def {test}(" in (root / file).read_text(), name
        assert form.suffixes, name
        assert len(form.description) > 20, name
        assert not form.description.endswith("."), name
