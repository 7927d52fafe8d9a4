"""A back end from outside of the package, in one folder: it is found by name, and a solver runs with it."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import plain_python
import pytest
from support import case_name, kernel_set, random_grid, random_weight, relative_difference

import gridgen_sym as gg
from gridgen_sym.codegen import backend as registry
from gridgen_sym.codegen import derivations
from gridgen_sym.codegen.backend import find_backend
from gridgen_sym.runtime import find_compiler

ROUND_OFF = 1e-12


@pytest.fixture
def plain(monkeypatch):
    """Register the back end for one test."""
    monkeypatch.setattr(registry, "_registered", {})
    gg.register_backend(plain_python.BACKEND)


@pytest.mark.slow
@pytest.mark.usefixtures("plain")
@pytest.mark.parametrize("inner", [False, True])
@pytest.mark.parametrize(
    "case",
    [("winslow", "plain"), ("modified_liao", "plain"), ("area_winslow", "frozen"), ("knupp", "plain")],
    ids=case_name,
)
def test_its_kernels_are_those_of_numpy(case, inner):
    plain, numpy = kernel_set(*case, "plain"), kernel_set(*case, "numpy")
    xy, weight = random_grid(4, 6), random_weight(len(numpy.planes), 4, 6)
    assert plain.backend == "plain"

    def results(kernels):
        yield np.array(kernels.energy(xy, weight, interior_only=inner))
        yield kernels.energy_gradient(xy, weight, interior_only=inner)[2]
        for semidefinite in (False, True)[: 1 + kernels.polyconvex]:
            yield kernels.hessian(xy, weight, semidefinite=semidefinite, interior_only=inner)

    for value, expected in zip(results(plain), results(numpy), strict=True):
        assert relative_difference(value, expected) < ROUND_OFF


@pytest.mark.usefixtures("plain")
def test_a_kernel_that_it_has_not_is_named():
    with pytest.raises(
        gg.GridgenError, match="'plain' of 'knupp' has no kernel semidefinite_hessian on the backend 'plain'"
    ):
        kernel_set("knupp", "plain", "plain").hessian(random_grid(3, 3), semidefinite=True)


@pytest.mark.usefixtures("plain")
def test_a_solver_runs_with_it(monkeypatch):
    start = gg.domain("swan", 7, 7)
    expected = gg.optimize(start, "winslow", backend="numpy")
    monkeypatch.setenv("GRIDGEN_SYM_BACKEND", "plain")
    found = gg.optimize(start, "winslow")
    assert found.converged
    assert expected.converged
    assert relative_difference(found.grid.planes, expected.grid.planes) < 1e-10


@pytest.mark.usefixtures("plain")
def test_what_it_prints_is_kept_until_it_prints_otherwise(monkeypatch, tmp_path):
    """A file that stands alone is its own printer; what was typed in is printed again in every process."""
    keys = []
    for text in ("# one", "# two"):
        file = tmp_path / "lonely.py"
        file.write_text(text)
        os.utime(file, (0, 0))  # What is newer than the process may not be what it has loaded.
        lonely = type("Lonely", (plain_python.PlainPython,), {"__module__": "lonely"})()
        monkeypatch.setitem(sys.modules, "lonely", SimpleNamespace(__file__=str(file), __package__=""))
        keys.append(derivations._printer(lonely))
    for token in ("one process", "another"):
        monkeypatch.setitem(sys.modules, "lonely", SimpleNamespace(__package__=""))
        monkeypatch.setattr(derivations, "key_of_process", lambda token=token: token)
        keys.append(derivations._printer(lonely))
    keys += [derivations._printer(find_backend(name)) for name in ("c", "numpy", "plain")]
    assert len(set(keys)) == len(keys)
    assert keys[-1] == derivations._printer(plain_python.BACKEND)


@pytest.mark.usefixtures("plain")
def test_names_are_given_once():
    gg.register_backend(plain_python.BACKEND)
    with pytest.raises(gg.GridgenError, match="there is a back end 'plain'"):
        gg.register_backend(plain_python.PlainPython())
    other = plain_python.PlainPython()
    other.name = "numpy"
    with pytest.raises(gg.GridgenError, match="there is a back end 'numpy'"):
        gg.register_backend(other)


def test_what_is_no_back_end_is_refused_with_what_it_lacks():
    with pytest.raises(gg.GridgenError, match="no back end: it lacks suffix, missing, render, load of the protocol"):
        gg.register_backend(type("Half", (), {"name": "half"})())


def test_an_installed_one_is_found_by_the_command_line(tmp_path):
    """What `pip install` of a package with an entry point leaves: the folder, and what it says of itself."""
    told = tmp_path / "plain_python-1.0.dist-info"
    told.mkdir()
    (told / "METADATA").write_text("Metadata-Version: 2.1\nName: plain-python\nVersion: 1.0\n")
    (told / "entry_points.txt").write_text("[gridgen_sym.backends]\nplain = plain_python:BACKEND\n")
    (tmp_path / "plain_python").symlink_to(Path(plain_python.__file__).parent)
    path = os.pathsep.join(
        filter(None, [str(tmp_path), os.environ.get("PYTHONPATH", ""), str(Path(gg.__file__).parents[1])])
    )
    environment = os.environ | {"PYTHONPATH": path}
    command = ["grid", "wavy", "-f", "winslow", "--size", "4", "4", "--backend", "plain", "-o", "wavy.npz"]
    ended = subprocess.run(
        [sys.executable, "-m", "gridgen_sym", *command], env=environment, cwd=tmp_path, capture_output=True, text=True
    )
    assert ended.returncode == 0, ended.stderr
    expected = gg.optimize(gg.domain("wavy", 5, 5), "winslow", backend="numpy").grid
    assert relative_difference(gg.read(tmp_path / "wavy.npz").planes, expected.planes) < 1e-10


@pytest.mark.parametrize("name", ["c", "numpy"])
def test_built_in_kernels_run_without_sympy_and_without_the_other_back_end(name):
    if name == "c" and find_compiler() is None:
        pytest.skip("needs a C compiler")
    script = f"""
import sys
import numpy as np
from gridgen_sym.functionals import functional
from gridgen_sym.runtime import kernels

kernels(functional("winslow"), backend={name!r}).energy(np.array([[[0.0, 0.0], [1.0, 1.0]], [[0.0, 1.0], [0.0, 1.0]]]))
print(*sys.modules)
"""
    ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    loaded = {*ended.stdout.split()}
    assert not {"sympy", "jinja2"} & loaded
    ours = {module for module in loaded if module.startswith("gridgen_sym.backends.")}
    assert ours == {f"gridgen_sym.backends.{name}", f"gridgen_sym.backends.{name}.loader"}
