"""The option `--weight`: a formula, samples in a file, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import gridgen_sym as gg
from gridgen_sym.cli import main

AXIS = np.linspace(0, 1, 31)
FORMULA = "1 + 4*exp(-10*((x - 0.5)**2 + (y - 0.5)**2))"


@pytest.fixture(autouse=True)
def _in_a_folder_with_samples(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    x, y = np.meshgrid(AXIS, AXIS, indexing="ij")
    values = 1 + 4 * np.exp(-10 * ((x - 0.5) ** 2 + (y - 0.5) ** 2))
    np.savez("raster.npz", x=AXIS, y=AXIS, values=values)
    samples = np.column_stack((x.ravel(), y.ravel(), values.ravel()))
    np.savetxt("samples.csv", samples, delimiter=",", header="x,y,value", comments="")
    np.savez("nodes.npz", values=np.ones((13, 13)))
    Path("samples.txt").touch()


def run(*arguments, code=0):
    mostly_area = [f"--parameter={one}" for one in ("k_A=0.8", "k_L=0.2", "k_O=0")]
    shape = ("grid", "square", "--size", "12", "12", "-f", "combined", "-o", "a.npz", *mostly_area)
    result = CliRunner().invoke(main, [*shape, *arguments])
    assert result.exit_code == code, result.output
    return result.output


@pytest.mark.parametrize("mode", ["frozen", "differentiated"])
@pytest.mark.parametrize("file", ["raster.npz", "samples.csv"])
def test_samples_in_a_file_are_a_weight(file, mode):
    run("--weight", FORMULA, "--weight-mode", mode)
    expected = gg.read("a.npz")
    run("--weight", file, "--weight-mode", mode)
    assert np.abs(gg.read("a.npz").xy - expected.xy).max() < 2e-3
    run()
    assert np.abs(gg.read("a.npz").xy - expected.xy).max() > 1e-2


@pytest.mark.parametrize(
    ("arguments", "match"),
    [
        (("--weight", "nodes.npz", "--weight-mode", "differentiated"), "an array of weights has no derivatives"),
        (("--weight", "gone.csv"), "cannot read gone.csv: there is no such file"),
        (("--weight", "a.vts"), "cannot read the field a.vts: a field is a formula in x and y, FILE.nc:VARIABLE, or"),
        (("--weight", "samples.txt"), "cannot read the field samples.txt: a field is a formula"),
        (("--weight", "1 + z"), "the weight: unknown name 'z'"),
        (("--weight-mode", "frozen"), "need a --weight FIELD"),
    ],
)
def test_bad_weights_are_refused(arguments, match):
    assert match in run(*arguments, code=2)


def test_values_at_the_nodes_of_the_start_are_a_weight():
    assert "converged" in run("--weight", "nodes.npz")


def test_a_file_whose_name_is_a_formula_is_a_formula():
    Path("x").touch()
    assert "converged" in run("--weight", "x")


@pytest.mark.parametrize("file", ["part.npz", "part.csv"])
def test_samples_that_do_not_cover_the_grid_are_refused_or_continued(file):
    x, y = np.meshgrid(AXIS[3:], AXIS, indexing="ij")
    np.savez("part.npz", x=AXIS[3:], y=AXIS, values=1 + x)
    samples = np.column_stack((x.ravel(), y.ravel(), 1 + x.ravel()))
    np.savetxt("part.csv", samples, delimiter=",", header="x,y,value", comments="")
    told = " ".join(run("--weight", file, code=2).split())
    assert "the weight is known by samples" in told
    assert "node (0, 0), x = 0, y = 0, lies outside of them" in told
    assert "--outside nearest" in told
    assert "nodes lie outside the weight's samples" in run("--weight", file, "--outside", "nearest")
    adapt = ["adapt", "square", "--size", "12", "12", "--to", file, "--max-iterations", "1"]
    assert CliRunner().invoke(main, adapt).exit_code == 2
    assert CliRunner().invoke(main, [*adapt, "--outside", "nearest"]).exit_code == 0
