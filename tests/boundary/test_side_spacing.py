"""Boundary nodes of a side, placed by a law: as an argument of an outline, and on the command line."""

import numpy as np
import pytest
from click.testing import CliRunner

import gridgen_sym as gg
from gridgen_sym.boundary.side_spacing import spaced
from gridgen_sym.cli import main

LINE = np.array([[0.0, 0.0], [1.0, 0.0], [3.0, 0.0], [3.0, 1.0]])  # Of length 4.
SQUARE = gg.Outline([[0, 0], [2, 0], [2, 1], [0, 1]], (0, 1, 2, 3))


def steps(nodes):
    return np.hypot(*np.diff(nodes, axis=0).T)


@pytest.mark.parametrize("law", ["geometric", "tanh", "sinh"])
def test_first_and_last_lengths_are_those_that_were_asked_for(law):
    straight = np.array([[0.0, 0.0], [4.0, 0.0]])
    assert steps(spaced(straight, 21, f"{law}:first=0.01"))[0] == pytest.approx(0.01)
    assert steps(spaced(straight, 21, f"{law}:last=0.01"))[-1] == pytest.approx(0.01)
    both = steps(spaced(straight, 21, f"{law}:first=0.01,last=0.05"))
    np.testing.assert_allclose(both[[0, -1]], [0.01, 0.05])
    clustered = steps(spaced(straight, 41, f"{law}:at=0.25,size=0.02"))
    np.testing.assert_allclose(clustered[9:11], 0.02)
    assert clustered.min() == pytest.approx(0.02)


def test_nodes_lie_on_the_polyline_and_its_ends_are_kept_bit_by_bit():
    nodes = spaced(LINE + 0.1, 17, "equal")
    np.testing.assert_array_equal(nodes[[0, -1]], (LINE + 0.1)[[0, -1]])
    assert np.isclose(nodes[:, 1], 0.1).sum() + np.isclose(nodes[:, 0], 3.1).sum() >= 17


def test_an_array_of_fractions_is_taken_as_it_is():
    fractions = np.linspace(0, 1, 9) ** 2
    np.testing.assert_allclose(spaced(np.array([[0.0, 0.0], [2.0, 0.0]]), 9, fractions)[:, 0], 2 * fractions)


def test_sides_of_an_outline_run_as_those_of_its_grid():
    laws = {"left": "tanh:first=0.01", "right": "geometric:first=0.01", "top": "sinh:first=0.02"}
    grid = SQUARE.grid(21, 17, spacing=laws)
    assert steps(grid.xy[0])[0] == pytest.approx(0.01)
    assert steps(grid.xy[-1])[0] == pytest.approx(0.01)
    assert steps(grid.xy[:, -1])[0] == pytest.approx(0.02)
    np.testing.assert_allclose(steps(grid.xy[:, 0]), 0.1)


def test_a_wall_meets_sides_that_are_spaced_for_it():
    grid = SQUARE.grid(33, 25, spacing={"left": "geometric:first=1e-4", "right": "geometric:first=1e-4"})
    result = gg.optimize(grid, "winslow", walls={"bottom": gg.Wall(1e-4)})
    found = result.quality.sides["bottom"]
    np.testing.assert_allclose(found.first_heights, 1e-4, rtol=1e-3)
    assert found.non_orthogonality.largest < 0.01
    assert "Boundary nodes stay" not in result.message


@pytest.mark.parametrize(
    ("spacing", "match"),
    [
        ("cubic:first=1", "unknown law 'cubic'"),
        ("tanh", "the spacing 'tanh' has no length"),
        ("tanh:first=a", "first in the spacing .* is no number"),
        ("tanh:start=1", "'start=1' in the spacing .* is none of first, last, at, size"),
        ("tanh:first=9", "must have more than 0 and less than 1"),
        ("tanh:at=0.01,size=0.1", "at in the spacing .* must be a fraction of the side"),
        ([0, 0.5, 1], "must be 9 fractions that rise from 0 to 1"),
    ],
)
def test_what_is_no_spacing_is_refused(spacing, match):
    with pytest.raises(gg.GridgenError, match=match):
        spaced(LINE, 9, spacing)


def test_an_unknown_side_is_refused():
    with pytest.raises(gg.GridgenError, match="unknown side 'below' in spacing"):
        SQUARE.grid(9, 9, spacing={"below": "equal"})
    with pytest.raises(gg.GridgenError, match="spacing must map sides to laws"):
        SQUARE.grid(9, 9, spacing="equal")


def test_the_command_line_spaces_sides(tmp_path):
    SQUARE.write(tmp_path / "square.txt")
    out = tmp_path / "grid.npz"
    arguments = ["grid", str(tmp_path / "square.txt"), "-f", "winslow", "--size", "20x16", "--quiet", "-o", str(out)]
    done = CliRunner().invoke(main, [*arguments, "--side", "left=tanh:first=0.01"])
    assert done.exit_code == 0, done.output
    assert steps(gg.read(out).xy[0])[0] == pytest.approx(0.01)
    assert CliRunner().invoke(main, [*arguments, "--side", "left"]).exit_code != 0
