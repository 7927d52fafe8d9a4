"""The command `adapt`: every form of field, what it says, and what it refuses."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import gridgen_sym as gg
from gridgen_sym.cli import main

RING = "tanh(30*(sqrt((x - 0.5)**2 + (y - 0.5)**2) - 0.3))"


@pytest.fixture(autouse=True)
def _in_a_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def run(*arguments, code=0):
    """Run the command with small grids and return what it printed."""
    result = CliRunner().invoke(main, ["adapt", *(str(argument) for argument in arguments)])
    assert result.exit_code == code, result.output
    return result.output


def ring(x, y):
    return np.tanh(30 * (np.hypot(x - 0.5, y - 0.5) - 0.3))


def test_a_formula_is_adapted_to_and_reported():
    pytest.importorskip("matplotlib")
    said = run("square", "--to", RING, "--size", 20, 20, "-o", "a.vts", "--plot", "a.png")
    assert "start: square, 20 x 20 cells, none of them folded" in said
    assert "converged after" in said
    assert "density times area, now:" in said
    assert "valid: no folded cell among 400" in said
    grid = gg.read("a.vts")
    assert np.array_equal(grid.planes, gg.adapt(gg.domain("square", 21, 21), RING).grid.planes)
    with open("a.png", "rb") as file:
        assert file.read(4) == b"\x89PNG"


def test_every_option_reaches_the_library():
    options = (
        "--monitor",
        "gradient",
        "--feature-fraction",
        0.5,
        "--smoothing",
        3,
        "--boundary",
        "fixed",
        "-f",
        "area",
    )
    said = run("square", "--to", RING, "--size", 14, 14, "--steps", 2, *options, "-o", "a.npz")
    assert "NOT converged after 2 steps" in said
    monitor = gg.Monitor("gradient", feature_fraction=0.5, smoothing=3)
    start = gg.domain("square", 15, 15)
    expected = gg.adapt(start, RING, monitor=monitor, boundary="fixed", functional="area", max_iterations=2)
    assert gg.read("a.npz") == expected.grid


def field_files():
    """Write one function in the three forms of files."""
    start, axis = gg.domain("square", 15, 15), np.linspace(0, 1, 60)
    start.write("start.vts")
    x, y = np.meshgrid(axis, axis, indexing="ij")
    np.savez("raster.npz", x=axis, y=axis, values=ring(x, y))
    np.savez("nodes.npz", values=ring(*start.planes))
    samples = np.column_stack((x.ravel(), y.ravel(), ring(x, y).ravel()))
    np.savetxt("samples.csv", samples, delimiter=",", header="x,y,value", comments="")


@pytest.mark.parametrize("file", ["raster.npz", "nodes.npz", "samples.csv"])
def test_every_form_of_file_draws_the_nodes_to_the_ring(file):
    field_files()
    said = run("start.vts", "--to", file, "-o", "a.vts", "--quiet")
    assert "wrote" not in said
    grid, start = gg.read("a.vts"), gg.domain("square", 15, 15)
    assert gg.quality(grid).valid
    assert gg.interpolation_error(grid, ring) < 0.8 * gg.interpolation_error(start, ring)


def test_values_are_the_density_itself():
    axis = np.array([0.0, 1.0])
    np.savez("density.npz", x=axis, y=axis, values=[[1.0, 1.0], [9.0, 9.0]])
    run("square", "--to", "density.npz", "--monitor", "values", "--size", 12, 12, "-o", "a.vts")
    x = gg.read("a.vts").x[:, 6]
    assert np.diff(x)[0] > 3 * np.diff(x)[-1]


@pytest.mark.parametrize(
    ("arguments", "match"),
    [
        (("square", "--to", "x + z"), "unknown name 'z'"),
        (("square", "--to", "gone.npz"), "cannot read gone.npz: there is no such file"),
        (
            ("square", "--to", "other.npz"),
            "the field other.npz: it holds u; expected the arrays x (nx,), y (ny,) and values",
        ),
        (("square", "--to", "head.csv"), "the field head.csv: it begins with 'a,b'; expected the header x,y,value"),
        (("square", "--to", "text.csv"), "cannot read the field text.csv"),
        (("square", "--to", "two.csv"), "the field two.csv: it has 2 columns"),
        (("square", "--to", "none.csv"), "the field none.csv: it has a header and no samples"),
        (("square", "--to", "1/x"), "the solution must be finite at every node; it is inf at node (0, 0)"),
        (("square", "--to", "notzip.npz"), "the field notzip.npz: it is no whole NumPy archive"),
        (("square", "--to", "x", "--feature-fraction", "1"), "below 1; came 1.0"),
        (("square", "--to", "x", "--steps", "-1"), "max_iterations must be a whole number"),
        (("square", "--to", "x", "-f", "winslow"), "how 'winslow' places nodes"),
        (("square", "--to", "x", "-o", "a.txt"), "cannot write a.txt"),
        (("square", "--to", "-x", "--monitor", "values"), "density of nodes must be positive"),
    ],
)
def test_bad_input_exits_with_2_and_says_what_to_do(arguments, match, tmp_path):
    np.savez("other.npz", u=np.ones(3))
    (tmp_path / "head.csv").write_text("a,b\n1,2\n")
    (tmp_path / "text.csv").write_text("x,y,value\n1,2,three\n")
    (tmp_path / "two.csv").write_text("x,y,value\n1,2\n3,4\n")
    (tmp_path / "none.csv").write_text("x,y,value\n")
    (tmp_path / "notzip.npz").write_text("no archive")
    assert match in run(*arguments, code=2)


def test_a_time_limit_leaves_the_last_grid_and_is_no_failure():
    said = run("square", "--to", RING, "--size", 10, 10, "--time-limit", "1e-9", "-o", "a.vts")
    assert "the time limit of 1e-09 seconds is over" in said
    assert gg.read("a.vts") == gg.domain("square", 11, 11)


def test_an_outline_and_parameters():
    text = "# corners: 1 2 3 0\n0,1\n0,0\n2,0\n2,1\n"
    Path("box.csv").write_text(text)
    run("box.csv", "--to", "x", "--size", 6, 6, "--sampling", "equal", "--corners", "2,3,0,1", "-o", "a.vts")
    assert gg.read("a.vts").xy[0, 0].tolist() == [2, 0]
    run("box.csv", "--to", "tanh(9*x)", "--size", 6, 6, "--steps", 1, "-o", "b.vts")
    run("box.csv", "--to", "tanh(9*x)", "--size", 6, 6, "--steps", 1, "--parameter", "k=1", "-o", "c.vts")
    assert gg.read("b.vts") != gg.read("c.vts")
    assert "has no parameter 'q'" in run("square", "--to", "x", "--parameter", "q=1", code=2)


def test_an_interrupted_adaptation_writes_its_last_grid_and_exits_with_130(monkeypatch):
    def stop(self, grid, density, moves):
        raise KeyboardInterrupt

    monkeypatch.setattr("gridgen_sym.adaptation.mover.Mover.toward", stop)
    said = run("square", "--to", RING, "--size", 10, 10, "-o", "a.vts", code=130)
    assert "interrupted" in said
    assert gg.read("a.vts") == gg.domain("square", 11, 11)
