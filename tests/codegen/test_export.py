"""Kernels in a folder of a user's own project: one command writes them, and programs there run without this package."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import gridgen_sym as gg
from gridgen_sym.cli import main
from gridgen_sym.codegen.export import write_exported
from gridgen_sym.codegen.facts import KernelFacts
from gridgen_sym.codegen.interface import FUNCTIONS
from gridgen_sym.codegen.render import render_interface
from gridgen_sym.codegen.source import Source
from gridgen_sym.fields import density_inputs
from gridgen_sym.functionals import registry
from gridgen_sym.resources import resource_folder
from gridgen_sym.runtime import kernels

ROOT = Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "examples" / "kernels_in_c"
COMPILER = next((path for name in ("cc", "gcc", "clang") if (path := shutil.which(name))), None)
needs_compiler = pytest.mark.skipif(COMPILER is None, reason="needs a C compiler")
STRICT = ("-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Werror")
COMMAND = "gridgen-sym generate odd --functionals mine.py -o kernels --language c,numpy"


@pytest.fixture
def project(tmp_path, monkeypatch):
    """A folder with a file of a functional, to work in."""
    (tmp_path / "mine.py").write_text('import gridgen_sym as gg\ngg.define("odd", "g11 + 2*s*g22")\n')
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("GRIDGEN_SYM_QUIET", "1")
    return tmp_path


def run(command, code=0):
    """Run a command and return what it printed, once its exit code is as expected."""
    registry._registry.pop("odd", None)  # A process knows it once.
    told = CliRunner().invoke(main, command.removeprefix("gridgen-sym ").split())
    assert told.exit_code == code, (told.output, told.exception)
    return told.output


def compiled(*arguments, compiler=COMPILER):
    return subprocess.run([compiler, *map(str, arguments)], capture_output=True, text=True, check=False)


def texts(folder):
    return {path.name: path.read_text() for path in folder.iterdir()}


# ---- the command ----


@pytest.mark.slow
def test_the_command_in_the_files_makes_them_again_and_checks_them(project):
    said = run(COMMAND)
    names = {f"odd{variant}.{suffix}" for variant in ("", "_frozen", "_differentiated") for suffix in ("c", "h", "py")}
    names |= {f"gridgen_sym_{name}" for name in ("common.h", "loops.h", "loops.py")}
    first = texts(project / "kernels")
    assert first.keys() == names
    assert said.splitlines()[-1] == f"{len(names)} files changed"
    for name, text in first.items():
        assert text.count(f"do not edit: run `{COMMAND}`") == 1, name
        assert not re.search(r"(?<!gridgen_sym_)(common|loops)\.(h|py)\b(?!\.jinja)", text), name
        assert text.isascii()
        assert not [line for line in text.splitlines() if line != line.rstrip()]
    assert run(COMMAND) == "0 files changed\n"
    assert run(f"{COMMAND} --check") == "kernels is what is derived now\n"
    shutil.rmtree(project / "kernels")
    run(COMMAND)
    assert texts(project / "kernels") == first


@pytest.mark.slow
def test_the_calling_folder_matters_neither_to_the_files_nor_to_their_check(project, monkeypatch):
    run(COMMAND)
    first = texts(project / "kernels")
    (project / "deep" / "er").mkdir(parents=True)
    elsewhere = project.parent / "elsewhere"
    elsewhere.mkdir()
    for folder, way in (("deep/er", "../.."), ("kernels", ".."), (elsewhere, f"../{project.name}"), ("deep", project)):
        monkeypatch.chdir(project / folder)
        command = COMMAND.replace("mine.py", f"{way}/mine.py").replace("-o kernels", f"-o {way}/kernels")
        assert run(f"{command} --check") == f"{way}/kernels is what is derived now\n"
        assert run(command) == "0 files changed\n"
    monkeypatch.chdir(project / "kernels")
    assert run(COMMAND.replace("mine.py", "../mine.py").replace("-o kernels", "-o .")) == "0 files changed\n"
    assert texts(project / "kernels") == first
    assert all(f"run `{COMMAND}` in `..`." in text for text in first.values())


def test_two_commands_may_write_into_one_folder(project):
    """What all kernels share has the name of the first command, which is as good as that of the second."""
    commands = COMMAND, "gridgen-sym generate length -o kernels --language c"
    for command in commands:
        run(command)
    for command in commands:
        assert run(f"{command} --check") == "kernels is what is derived now\n"
        assert run(command) == "0 files changed\n"
    shared = project / "kernels" / "gridgen_sym_common.h"
    shared.write_text(shared.read_text().replace("restrict", ""))
    for command in commands:
        assert "gridgen_sym_common.h (on disk)" in run(f"{command} --check", code=1)


def test_a_difference_is_shown_and_nothing_else_is_touched(project):
    run("gridgen-sym generate length -o kernels")
    run(COMMAND.replace(",numpy", ""))
    kernel, own = project / "kernels" / "odd.c", project / "kernels" / "notes.txt"
    own.write_text("mine")
    right = kernel.read_text()
    kernel.write_text(right.replace("energy", "enemy"))
    said = run(f"{COMMAND.replace(',numpy', '')} --check", code=1)
    assert "--- kernels/odd.c (on disk)\n+++ kernels/odd.c (derived now)\n" in said
    assert "odd.h" not in said
    assert f"run  {COMMAND.replace(',numpy', '')}" in said
    assert "enemy" in kernel.read_text()
    assert run(COMMAND.replace(",numpy", "")).splitlines() == ["kernels/odd.c", "1 files changed"]
    assert kernel.read_text() == right
    assert own.read_text() == "mine"
    assert (project / "kernels" / "length.c").exists()


def test_a_file_of_somebody_else_is_never_replaced(project):
    (project / "kernels").mkdir()
    (project / "kernels" / "odd.h").write_text("/* mine */\n")
    said = run(COMMAND, code=2)
    assert "kernels/odd.h is there, and gridgen-sym did not write it: move it" in said
    assert texts(project / "kernels") == {"odd.h": "/* mine */\n"}


@pytest.mark.parametrize(
    ("command", "expected"),
    [
        ("generate length", "where should the kernels of length go? Name a folder, as in -o kernels"),
        ("generate -o kernels", "name the functionals whose kernels you want"),
        ("generate lenght -o kernels", "Did you mean 'length'?"),
        ("generate length -o kernels --language c,fortran", "unknown language 'fortran': kernels are written in c and"),
        ("generate length -o mine.py", "cannot write into mine.py: it is a file; name a folder with -o"),
        ("generate odd --functionals mine.py -o a*/b", "cannot stand in a comment"),
        ("generate length -o kernels --variant moving", "unknown variant 'moving': it is 'plain', 'regularized'"),
        ("generate length -o kernels --variant target+target", "unknown variant 'target+target'"),
        ("generate length -o kernels --variant mixed+target", "the variant 'target+mixed' is not written for other"),
        ("generate length -o kernels --variant M:differentiated", "functional 'length' has no field 'M', which"),
        ("generate length -o kernels --variant regularized", "'length' has no barrier at J = 0: there is nothing"),
        ("generate --variant target", "name the functionals whose kernels you want"),
    ],
)
def test_what_cannot_be_written_is_refused_with_the_repair(project, command, expected):
    assert expected in " ".join(run(command, code=2).split())
    assert [path.name for path in project.iterdir()] == ["mine.py"]


def test_two_kernels_of_one_name_are_refused(project):
    twice = [Source("a_frozen.h", "of a, frozen"), Source("a_frozen.h", "of a_frozen")]
    with pytest.raises(gg.GridgenError, match="two of these functionals have kernels in a_frozen"):
        write_exported(project / "kernels", twice)
    assert not (project / "kernels").exists()


# ---- C ----


@needs_compiler
def test_headers_declare_what_kernels_define_for_c_and_for_cpp(project):
    run(COMMAND)
    program = project / "both.c"
    for name in ("odd", "odd_differentiated"):
        # A declaration that differs from its definition is an error of the compiler.
        program.write_text(f'#include "{name}.h"\n#include "{name}.h"\n#include "{name}.c"\n')
        told = compiled(*STRICT, "-Wmissing-prototypes", "-fsyntax-only", "-Ikernels", program)
        assert told.returncode == 0, told.stderr
        facts = render_facts(project, name)
        declared = re.findall(rf"^void {name}_(\w+)\(", (project / "kernels" / f"{name}.h").read_text(), re.MULTILINE)
        assert declared == list(facts)
    header = project / "kernels" / "odd.h"
    header.write_text(header.read_text().replace("double *row_energy", "float *row_energy"))
    program.write_text('#include "odd.h"\n#include "odd.c"\n')
    assert "conflicting types" in compiled(*STRICT, "-fsyntax-only", "-Ikernels", program).stderr


def render_facts(project, name):
    """Return the functions of a kernel, as its source exports them."""
    functions = re.findall(r"^(\w+) = partial\(", (project / "kernels" / f"{name}.py").read_text(), re.MULTILINE)
    assert set(functions) <= set(FUNCTIONS)
    return functions


_FIELDS = 'import gridgen_sym as gg\ngg.define("odd", "p*g11 + q*g22", fields={"p": "scalar", "q": "scalar"})\n'
VARIANTS = ("target", "q:differentiated+p:differentiated+frozen")


@pytest.mark.slow
@needs_compiler
def test_kernels_with_targets_and_moving_fields_are_strict_c(project):
    (project / "mine.py").write_text(_FIELDS)
    command = " ".join([COMMAND.replace(",numpy", ""), *(f"--variant {variant}" for variant in VARIANTS)])
    run(command)
    names = {"odd", "odd_target", "odd_frozen_p_differentiated_q_differentiated"}
    assert {path.stem for path in (project / "kernels").glob("odd*.c")} == names
    for name in sorted(names):
        program = project / "both.c"
        program.write_text(f'#include "{name}.h"\n#include "{name}.c"\n')
        told = compiled(*STRICT, "-fsyntax-only", "-Ikernels", program)
        assert told.returncode == 0, told.stderr
    recorded = command.replace(VARIANTS[1], "frozen+p:differentiated+q:differentiated")
    assert f"run `{recorded}` in `..`." in (project / "kernels" / "odd_target.h").read_text()
    assert run(f"{command} --check") == "kernels is what is derived now\n"


@pytest.mark.skipif(shutil.which("c++") is None, reason="needs a C++ compiler")
def test_headers_are_read_by_cpp(project):
    run(COMMAND)
    (project / "both.cpp").write_text(
        '#include "odd.h"\n#include "odd_frozen.h"\nint main() { GridgenBlock block = {}; return (int)block.ni; }\n'
    )
    told = compiled(
        "-Wall", "-Wextra", "-pedantic", "-Werror", "-fsyntax-only", "-Ikernels", "both.cpp", compiler="c++"
    )
    assert told.returncode == 0, told.stderr


@pytest.mark.parametrize(
    "path", sorted((resource_folder("generated") / "facts").glob("*.json")), ids=lambda path: path.stem
)
def test_headers_of_all_kernels_declare_all_their_functions(path):
    facts = KernelFacts.from_json(path.read_text(encoding="utf-8"))
    header = render_interface("c", facts)
    assert re.findall(rf"^void {facts.name}_(\w+)\(", header, re.MULTILINE) == list(facts.functions)
    assert max(len(line) for line in header.splitlines() if "Generated by" not in line) <= 120
    for name in (*facts.planes, *facts.parameters):
        assert re.search(rf" (values +of|parameters) .*\b{name}\b", header)


@pytest.mark.slow
@needs_compiler
def test_a_c_program_with_the_kernels_of_a_users_functional_relaxes_a_grid(project):
    """The grid of a square is uniform: each of the 1024 corners has the energy 2."""
    for name in ("mine.py", "relax.c"):
        shutil.copy(EXAMPLE / name, project)
    run("generate smooth --functionals mine.py -o kernels")
    told = compiled(
        *STRICT[:-2],
        "-Wno-conversion",
        "-Werror",
        "-O1",
        "-Ikernels",
        "relax.c",
        "kernels/smooth.c",
        "-lm",
        "-o",
        "relax",
    )
    assert told.returncode == 0, told.stderr
    printed = subprocess.run([project / "relax"], capture_output=True, text=True, check=True).stdout
    assert printed.splitlines()[-1] == "relaxed: energy 2048.00, smallest Jacobian 1.000"


def test_the_tutorial_has_the_program_of_the_example():
    page = (ROOT / "docs" / "tutorials" / "own_functional.md").read_text(encoding="utf-8")
    for name in ("mine.py", "relax.c"):
        assert f":caption: {name}\n{(EXAMPLE / name).read_text(encoding='utf-8')}```" in page


# ---- NumPy ----

_SCRIPT = """
import sys
import numpy as np
sys.path.insert(0, {folder!r})
import {name} as kernel
coordinates, weight = np.load("grid.npy"), np.load("weight.npy")
ni, nj = weight.shape
rows, jacobians, gradient = np.zeros(ni - 1), np.zeros(ni - 1), np.zeros((2, ni, nj))
planes = [weight] * len(kernel.facts.planes)
kernel.energy_gradient(kernel.block(ni, nj), coordinates, kernel.values(*planes), [], rows, jacobians, gradient)
residual = np.zeros((2, ni, nj))
kernel.euler_lagrange_residual(kernel.block(ni, nj), coordinates, kernel.values(*planes), [], residual)
np.savez("found.npz", energy=rows.sum(), smallest=jacobians.min(), gradient=gradient, residual=residual)
assert not [module for module in sys.modules if module.split(".")[0] == "gridgen_sym"]
"""


@pytest.mark.parametrize("name", ["odd", "odd_frozen"])
def test_modules_run_without_this_package(project, name):
    run(COMMAND)
    random = np.random.default_rng(5)
    grid = gg.domain("wavy", 6, 7)
    weight = 1.0 + random.random(grid.shape)
    np.save("grid.npy", grid.planes), np.save("weight.npy", weight)
    script = _SCRIPT.format(folder="kernels", name=name)
    told = subprocess.run(
        [sys.executable, "-I", "-c", script], capture_output=True, text=True, cwd=project, check=False
    )
    assert told.returncode == 0, told.stderr
    variant = name.partition("_")[2] or "plain"
    expected = kernels(gg.functional("odd"), variant, backend="numpy")
    values = weight[None] if variant == "frozen" else None
    with np.load("found.npz") as file:
        found = dict(file)
    energy, smallest, gradient = expected.energy_gradient(np.ascontiguousarray(grid.planes), values)
    assert np.isclose(found["energy"], energy, rtol=1e-14)
    assert found["smallest"] == smallest
    assert np.array_equal(found["gradient"], gradient)
    assert np.abs(found["residual"]).max() > 0


@pytest.mark.slow
def test_a_density_that_names_a_target_has_a_kernel_with_one(project):
    """Cells of 2 x 3 are their own target: nothing is left of the density."""
    (project / "mine.py").write_text('import gridgen_sym as gg\ngg.define("odd", "(t11 + t22)/(2*tau) - 1")\n')
    run("generate odd --functionals mine.py -o kernels --language numpy")
    script = """
import sys
import numpy as np
sys.path.insert(0, "kernels")
import odd, odd_target
coordinates = np.array(np.meshgrid(2.0 * np.arange(4), 3.0 * np.arange(5), indexing="ij"))
inverse = [np.full((4, 5), value) for value in (1 / 2, 0, 0, 1 / 3)]
for kernel, planes in ((odd, []), (odd_target, inverse)):
    rows = np.zeros(3)
    kernel.energy(kernel.block(4, 5), coordinates, kernel.values(*planes), [], rows, np.zeros(3))
    print(abs(rows).max().round(12))
"""
    told = subprocess.run([sys.executable, "-I", "-c", script], capture_output=True, text=True, check=False)
    assert told.stdout.split() == [str(round(16 * (13 / 12 - 1), 12)), "0.0"], told.stderr


_CALL = """
import sys
import numpy as np
sys.path.insert(0, "kernels")
import odd_M_differentiated_target as kernel
with np.load("given.npz") as file:
    coordinates, planes = file["coordinates"], [file[name] for name in kernel.facts.planes]
_, ni, nj = coordinates.shape
rows, jacobians, gradient = np.zeros(ni - 1), np.zeros(ni - 1), np.zeros((2, ni, nj))
block, values = kernel.block(ni, nj, 1 / (ni - 1), 1 / (nj - 1)), kernel.values(*planes)
kernel.energy_gradient(block, coordinates, values, [], rows, jacobians, gradient)
residual = np.zeros((2, ni, nj))
kernel.euler_lagrange_residual(block, coordinates, values, [], residual)
np.savez("found.npz", energy=rows.sum(), gradient=gradient, residual=residual)
"""


@pytest.mark.slow
def test_a_module_with_a_target_and_a_moving_field_runs_without_this_package(project):
    """A target per corner, a field with its derivatives at the nodes: energy and gradient are those of `gg.energy`."""
    (project / "mine.py").write_text(
        'import gridgen_sym as gg\ngg.define("odd", "(M11*g11 + M22*g22)/J", fields={"M": "symmetric"})\n'
    )
    run("generate odd --functionals mine.py -o kernels --language numpy --variant target+M:differentiated")
    grid, reference = gg.domain("wavy", 6, 7), gg.domain("annulus", 6, 7)
    field = gg.Field(("1 + x**2", "0.1*x*y", "2 + y"), mode="differentiated")
    given = density_inputs(gg.functional("odd"), grid.shape, fields={"M": field}, target=gg.Target.of(reference))
    facts = kernels(gg.functional("odd"), given.variant, backend="numpy")
    steps = (1 / 5, 1 / 6)
    planes = given.planes(grid.planes, facts.planes, steps)
    np.savez("given.npz", coordinates=grid.planes, **dict(zip(facts.planes, planes, strict=True)))
    told = subprocess.run([sys.executable, "-I", "-c", _CALL], capture_output=True, text=True, check=False)
    assert told.returncode == 0, told.stderr
    options = {"fields": {"M": field}, "target": gg.Target.of(reference), "backend": "numpy"}
    with np.load("found.npz") as file:
        assert file["energy"] == pytest.approx(gg.energy(grid, "odd", **options), rel=1e-13)
        inner = np.moveaxis(file["gradient"], 0, -1)[1:-1, 1:-1]
        np.testing.assert_allclose(inner, gg.gradient(grid, "odd", **options)[1:-1, 1:-1], rtol=1e-12, atol=1e-13)
        assert np.isfinite(file["residual"]).all()
        assert np.abs(file["residual"]).max() > 0


def test_modules_have_the_facts_that_their_loops_read():
    templates = resource_folder("templates") / "numpy"
    read = {name for path in templates.glob("*.jinja") for name in re.findall(r"f\.facts\.(\w+)", path.read_text())}
    given = set(re.findall(r"^    (\w+)=\{\{ facts\.", (templates / "interface.py.jinja").read_text(), re.MULTILINE))
    assert given == read
