"""Sections of airfoils: NACA numbers against published ordinates, files in Selig's form, nodes along the spline."""

import numpy as np
import pytest

import gridgen_sym as gg
from gridgen_sym.boundary.airfoil_section import AirfoilSection
from gridgen_sym.boundary.naca import naca_points


def sides_at(points, x):
    """Return y of the lower and of the upper side at x."""
    nose = int(points[:, 0].argmin())
    return np.interp(x, *points[nose::-1].T), np.interp(x, *points[nose:].T)


def selig(path, points, name="a section"):
    path.write_text(name + "\n" + "".join(f" {x:.8f} {y:.8f}\n" for x, y in points))
    return path


@pytest.mark.parametrize(
    ("number", "x", "upper", "lower"),
    [  # In percent of the chord, from Abbott and von Doenhoff, appendix III.
        ("naca0012", 30.0, 6.002, -6.002),
        ("naca2412", 30.0, 7.88, -4.12),
        ("naca2412", 80.0, 3.75, -1.50),
        ("naca23012", 10.0, 6.43, -2.92),
        ("naca23012", 50.0, 6.41, -4.17),
    ],
)
def test_ordinates_are_those_published(number, x, upper, lower):
    found = sides_at(naca_points(number, blunt=True), x / 100)
    np.testing.assert_allclose(np.multiply(found, 100), (lower, upper), atol=0.02)  # The tables have this error.


def test_a_trailing_edge_is_sharp_unless_it_is_to_be_blunt():
    assert AirfoilSection.of("naca2412").base == 0
    assert AirfoilSection.of("2412", blunt=True).base == pytest.approx(0.00252, rel=0.01)


def test_a_file_keeps_its_coordinates_in_either_direction(tmp_path):
    points = 3 * naca_points("naca2412", count=40) + (5, -2)
    one = AirfoilSection.of(selig(tmp_path / "one.dat", points[::-1]))
    other = AirfoilSection.of(str(selig(tmp_path / "other.dat", points, name="NACA 24 12")))
    np.testing.assert_allclose(one.points, points, atol=1e-8)
    np.testing.assert_array_equal(one.points, other.points)
    assert one.chord == pytest.approx(3, rel=1e-3)
    assert (one.name, one.base, other.name) == ("a section", 0, "NACA 24 12")


def test_nodes_lie_on_the_section_and_begin_with_the_cells_asked_for():
    section = AirfoilSection.of("naca0012")
    nodes = section.nodes(64, leading=4e-3, trailing=2e-3)
    step = np.hypot(*np.diff(nodes, axis=0).T)
    np.testing.assert_allclose(step[[0, -1, 31, 32]], [2e-3, 2e-3, 4e-3, 4e-3], rtol=0.02)
    np.testing.assert_allclose(nodes[:, 1], -nodes[::-1, 1], atol=1e-6)
    at = nodes[:33, 0]
    np.testing.assert_allclose(nodes[:33, 1], sides_at(naca_points("0012", count=5000), at)[0], atol=1e-5)


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("name\n", "at least 9 different points; came 0"),
        ("name\n0 0\n1 zero\n", "point 2 is '1 zero'"),
        ("name\n17. 17.\n\n0 0\n", "as in Lednicer's form"),
        ("name\n" + "".join(f"{k} {k * k}\n" for k in range(12)), "not closed at the trailing edge"),
        ("name\n" + "".join(f"{k} nan\n" for k in range(12)), "finite points"),
    ],
)
def test_a_bad_file_is_named_with_what_was_expected(tmp_path, text, match):
    path = tmp_path / "bad.dat"
    path.write_text(text)
    with pytest.raises(gg.GridgenError, match=match) as caught:
        AirfoilSection.of(path)
    assert "bad.dat" in str(caught.value)


@pytest.mark.parametrize("name", ["naca12", "clark-y", "naca2400", "naca28012", "2012"])
def test_what_is_no_number_of_a_family_is_refused(name):
    with pytest.raises(gg.GridgenError, match="NACA"):
        AirfoilSection.of(name)
