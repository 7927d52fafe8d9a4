"""Outlines: their checks, their files, and the grids inside them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support import NO_SHARED, SHARED

from gridgen_sym.boundary import Outline
from gridgen_sym.errors import GridgenError
from gridgen_sym.grids import quality

REPOSITORY = Path(__file__).parents[2]
EXAMPLES = sorted((REPOSITORY / "examples" / "outlines").glob("*.csv"))
OUTLINES = SHARED / "domains" / "outlines"

SQUARE = np.array([[0, 0], [1, 0], [2, 0], [2, 2], [0, 2], [0, 1.5]], dtype=float)
CORNERS = (0, 2, 3, 4)
TEXT = "# name: box\n# corners: 0 1 2 3\n# source: none\nx,y\n0,0\n1,0\n1,1\n0,1\n"


def circle(count):
    """A regular polygon, counter-clockwise."""
    angle = 2 * np.pi * np.arange(count) / count
    return np.stack((np.cos(angle), np.sin(angle)), axis=-1)


def test_sides_and_grid_of_a_square():
    outline = Outline(SQUARE, CORNERS, "box")
    bottom, top, left, right = outline.sides(5, 3)
    assert bottom == pytest.approx(np.array([[0, 0], [0.5, 0], [1, 0], [1.5, 0], [2, 0]]))
    assert top == pytest.approx(bottom + np.array([0, 2]))
    assert left == pytest.approx(np.array([[0, 0], [0, 1], [0, 2]]))
    assert right == pytest.approx(left + np.array([2, 0]))
    grid = outline.grid(5, 3)
    assert grid.shape == (5, 3)
    assert quality(grid).min_jacobian == pytest.approx(0.5)
    assert quality(grid).max_jacobian == pytest.approx(0.5)


def test_corners_are_kept_exactly():
    points = circle(97) * 0.1 + 1 / 3
    corners = (0, 20, 50, 71)
    xy = Outline(points, corners).grid(14, 9).xy
    for index, node in zip(corners, (xy[0, 0], xy[-1, 0], xy[-1, -1], xy[0, -1]), strict=True):
        assert np.array_equal(points[index], node)


def test_nodes_stand_at_equal_arc_length():
    bottom, _, _, _ = Outline(circle(400), (0, 100, 200, 300)).sides(11, 11)
    assert np.arctan2(bottom[:, 1], bottom[:, 0]) == pytest.approx(np.linspace(0, np.pi / 2, 11), abs=1e-4)


def test_a_clockwise_curve_is_refused_or_run_backwards(capsys, monkeypatch):
    monkeypatch.delenv("GRIDGEN_SYM_QUIET", raising=False)
    mirrored = SQUARE * [-1, 1]
    with pytest.raises(GridgenError, match=r"clockwise.*reorient=True"):
        Outline(mirrored, CORNERS, reorient=False)
    for scale in (1e-200, 1e200):  # Areas that vanish or overflow.
        with pytest.raises(GridgenError, match="clockwise"):
            Outline(scale * mirrored, CORNERS, reorient=False)
    assert not capsys.readouterr().err
    outline = Outline(mirrored, CORNERS)
    assert "runs clockwise, and is taken backwards from corner 1: bottom and top stay" in capsys.readouterr().err
    assert outline.corners == (0, 2, 4, 5)
    assert outline.points[list(outline.corners)].tolist() == [[-2, 0], [0, 0], [0, 2], [-2, 2]]
    bottom, top, left, right = outline.sides(3, 3)
    assert (bottom[:, 1] == 0).all()
    assert (top[:, 1] == 2).all()
    assert (left[:, 0] == -2).all()
    assert (right[:, 0] == 0).all()
    assert quality(outline.grid(4, 4)).valid
    assert Outline(SQUARE, CORNERS, reorient=False) == Outline(SQUARE, CORNERS)
    rolled = Outline(np.roll(mirrored, 2, axis=0), [(corner + 2) % 6 for corner in CORNERS])
    assert rolled == outline
    capsys.readouterr()
    assert quality(Outline(mirrored, "auto").grid(4, 4)).valid
    assert capsys.readouterr().err == "gridgen_sym: the outline 'outline' runs clockwise, and is taken backwards\n"


@pytest.mark.parametrize(
    ("corners", "listed"),
    [
        ((0, 3, 2, 4), r"\[0, 3, 2, 4\]"),
        ((0, 2, 2, 4), r"\[0, 2, 2, 4\]"),
        ((0, 2, 3, 6), r"from 0 to 5.*6\]"),
        ((0, 2, 3, -1), "-1"),
        ((0, 2, 3), r"\[0, 2, 3\]"),
        ((0, 1.5, 3, 4), "1.5"),
        ((0, 2, 3, np.nan), "nan"),
        ((0, 2, 3, np.inf), "inf"),
    ],
)
def test_corners_follow_each_other(corners, listed):
    with pytest.raises(GridgenError, match=f"four different indices.*{listed}"):
        Outline(SQUARE, corners)


def test_the_first_corner_comes_first():
    outline = Outline(SQUARE, (4, 5, 0, 2))
    assert outline.corners == (0, 1, 2, 4)
    assert outline.points.tolist() == np.roll(SQUARE, 2, axis=0).tolist()


def test_repeated_points_are_named():
    doubled = np.insert(SQUARE, 3, SQUARE[3], axis=0)
    with pytest.raises(GridgenError, match=r"3 and 4 are both \[2.0, 2.0\]; remove point 4"):
        Outline(doubled, CORNERS)


def test_a_closed_curve_may_repeat_its_first_point():
    for copies in (1, 2):
        closed = np.concatenate((SQUARE, np.repeat(SQUARE[:1], copies, axis=0)))
        assert Outline(closed, CORNERS) == Outline(SQUARE, CORNERS)
    with pytest.raises(GridgenError, match="N >= 4"):
        Outline([(0, 0)] * 5, "auto")
    with pytest.raises(GridgenError, match=r"came with \(0,\)"):
        Outline([], "auto")


@given(st.integers(0, 5), st.integers(0, 1), st.sampled_from([np.nan, np.inf, -np.inf]))
def test_points_must_be_finite(k, axis, value):
    points = SQUARE.copy()
    points[k, axis] = value
    with pytest.raises(GridgenError, match=f"'box' must be finite, but point {k} is"):
        Outline(points, CORNERS, "box")


@pytest.mark.parametrize("points", [SQUARE[:3], SQUARE.T, SQUARE.ravel(), np.zeros((0, 2))])
def test_enough_points_of_the_right_shape(points):
    with pytest.raises(GridgenError, match="N >= 4"):
        Outline(points, (0, 1, 2, 3))


@pytest.mark.parametrize(
    ("points", "edges"),
    [
        ([[0, 0], [1, 1], [1, 0], [0, 1]], (0, 2)),  # A bow tie.
        ([[0, 0], [2, 0], [2, 2], [1, 0], [0, 2]], (0, 2)),  # Touches the bottom with a vertex.
        ([[0, 0], [2, 0], [3, 0], [1, 0], [1, 2]], (0, 2)),  # Runs back on itself.
        ([[0, 0], [2, 0], [2, 2], [1, 1], [0, 2], [1, 1]], (2, 4)),  # Visits a point twice.
    ],
)
def test_the_first_crossing_is_named(points, edges):
    with pytest.raises(GridgenError, match=rf"crosses or touches itself: edge {edges[0]} .* meets edge {edges[1]} "):
        Outline(points, (0, 1, 2, 3))


@given(st.integers(8, 60), st.data())
def test_two_points_exchanged_cross(count, data):
    points = circle(count)
    k = data.draw(st.integers(0, count - 1))
    m = (k + data.draw(st.integers(2, count - 2))) % count
    points[[k, m]] = points[[m, k]]
    with pytest.raises(GridgenError, match="crosses or touches itself"):
        Outline(points, (0, 2, 4, 6))


@given(st.integers(5, 200), st.floats(1e-200, 1e200), st.floats(-1e6, 1e6))
def test_a_convex_curve_passes_at_any_scale(count, scale, shift):
    outline = Outline(scale * circle(count) + scale * shift * 1e-6, (0, 1, 2, 3))
    assert len(outline.points) == count


def test_a_crossing_in_a_later_block_is_found():
    points = circle(4500)
    points[[4400, 4402]] = points[[4402, 4400]]
    with pytest.raises(GridgenError, match="edge 4399"):
        Outline(points, (0, 1000, 2000, 3000))


def test_too_few_nodes_make_the_sampled_boundary_cross():
    # A thin crescent: with 3 nodes a side the inner arc's chord cuts through the outer one.
    angle = np.linspace(0, np.pi, 61)
    outer = np.stack((np.cos(angle), np.sin(angle)), axis=-1)
    inner = 0.95 * outer[::-1]
    outline = Outline(np.concatenate((outer, inner)), (0, 60, 61, 121), "crescent")
    with pytest.raises(GridgenError, match="with 3 x 3 nodes the sampled boundary of 'crescent' crosses") as caught:
        Outline(np.concatenate((outer, inner[:-1], [[0.95, 0.01], [0.95, 0.0]])), (0, 60, 61, 90), "crescent").grid(
            3, 3
        )
    assert "take more nodes" in str(caught.value)
    assert outline.grid(30, 3).shape == (30, 3)
    for ni, nj in ((2, 5), (5, 2), (5.5, 5)):
        with pytest.raises(GridgenError, match="at least 3"):
            outline.grid(ni, nj)


def test_reading_and_writing(tmp_path):
    path = tmp_path / "box.csv"
    path.write_bytes(TEXT.replace("\n", "\r\n").encode("utf-8-sig"))
    outline = Outline.read(path)
    assert outline.name == "box"
    assert outline.corners == (0, 1, 2, 3)
    assert outline.points.tolist() == [[0, 0], [1, 0], [1, 1], [0, 1]]
    odd = Outline(circle(11) / 3, (0, 3, 5, 8), "two\nlines")
    odd.write(tmp_path / "odd.csv")
    back = Outline.read(tmp_path / "odd.csv")
    assert back == odd
    assert hash(back) == hash(odd)
    assert back.name == "two lines"
    assert back != outline
    assert outline != "box"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("# corners: 0 1 2 3\n", "", "has no corners; add a line like"),
        ("0 1 2 3", "0 1 2", "line 2 has the corners '0 1 2'"),
        ("0 1 2 3", "0 1 2 b", "line 2 has the corners"),
        ("0 1 2 3", "0 2 1 3", "four different indices"),
        ("x,y", "x,x", "line 4 is 'x,x'; expected the header 'x,y', or 'lon,lat', among other names once each"),
        ("x,y", "x,lat", "line 4 is 'x,lat'; expected the header 'x,y'"),
        ("x,y", "x,y,z", "line 5 is '0,0'; expected three numbers with a comma between"),
        ("x,y", "NACA 0012", "put # before any other"),
        ("1,1", "1;1", "line 7 is '1;1'"),
        ("1,1", "1,1,1", "line 7 is"),
        ("1,1", "one,1", "line 7 is"),
        ("1,1", "nan,1", "point 2 is"),
        ("1,1\n", "", "N >= 4"),
        ("1,1\n0,1", "0,1\n1,1", "crosses or touches itself"),
        (TEXT[TEXT.index("x,y") :], "", "has no points"),
        (TEXT, "\x00\x01\x02", "line 1 is"),
        (TEXT, "", "the file is empty"),
    ],
)
def test_a_malformed_file_is_an_error_with_its_path(tmp_path, old, new, message):
    assert TEXT.count(old) == 1
    path = tmp_path / "bad.csv"
    path.write_text(TEXT.replace(old, new))
    with pytest.raises(GridgenError, match=message) as caught:
        Outline.read(path)
    assert str(path) in str(caught.value)


def test_read_turns_a_clockwise_curve(tmp_path):
    path = tmp_path / "clockwise.csv"
    path.write_text(TEXT.replace("1,0\n1,1\n0,1", "0,1\n1,1\n1,0"))
    assert quality(Outline.read(path).grid(3, 3)).valid
    with pytest.raises(GridgenError, match=f"{path}.*clockwise"):
        Outline.read(path, reorient=False)


@pytest.mark.parametrize(
    "points",
    [
        "0,0\n1.5,0\n1,1\n0,1",
        "x, y\n0, 0\n 1.5,0\n1 ,1\n0,1\n0,0",
        '"x";"y"\n0;0\n1,5;0\n1;1\n0;1',
        "X\tY\n0\t0\n1.5\t0\n1\t1\n0\t1",
        "  0.0  0.0\n  1.5e+00  0.0\n\n  1  1\n  0   1",
        "\ufeffx y\r\n0 0\r\n1.5 0\r\n1 1\r\n0 1\r\n",
    ],
)
def test_columns_are_read_as_programs_write_them(tmp_path, points):
    (tmp_path / "box.dat").write_text(points, encoding="utf-8", newline="")
    outline = Outline.read(tmp_path / "box.dat", corners=(0, 1, 2, 3))
    assert outline.points.tolist() == [[0, 0], [1.5, 0], [1, 1], [0, 1]]


def test_missing_files(tmp_path):
    with pytest.raises(GridgenError, match="no such file"):
        Outline.read(tmp_path / "none.csv")
    with pytest.raises(GridgenError, match="is a folder"):
        Outline.read(tmp_path)
    with pytest.raises(GridgenError, match="does not exist"):
        Outline(SQUARE, CORNERS).write(tmp_path / "none" / "box.csv")


@given(st.integers(0, len(TEXT) - 1))
def test_a_truncated_file_never_crashes(cut):
    path = Path("truncated.csv")
    from gridgen_sym.outlines import registry as module

    original = module.read_bytes
    module.read_bytes = lambda _: TEXT[:cut].encode() or b"?"
    try:
        outline = Outline.read(path)
        assert cut >= len(TEXT) - 1
        assert len(outline.points) == 4
    except GridgenError:
        assert cut < len(TEXT) - 1
    finally:
        module.read_bytes = original


def test_the_examples_are_there():
    assert [path.stem for path in EXAMPLES] == [
        "france",
        "lake_superior",
        "lake_victoria",
        "nlf416_half_o",
        "ohio",
        "spain",
        "texas",
    ]


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples_can_be_gridded(path):
    outline = Outline.read(path)
    report = quality(outline.grid(65, 65, sampling="equal"))
    assert report.mean_jacobian > 0
    expected = {"france": 494, "nlf416_half_o": 0, "ohio": 213, "texas": 269}
    expected |= {"lake_superior": 862, "lake_victoria": 846, "spain": 261}
    assert report.folded_cells == expected[outline.name]


@pytest.mark.skipif(not OUTLINES.is_dir(), reason=NO_SHARED.format("domains/outlines"))
def test_all_shared_outlines_are_accepted():
    paths = [path for path in sorted(OUTLINES.glob("*.csv")) if path.stem != "index"]
    assert len(paths) == 12
    for path in paths:
        assert quality(Outline.read(path).grid(33, 33)).mean_jacobian > 0


# ---- curves that repeat their first point, with corners of their own ----

BENT = [[0, 0], [1, 0], [2, 0.5], [1, 1], [0, 1]]


@pytest.mark.parametrize("copies", [0, 1, 2])
@pytest.mark.parametrize("mark", [0, 1])
def test_marks_of_a_closed_curve_are_those_of_its_points(copies, mark):
    """As gridgen's own examples have them: the copy of the first point has a mark, too."""
    closed = Outline(BENT + BENT[:1] * copies, [1, 1, 0, 1, 1] + [mark] * copies)
    assert closed == Outline(BENT, (0, 1, 3, 4))
    last = Outline(BENT + BENT[:1] * copies, [0 if copies and mark else 1, 1, 0, 1, 1] + [mark] * copies)
    assert last == closed


@pytest.mark.parametrize("corners", [(5, 1, 3, 4), (1, 3, 4, 5), (3, 4, 5, 1)])
def test_the_index_of_the_copy_is_that_of_the_first_point(corners):
    assert Outline(BENT + BENT[:1], corners) == Outline(BENT, [corner % 5 for corner in corners])


@pytest.mark.parametrize(
    ("corners", "message"),
    [
        ((0, 1, 3, 5), r"are \[0, 1, 3, 5\]; point 5 is point 0 again, and no other corner"),
        (
            [1, 1, 0, 1, 0, 1],
            "hold 3 times 1 and 0 times -1; the last point is the first one again, so that their marks",
        ),
        ([1, 1, 0, 1, 1, -1], "hold 4 times 1 and 1 times -1$"),
        ((0, 1, 3, 6), r"from 0 to 4, in the order of the points, but are \[0, 1, 3, 6\]$"),
        (list(range(1000)), r"but are \[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, \.\.\.\]"),
    ],
)
def test_a_copy_that_is_meant_as_another_corner_is_told(corners, message):
    with pytest.raises(GridgenError, match=message):
        Outline(BENT + BENT[:1], corners)


def test_numbers_of_a_file_are_written_as_everyone_writes_them(tmp_path):
    path = tmp_path / "outline.txt"
    for text, message in (
        ("# corners: 0 1 2 3\n0,0\n1_0,0\n1_0,1\n0,1\n", "line 3 is '1_0,0'; expected two numbers"),
        ("# corners: 0 1 2 0_3\n0,0\n1,0\n1,1\n0,1\n", "has the corners '0 1 2 0_3'; expected four whole numbers"),
        ("# corners: 0 1 2 3\n0,0\n١,0\n1,1\n0,1\n", "line 3 is"),
        (f"# corners: {'0 ' * 9999}\n", r"has the corners '0 0 .*\.\.\. \(19\d+ characters\)"),
    ):
        path.write_text(text)
        with pytest.raises(GridgenError, match=message) as told:
            Outline.read(path)
        assert len(str(told.value)) < 500


@pytest.mark.parametrize("large", [1e301, 1.7e308])
def test_coordinates_whose_lengths_overflow_are_refused(large):
    with pytest.raises(GridgenError, match=r"must lie within 1e\+300 of 0, or lengths overflow, but point 1 is"):
        Outline([[0, 0], [large, 0], [large, large], [-large, large]], (0, 1, 2, 3))
    with pytest.raises(GridgenError, match="must be finite, but point 1"):
        Outline([[0, 0], [np.inf, 0], [1, large], [0, 1]], (0, 1, 2, 3))
    Outline([[0, 0], [1e300, 0], [1e300, 1e300], [-1e300, 1e300]], (0, 1, 2, 3)).grid(9, 9)


def test_a_sampled_boundary_that_crosses_itself_is_not_called_impossible():
    """A grid of a boundary that overlaps itself can be valid; an outline's own grids are not to do so."""
    spiral = np.linspace(0, 7, 300)
    inner, outer = (
        np.stack((r * np.cos(spiral), r * np.sin(spiral)), -1) for r in (1 + 0.2 * spiral, 1.9 + 0.2 * spiral)
    )
    curve = Outline(np.concatenate((outer, inner[::-1])), (0, 299, 300, 599))
    with pytest.raises(GridgenError, match=r"would fold or overlap itself.*take more nodes") as told:
        curve.grid(5, 3)
    assert "no valid grid" not in str(told.value)
