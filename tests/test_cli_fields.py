"""The options `--field` and `--target`: what the functions take, as text; what is no field is refused."""

from __future__ import annotations

import numpy as np
import pytest
from click.testing import CliRunner
from support_fields import CONTROLLED, DVINSKY
from support_solvers import disordered, farthest

import gridgen_sym as gg
from gridgen_sym.cli import main
from gridgen_sym.cli.field import fields_of

TENSOR = ("1 + x**2", "max(0.1, 0.2*y)", "2")
AXIS = np.linspace(-0.1, 1.1, 41)


@pytest.fixture(autouse=True)
def _in_a_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for one in (DVINSKY, CONTROLLED):
        gg.define(one.name, one.density, fields=one.fields, constraints=one.constraints)


def run(*arguments, code=0, functional="mapped"):
    shape = ("grid", "square", "--size", "8x7", "-f", functional, "-o", "a.npz", "--backend", "numpy")
    result = CliRunner().invoke(main, [*shape, *arguments])
    assert result.exit_code == code, result.output
    return result.output


def expected(**options):
    return gg.optimize(gg.domain("square", 9, 8), backend="numpy", **options).grid


@pytest.mark.slow
def test_a_tuple_of_formulas_is_a_tensor():
    run("--field", f"M=({', '.join(TENSOR)})")
    held = expected(functional=DVINSKY, fields={"M": TENSOR})
    assert farthest(gg.read("a.npz"), held) < 1e-12
    run("--field", f"M:differentiated={', '.join(TENSOR)}")
    moving = expected(functional=DVINSKY, fields={"M": gg.Field(TENSOR, mode="differentiated")})
    assert farthest(gg.read("a.npz"), moving) < 1e-12
    assert farthest(held, moving) > 1e-3


@pytest.mark.slow
def test_several_fields_in_the_logical_square():
    run("--field", "p:logical=1 + xi", "--field", "q = (2 + x)*(1 + y)", functional="spread")
    fields = {"p": gg.Field("1 + xi", domain="logical"), "q": "(2 + x)*(1 + y)"}
    assert farthest(gg.read("a.npz"), expected(functional=CONTROLLED, fields=fields)) < 1e-12


@pytest.mark.slow
def test_files_hold_several_components():
    x, y = np.meshgrid(AXIS, AXIS, indexing="ij")
    values = np.stack([1 + x**2, np.maximum(0.1, 0.2 * y), 2 + 0 * x])
    np.savez("raster.npz", x=AXIS, y=AXIS, values=values)
    columns = np.column_stack([x.ravel(), y.ravel(), *values.reshape(3, -1)])
    np.savetxt("samples.csv", columns, delimiter=",", header="x,y,M11,M12,M22", comments="")
    np.savez("first.npz", x=AXIS, y=AXIS, values=values[0])
    wanted = expected(functional=DVINSKY, fields={"M": TENSOR})
    for value in ("raster.npz", "samples.csv", "(first.npz, max(0.1, 0.2*y), 2)"):
        run("--field", f"M={value}")
        assert farthest(gg.read("a.npz"), wanted) < 1e-3
    np.savez("nodes.npz", values=np.stack([np.ones((9, 8)), np.zeros((9, 8)), np.ones((9, 8))]))
    run("--field", "M=nodes.npz")
    assert farthest(gg.read("a.npz"), gg.domain("square", 9, 8)) < 1e-9


@pytest.mark.parametrize("solver", ["newton", pytest.param("local", marks=pytest.mark.slow)])
def test_a_grid_file_is_a_target(solver):
    wanted = disordered(gg.domain("square", 9, 8), 0.3)
    for name in ("reference.vts", "reference.csv"):
        wanted.write(name)
        run("--target", name, "--solver", solver, functional="winslow")
        assert farthest(gg.read("a.npz"), wanted) < (1e-10 if solver == "newton" else 1e-5)


def test_two_lengths_and_an_angle_are_a_target():
    run("--target", "0.1*(1 + xi), 0.2, 80", functional="winslow")
    target = gg.Target("0.1*(1 + xi)", 0.2, angle=80)
    assert farthest(gg.read("a.npz"), expected(functional="winslow", target=target)) < 1e-12
    run("--target", "(0.1, 0.2)", "--solver", "euler-lagrange", functional="winslow")
    assert farthest(gg.read("a.npz"), gg.domain("square", 9, 8)) < 1e-9


def test_control_functions():
    run("--control", "-2*xi, 0.5", "--solver", "euler-lagrange", functional="winslow")
    start = gg.domain("square", 9, 8)
    found = gg.solve_euler_lagrange(start, "winslow", control=("-2*xi", 0.5), backend="numpy").grid
    assert farthest(gg.read("a.npz"), found) < 1e-12
    assert farthest(found, start) > 0.01
    run("--control", "thomas-middlecoff", "--solver", "relaxation", functional="winslow")
    assert farthest(gg.read("a.npz"), start) < 1e-9


@pytest.mark.parametrize(
    ("arguments", "match"),
    [
        (("-f", "winslow", "--control", "0, 0"), "--control belongs to the equations"),
        (("-f", "winslow", "--solver", "relaxation", "--control", "laplace"), "--control takes two formulas"),
        (("--field", "M"), "--field is written NAME=VALUE"),
        (("--field", "M:melted=1"), "came 'M:melted=1'"),
        (("--field", "M=(1, 0, 1)", "--field", "M=(1, 0, 1)"), "--field gives M twice"),
        (("--field", "M=(1, 0)"), "the field M is symmetric and needs 3 components, in the order M11, M12, M22"),
        (("--field", "M=(1, 0, 1 + z)"), "the component M22 of the field M: unknown name 'z'"),
        (("--field", "M=gone.npz"), "cannot read gone.npz: there is no such file"),
        (("--field", "M=(1, 2, 1)"), "must be positive definite; it is not at node (0, 0), x = 0, y = 0"),
        ((), "needs values of the field M (symmetric)"),
        (("--field", "M=(1, 0, 1)", "--field", "k=1"), "has no field 'k'; it declares M (symmetric)"),
        (("-f", "winslow", "--target", "gone.vts"), "cannot read gone.vts: there is no such file"),
        (("-f", "winslow", "--target", "0.1"), "--target takes a grid file (.vts"),
        (("-f", "winslow", "--target", "x, 1"), "w1 of the target: unknown name 'x'"),
        (("-f", "winslow", "--target", "0, 1"), "the target must have cells of positive area"),
    ],
)
def test_bad_fields_and_targets_are_refused(arguments, match):
    output = run(*arguments, code=2)
    assert match in " ".join(output.split())
    assert "Traceback" not in output


def test_a_target_of_another_size_is_refused():
    gg.domain("square", 5, 5).write("small.vts")
    assert "reference grid of the target has (5, 5) nodes" in run("--target", "small.vts", functional="winslow", code=2)


def test_parentheses_of_a_product_are_no_tuple():
    assert fields_of(["p=(1 + x)*(2 + y)"])["p"].source == "(1 + x)*(2 + y)"
    assert fields_of(["M=(max(1, x), 0, ((2)))"])["M"].source == ("max(1, x)", "0", "((2))")


def test_a_weight_has_one_value():
    np.savez("raster.npz", x=AXIS, y=AXIS, values=np.ones((3, 41, 41)))
    output = run("--weight", "raster.npz", functional="winslow", code=2)
    assert "it has 3 values per sample, and one is wanted" in output
