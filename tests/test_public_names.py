"""The public face: every name of before works, every name is loaded when it is used, and the old ones warn."""

from __future__ import annotations

import ast
import inspect
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import gridgen_sym as gg

#: What the first stage offered.
FIRST_STAGE = (
    *("AdaptResult", "AdaptStep", "Equidistribution", "Monitor", "adapt", "equidistribution", "hierarchical_error"),
    *("interpolation_error", "recover_gradient", "recover_hessian", "recovery_error", "richardson_error", "transfer"),
    *("GridgenError", "Functional", "define", "functional", "functionals", "Certificate", "Grid", "Outline", "Quality"),
    *("certificates", "domain", "domain_names", "plot_certificates", "plot_grid", "plot_grids", "quality", "read"),
    *("sliver_certificate", "transfinite", "write", "Result", "Step", "Weight", "energy", "gradient", "hessian"),
    *("optimize", "raster_field", "scattered_field", "solve_euler_lagrange", "untangle"),
)
SQUARE = gg.domain("square", 5, 5)


@pytest.mark.parametrize("name", FIRST_STAGE)
def test_every_name_of_the_first_stage_is_there(name):
    assert name in gg.__all__
    assert callable(getattr(gg, name))


def test_every_public_name_is_an_object_with_a_docstring_and_is_listed_once():
    assert len(set(gg.__all__)) == len(gg.__all__)
    assert set(gg.__all__) <= set(dir(gg))
    for name in set(gg.__all__) - {"__version__"}:
        value = getattr(gg, name)
        assert not inspect.ismodule(value), name
        assert inspect.getdoc(value), name


def test_what_type_checkers_see_is_what_is_loaded():
    tree = ast.parse(Path(gg.__file__).read_text(encoding="utf-8"))
    (checked,) = (node for node in tree.body if isinstance(node, ast.If))
    seen = {alias.name: line.module for line in checked.body for alias in line.names}
    assert seen.keys() == gg._HOMES.keys()
    # What has the name of its module is imported from there: a type checker might take the module for it.
    assert [name for name, package in gg._HOMES.items() if seen[name] not in (package, f"{package}.{name}")] == []


@pytest.mark.parametrize("first", ["certificates", "functionals"])
def test_a_function_with_the_name_of_its_package_stays_a_function(first):
    code = f"import gridgen_sym.{first}, gridgen_sym.solvers, gridgen_sym as gg; print(gg.{first}.__name__)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == first


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match=r"gridgen_sym.*optimise"):
        _ = gg.optimise


@pytest.mark.parametrize("call", [gg.optimize, gg.untangle, gg.solve_euler_lagrange, gg.energy, gg.gradient])
def test_the_old_name_of_the_functional_warns_and_works(call):
    with pytest.warns(DeprecationWarning, match=r"name=.*functional"):
        old = call(SQUARE, name="winslow")
    new = call(SQUARE, functional="winslow")
    if isinstance(new, gg.Result):
        assert old.grid == new.grid
    else:
        np.testing.assert_array_equal(old, new)


def test_every_solver_takes_the_functional_second():
    solvers = (gg.optimize, gg.untangle, gg.solve_euler_lagrange, gg.energy, gg.gradient, gg.hessian)
    assert {list(inspect.signature(solver).parameters)[1] for solver in solvers} == {"functional"}


@pytest.mark.parametrize(("old", "new", "value"), [("steps", "max_iterations", 0), ("power", "weight_exponent", 0.5)])
def test_old_names_of_adapt_warn_and_work(old, new, value):
    given = {"max_iterations": 0} | {new: value}
    with pytest.warns(DeprecationWarning, match=f"{old}=.*{new}"):
        result = gg.adapt(SQUARE, "x", **({key: number for key, number in given.items() if key != new} | {old: value}))
    assert result.grid == gg.adapt(SQUARE, "x", **given).grid


def test_both_names_of_an_argument_are_refused_and_the_warning_points_to_the_caller():
    calls = (
        lambda: gg.optimize(SQUARE, functional="winslow", name="area"),
        lambda: gg.adapt(SQUARE, "x", steps=1, max_iterations=1),
        lambda: gg.certificates(SQUARE, work=1, budget=1),
        lambda: gg.Monitor(share=0.5, feature_fraction=0.5),
    )
    for call in calls:
        with (
            pytest.warns(DeprecationWarning, match="is deprecated") as warned,
            pytest.raises(TypeError, match="old name"),
        ):
            call()
        assert [warning.filename for warning in warned] == [__file__]


def test_names_that_are_packages_can_be_replaced_and_restored(monkeypatch):
    for name in ("certificates", "functionals"):
        before = getattr(gg, name)
        with monkeypatch.context() as patch:
            patch.setattr(gg, name, len)
            assert getattr(gg, name) is len
        assert getattr(gg, name) is before
