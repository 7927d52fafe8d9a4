"""Walls on the command line: what `--wall` reads, and what it refuses."""

import numpy as np
import pytest
from click.testing import CliRunner

import gridgen_sym as gg
from gridgen_sym.cli import main
from gridgen_sym.cli.walls import walls_of


def test_a_wall_is_read_with_all_that_it_says():
    walls = walls_of(("bottom:first=1e-5,growth=1.2,layers=20", "top:first=0.01,law=tanh,orthogonal=no,nodes=3-9"))
    bottom, top = walls["bottom"], walls["top"]
    assert (bottom.first, bottom.growth, bottom.layers, bottom.orthogonal) == (1e-5, 1.2, 20, True)
    assert (top.first, top.law, top.orthogonal, top.nodes) == (0.01, "tanh", False, (3, 9))


@pytest.mark.parametrize(
    ("texts", "match"),
    [
        (("bottom",), "the wall 'bottom' has no height: write it as side:first=HEIGHT"),
        (("bottom:growth=1.2",), "has no height"),
        (("bottom:first=1e-5", "bottom:first=1e-4"), "two walls are given for the side bottom"),
        (("bottom:first=1e-5,grow=2",), "'grow=2' in the wall .* is none of first, growth, law"),
        (("bottom:first=small",), "first in the wall .* cannot be read"),
        (("bottom:first=1,orthogonal=1",), "must be yes or no"),
        (("bottom:first=1e-5,law=cubic",), "the law of the wall must be one of"),
    ],
)
def test_what_is_no_wall_is_refused(texts, match):
    with pytest.raises(gg.GridgenError, match=match):
        walls_of(texts)


def test_a_grid_with_a_wall_is_made(tmp_path):
    path = tmp_path / "grid.npz"
    arguments = ["grid", "quarter_annulus", "-f", "winslow", "--size", "33x25", "--wall", "bottom:first=1e-3"]
    done = CliRunner().invoke(main, [*arguments, "--quiet", "-o", str(path)])
    assert done.exit_code == 0, done.output
    grid = gg.read(path)
    height = np.hypot(*(grid.xy[3:-3, 1] - grid.xy[3:-3, 0]).T)
    np.testing.assert_allclose(height, 1e-3, rtol=0.01)


def test_walls_through_the_equations(tmp_path):
    path = tmp_path / "grid.npz"
    arguments = ["grid", "quarter_annulus", "-f", "winslow", "--size", "16x12", "--wall", "bottom:first=1e-2"]
    through = ["--solver", "euler-lagrange", "--control", "hilgenstock-white", "-o", str(path)]
    done = CliRunner().invoke(main, [*arguments, *through])
    assert done.exit_code == 0, done.output
    assert "updates of the control functions" in done.output
    grid = gg.read(path)
    np.testing.assert_allclose(np.hypot(*(grid.xy[1:-1, 1] - grid.xy[1:-1, 0]).T), 1e-2, rtol=1e-3)


def test_an_unknown_side_is_an_error_without_a_traceback():
    done = CliRunner().invoke(main, ["grid", "square", "-f", "winslow", "--wall", "below:first=1e-3", "--quiet"])
    assert done.exit_code != 0
    assert "unknown side" in done.output + str(done.exception)


def test_sides_slide_on_the_command_line(tmp_path):
    path = tmp_path / "grid.npz"
    arguments = ["grid", "quarter_annulus", "-f", "winslow", "--size", "16x12", "--quiet", "-o", str(path)]
    done = CliRunner().invoke(main, [*arguments, "--slide", "left,right"])
    assert done.exit_code == 0, done.output
    start = gg.domain("quarter_annulus", 17, 13)
    assert np.abs(gg.read(path).xy[0] - start.xy[0]).max() > 1e-3
    local = [*arguments, "--slide", "left,right", "--solver", "local", "--max-iterations", "3"]
    assert CliRunner().invoke(main, local).exit_code == 0
    refused = CliRunner().invoke(main, [*arguments, "--slide", "left", "--solver", "relaxation"])
    assert refused.exit_code != 0
    assert "--slide belongs to the discrete energy" in refused.output + str(refused.exception)
