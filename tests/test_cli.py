"""The command line: what every command prints and does, and its exit codes."""

from __future__ import annotations

import importlib
import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from layouts import ring

import gridgen_sym as gg
from gridgen_sym.cli import main
from gridgen_sym.runtime import find_compiler

ROOT = Path(__file__).parent.parent
BACKENDS = ("c", "numpy") if find_compiler() else ("numpy",)
MINE = '''import gridgen_sym as gg

def smooth(m, k=0.1):
    """Winslow's smoothness with a little orthogonality."""
    return (m.g11 + m.g22) / m.J + k * m.g12**2 / m.J**2

gg.define("smooth", smooth)
'''


@pytest.fixture(autouse=True)
def _in_a_folder(tmp_path, monkeypatch):
    """Work in a folder of the test's own; `--quiet` sets a variable, which must not stay."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("GRIDGEN_SYM_QUIET", "1")


@pytest.fixture
def mine(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(MINE)
    return str(path)


def run(*arguments, code=0):
    """Run a command and return what it printed, once its exit code is as expected."""
    result = CliRunner().invoke(main, [str(argument) for argument in arguments])
    assert result.exit_code == code, (result.output, result.exception)
    assert "Traceback" not in result.output
    return result.output


# ---- grid ----


def test_the_swan_of_the_specification_is_valid():
    said = run("grid", "swan", "-f", "winslow", "--size", 40, 40, "-o", "swan.vts")
    assert "start: swan, 40 x 40 cells, 57 of them folded" in said
    assert "valid: no folded cell among 1600" in said
    assert gg.quality(gg.read("swan.vts")).folded_cells == 0


def test_texas_writes_both_files_and_exits_by_its_folded_cells():
    pytest.importorskip("matplotlib")
    arguments = ["grid", ROOT / "examples/outlines/texas.csv", "-f", "length", "--size", 64, 64]
    result = CliRunner().invoke(main, [*map(str, arguments), "-o", "texas.vts", "--plot", "texas.png"])
    folded = gg.quality(gg.read("texas.vts")).folded_cells
    assert Path("texas.png").read_bytes().startswith(b"\x89PNG")
    assert result.exit_code == (1 if folded else 0)
    assert (f"not valid: {folded} of 4096" in result.output) == bool(folded)


def test_a_folded_result_exits_with_1_and_says_where_after_writing():
    said = run("grid", "swan", "-f", "length", "--size", 40, 40, "--solver", "euler-lagrange", "-o", "s.npz", code=1)
    folded = gg.quality(gg.read("s.npz"))
    assert folded.describe_folds() in said
    quiet = run("grid", "s.npz", "-f", "length", "--solver", "euler-lagrange", "--quiet", code=1)
    assert quiet.startswith("not valid: ")


def test_size_is_cells_and_40_by_default():
    run("grid", "wavy", "-f", "length", "-o", "a.csv")
    run("grid", "wavy", "-f", "length", "--size", 7, 5, "-o", "b.xyz")
    assert gg.read("a.csv").shape == (41, 41)
    assert gg.read("b.xyz").shape == (8, 6)


@pytest.mark.parametrize(
    "size", [["--size", "7x5"], ["--size=7x5"], ["--size", "7×5"], ["--size", "7,5"], ["--size=7", "5"]]
)
def test_a_size_may_be_one_word(size):
    assert "start: wavy, 7 x 5 cells" in run("grid", *size, "-f", "length", "wavy")
    assert "start: wavy, 7 x 5 cells" in run("grid", "-f", "length", *size, "--", "wavy")


def test_without_files_it_only_reports(tmp_path):
    assert "Jacobian" in run("grid", "chevron", "-f", "winslow", "--size", 8, 8)
    assert not list(tmp_path.iterdir())
    assert run("grid", "chevron", "-f", "winslow", "--size", 8, 8, "--quiet") == ""


@pytest.mark.parametrize("solver", ["newton", "local", "euler-lagrange", "relaxation"])
def test_all_solvers_and_options_reach_the_library(solver):
    options = ["--tolerance", "1e-4", "--max-iterations", 400, "--no-keep-valid", "--backend", "numpy"]
    run("grid", "horseshoe_map:R=3", "-f", "winslow", "--solver", solver, "--size", 8, 8, "-o", "a.npz", *options)
    start = gg.domain("horseshoe_map", 9, 9, R=3)
    assert np.array_equal(gg.read("a.npz").planes[:, 0], start.planes[:, 0])
    assert gg.read("a.npz") != start


@pytest.mark.parametrize("solver", ["newton", "euler-lagrange"])
def test_the_spacing_reaches_every_solver(solver):
    call = ["grid", "quarter_annulus", "-f", "combined", "--size", 6, 6, "--solver", solver, "-o", "a.npz"]
    grids = []
    for given in ([], ["--spacing", "unit"], ["--spacing", "index"]):
        run(*call, *given)
        grids.append(gg.read("a.npz"))
    assert grids[0] == grids[1]
    assert np.abs(grids[0].planes - grids[2].planes).max() > 0.01
    assert "'--spacing'" in run(*call, "--spacing", "3", code=2)


def test_a_result_that_did_not_converge_is_told_and_is_no_failure():
    said = run("grid", "wavy", "-f", "winslow", "--size", 12, 12, "--max-iterations", 1, "--solver", "local")
    assert "not converged in 1 iterations" in said
    assert "valid: no folded cell" in said


@pytest.mark.parametrize("solver", ["newton", "local", "euler-lagrange", "relaxation"])
def test_a_time_limit_leaves_the_best_grid_which_decides_the_exit_code(solver):
    limit = ["-f", "winslow", "--solver", solver, "--time-limit", "1e-9"]
    said = run("grid", "swan", *limit, "--size", 40, 40, "-o", "folded.npz", code=1)
    assert "the time limit of 1e-09 seconds is over" in said
    assert gg.quality(gg.read("folded.npz")).folded_cells <= 57
    run("grid", "wavy", *limit, "--size", 8, 8, "-o", "valid.npz")
    assert gg.read("valid.npz") == gg.domain("wavy", 9, 9)
    assert "time_limit must be a positive number" in run("grid", "wavy", *limit[:-1], "-1", code=2)


def test_continuation_in_a_parameter():
    said = run("grid", "quarter_annulus", "-f", "area_winslow", "--size", "6x5", "--continuation", "k=1, 0.1")
    assert "iterations: k = 0.1: " in said


def test_weights_and_parameters():
    weight = ["--weight", "1 + x**2", "--weight-mode", "differentiated"]
    run("grid", "square", "-f", "area", "--size", 6, 6, *weight, "--interior-only")
    negative = ["grid", "square", "-f", "area", "--size", 6, 6, "--weight", "x - 0.5"]
    assert "must not be negative" in run(*negative, code=2)
    assert "negative at" in run(*negative, "--allow-negative-weight", "--max-iterations", 2)
    shares = [part for name in ("k_A=0.2", "k_L=0.6", "k_O=0.2") for part in ("--parameter", name)]
    run("grid", "square", "-f", "combined", "--size", 6, 6, *shares)


def test_a_grid_file_is_the_start():
    gg.domain("swan", 9, 9).write("start.vts")
    assert "start: start.vts, 8 x 8 cells" in run("grid", "start.vts", "-f", "winslow", "-o", "end.vts")
    assert "drop --size" in run("grid", "start.vts", "-f", "winslow", "--size", 8, 8, code=2)


def test_a_clockwise_outline_is_turned_unless_that_is_forbidden(monkeypatch):
    monkeypatch.delenv("GRIDGEN_SYM_QUIET", raising=False)
    Path("a.csv").write_text("# corners: 0 1 2 3\n0,0\n0,1\n2,1\n2,0\n")
    said = run("grid", "a.csv", "-f", "winslow", "--size", 4, 4, "-o", "a.npz")
    assert "runs clockwise, and is taken backwards" in said
    assert gg.read("a.npz").xy[-1, 0].tolist() == [0, 0]  # The bottom is the side from point 0 to 1, and stays.
    assert "runs clockwise" in run("grid", "a.csv", "-f", "winslow", "--no-reorient", code=2)
    run("grid", "a.csv", "-f", "winslow", "--size", 4, 4, "--corners", "2,3,0,1", "-o", "b.npz")
    assert gg.read("b.npz").xy[-1, 0].tolist() == [2, 1]  # Numbers of points are those of the file.


@pytest.mark.slow
def test_memory_that_does_not_suffice_is_told():
    assert "not enough memory: take fewer nodes" in run("grid", "swan", "-f", "length", "--size", *2 * [10**7], code=2)


BAD = {
    "an unknown domain": (["swann", "-f", "winslow"], "did you mean 'swan'"),
    "a misspelled functional": (["swan", "-f", "winslo"], "Did you mean 'winslow'"),
    "a missing file": (["nowhere.csv", "-f", "winslow"], "there is no such file"),
    "a missing grid": (["nowhere.vts", "-f", "winslow"], "there is no such file"),
    "an unknown suffix": (["swan", "-f", "winslow", "-o", "a.stl"], "the suffix '.stl' is unknown; use one of"),
    "no suffix": (["swan", "-f", "winslow", "-o", "a"], "it has no suffix; use one of"),
    "a missing folder": (["swan", "-f", "winslow", "-o", "no/a.vts"], "does not exist"),
    "a folder as a picture": (["swan", "-f", "winslow", "--plot", "/"], "it is a folder"),
    "too few cells": (["swan", "-f", "winslow", "--size", "1", "9"], "at least 2 2; came 1 9"),
    "a parameter of the domain": (["swan:R=4", "-f", "winslow"], "has no parameter 'R'"),
    "no number": (["horseshoe_map:R=big", "-f", "winslow"], "written NAME=NUMBER"),
    "a parameter of the functional": (["swan", "-f", "winslow", "--parameter", "k=1"], "has no parameter 'k'"),
    "no equals sign": (["swan", "-f", "knupp", "--parameter", "k"], "written NAME=NUMBER"),
    "continuation without numbers": (["swan", "-f", "winslow", "--continuation", "k=a"], "written NAME=NUMBER,NUMBER"),
    "continuation of equations": (
        ["swan", "-f", "area_winslow", "--solver", "relaxation", "--continuation", "k=1,0.1"],
        "--continuation belongs to the discrete energy",
    ),
    "continuation of a bad value": (["swan", "-f", "area_winslow", "--continuation", "k=1,-1"], "needs k > 0"),
    "a broken constraint": (["swan", "-f", "combined", "--parameter", "k_A=3"], "needs k_A + k_L + k_O == 1"),
    "a mode without a weight": (["swan", "-f", "area", "--weight-mode", "frozen"], "need a --weight"),
    "a bad formula": (["swan", "-f", "area", "--weight", "x^2"], "^"),
    "a bad tolerance": (["swan", "-f", "area", "--tolerance", "2"], "between 0 and 1"),
    "sums without corners": (["swan", "-f", "area", "--solver", "relaxation", "--interior-only"], "--interior-only"),
    "no functional": (["swan"], "Missing option"),
    "a negative weight": (["swan", "-f", "area", "--weight", "x-9"], "must not be negative"),
    "a bad time limit": (["swan", "-f", "area", "--time-limit", "-1"], "positive number of seconds"),
    "an underscore in a size": (["swan", "-f", "area", "--size", "1_0", "9"], "'1_0' is not a whole number"),
    "an underscore in a number": (["swan", "-f", "area", "--tolerance", "1e-0_1"], "'1e-0_1' is not a number"),
    "an underscore in a parameter": (["horseshoe_map:R=4_5", "-f", "area"], "written NAME=NUMBER"),
    "a size of three": (["swan", "-f", "area", "--size", "4x4x4", "4"], "'4x4x4' is not a whole number"),
    "half a size": (["swan", "-f", "area", "--size", "4x", "4"], "'4x' is not a whole number"),
    "a long number": (["swan", "-f", "area", "--tolerance", "1" + "x" * 10**5], "characters) is not a number"),
    "a long parameter": (["swan", "-f", "area", "--parameter", "k" * 10**5], "characters)"),
    "a long name": (["swan", "-f", "k" * 10**5], "characters)"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_bad_input_exits_with_2_and_says_what_to_do(case):
    arguments, message = BAD[case]
    said = run("grid", *arguments, code=2)
    assert message in said
    assert "start:" not in said  # No work begins before it is known what to do.
    assert len(said) < 1500


def test_a_picture_needs_matplotlib(monkeypatch):
    import importlib.util

    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    assert "gridgen-sym[plot]" in run("grid", "swan", "-f", "winslow", "--plot", "a.png", code=2)


def test_an_interrupt_exits_with_130(monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("gridgen_sym.solvers.optimize", interrupted)
    assert "interrupted" in run("grid", "swan", "-f", "winslow", code=130)


@pytest.mark.parametrize("text", ["raise KeyboardInterrupt", "gg.define('interrupted_one', 'g11 + g22 + J**2')"])
def test_an_interrupt_while_a_functional_is_read_or_derived_exits_with_130(monkeypatch, text):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    Path("mine.py").write_text(f"import gridgen_sym as gg\n{text}\n")
    monkeypatch.setattr("gridgen_sym.codegen.derivations.known_report", interrupted)
    told = run("derive", "interrupted_one", "--functionals", "mine.py", code=130)
    assert told.split() == ["interrupted"]


def test_an_interrupted_solver_writes_its_best_grid_and_exits_with_130(monkeypatch):
    from gridgen_sym.solvers.run.progress import Progress

    def interrupted(self, *_):
        raise KeyboardInterrupt

    monkeypatch.setattr(Progress, "step", interrupted)
    said = run("grid", "chevron", "-f", "winslow", "--size", 8, 8, "-o", "best.vts", code=130)
    assert "it was interrupted" in said
    assert gg.read("best.vts") == gg.domain("chevron", 9, 9)


def test_an_error_of_the_system_exits_with_2(monkeypatch):
    def full(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("gridgen_sym.solvers.optimize", full)
    assert "No space left on device" in run("grid", "swan", "-f", "winslow", code=2)


@pytest.mark.skipif(os.name != "posix", reason="needs POSIX signals")
@pytest.mark.parametrize("module", ["gridgen_sym.errors", "numpy", "click.core", "gridgen_sym.cli.base"])
def test_an_interrupt_while_the_command_line_loads_exits_with_130_and_no_traceback(module, tmp_path):
    """Ctrl-C comes when a module has just been found, as a hook of the import system sees it."""
    hook = f"""
import os, signal, sys
class Interrupt:
    def find_spec(self, name, path=None, target=None):
        if name == {module!r}:
            os.kill(os.getpid(), signal.SIGINT)
sys.meta_path.insert(0, Interrupt())
signal.signal(signal.SIGINT, signal.default_int_handler)
"""
    (tmp_path / "sitecustomize.py").write_text(hook)
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(tmp_path), str(ROOT)])}
    command = [sys.executable, "-m", "gridgen_sym", "domains"]
    told = subprocess.run(command, env=environment, capture_output=True, text=True, check=False, timeout=60)
    assert (told.returncode, told.stdout, told.stderr) == (130, "", "\ninterrupted\n")
    # A library leaves signals alone.
    command = [sys.executable, "-c", "import gridgen_sym.cli"]
    told = subprocess.run(command, env=environment, capture_output=True, text=True, check=False, timeout=60)
    assert "KeyboardInterrupt" in told.stderr


# ---- quality, domains ----


def test_quality_exits_with_1_where_a_cell_is_folded():
    gg.domain("swan", 41, 41).write("folded.vts")
    gg.domain("square", 5, 5).write("square.vts")
    assert "57 of 1600 cells are folded" in run("quality", "folded.vts", code=1)
    assert "valid: no folded cell among 16" in run("quality", "square.vts")
    assert "there is no such file" in run("quality", "no.vts", code=2)


def test_quality_prints_what_programs_read():
    gg.domain("swan", 41, 41).write("folded.vts")
    gg.domain("annulus", 9, 7).write("annulus.npz")
    assert json.loads(run("quality", "folded.vts", "--json", code=1)) == gg.quality(gg.read("folded.vts")).as_dict()
    told, found = json.loads(run("quality", "annulus.npz", "--json")), gg.quality(gg.read("annulus.npz"))
    assert told["valid"] is True
    assert told["non_orthogonality"]["percentile_95"] == found.non_orthogonality.percentile_95
    assert told["sides"]["top"]["first_heights"] == list(found.sides["top"].first_heights)
    assert told["sides"]["left"]["growth"][1] == found.sides["left"].growth[1]
    assert told["sides"]["right"]["non_orthogonality"]["largest"] == found.sides["right"].non_orthogonality.largest


@pytest.mark.parametrize("suffix", [".vts", ".xyz", ".p2dfmt", ".csv", ".npz", ".cgns"])
def test_what_grid_writes_is_measured_by_quality(suffix):
    if suffix == ".cgns":
        pytest.importorskip("h5py")
    run("grid", "square", "-f", "winslow", "--size", "4x5", "-o", f"square{suffix}")
    assert "valid: no folded cell among 20" in run("quality", f"square{suffix}")


def test_domains_lists_every_domain():
    said = run("domains")
    assert [line.split()[0] for line in said.splitlines()] == gg.domain_names()


# ---- formulas ----


def test_functionals_lists_every_functional_with_its_classification(mine):
    said = run("functionals", "--functionals", mine)
    lines = {line.split()[0]: line for line in said.splitlines() if line.strip()}
    assert set(gg.functionals()) <= set(lines)
    assert "linear, uncoupled, elliptic" in lines["length"]
    assert "k=0.1" in lines["smooth"]
    assert "quasilinear, coupled, elliptic        yes" in lines["winslow"]


def test_functionals_proves_nothing_and_is_quick(monkeypatch):
    """Proofs take seconds for each functional: they belong to `derive`."""
    classification = importlib.import_module("gridgen_sym.symbolic.classify.classification")
    for name in ("ellipticity", "lower_bound", "corner_model"):
        monkeypatch.setattr(classification, name, None)
    assert "changing type" in run("functionals")


def test_info_says_what_is_wrong_with_the_backend(monkeypatch):
    monkeypatch.setenv("GRIDGEN_SYM_BACKEND", "nope")
    said = run("info")
    assert "none: unknown backend 'nope'" in said
    assert "numpy  " in said


def test_info_says_what_is_wrong_with_the_compiler_and_the_cache(monkeypatch, tmp_path):
    from gridgen_sym.runtime import cache_folder

    (tmp_path / "cache").mkdir()
    (tmp_path / "cache").chmod(0o777)
    monkeypatch.setenv("CC", "false")
    monkeypatch.setenv("GRIDGEN_SYM_CACHE", str(tmp_path / "cache"))
    find_compiler.cache_clear()
    cache_folder.cache_clear()
    try:
        said = run("info")
    finally:
        find_compiler.cache_clear()
        cache_folder.cache_clear()
    assert "CC is 'false', but" in said
    if os.name == "posix":
        assert "can be written by other users (mode 0777)" in said


def test_derive_prints_text_and_latex():
    assert "length" in run("derive", "length")
    assert r"\section{The functional \texttt{length}}" in run("derive", "length", "--latex")
    assert r"\documentclass" in run("derive", "length", "--document")
    assert "Did you mean 'length'" in run("derive", "lenght", code=2)


@pytest.mark.slow
def test_verify_finds_the_errata_and_no_discovery():
    said = run("verify")
    for erratum in (1, 2, 3, *range(5, 15)):  # E4 is withdrawn.
        assert f"[E{erratum}]" in said
    assert "0 differ without a known erratum" in said
    assert "x_etaeta*y_xi*(x_xi - y_xi)" in said


def test_verify_exits_with_1_for_a_discovery(monkeypatch):
    from dataclasses import replace

    import gridgen_sym.symbolic
    from gridgen_sym.functionals.paper import PRINTED

    wrong = next(equation for equation in PRINTED if equation.key == "liao-sum")
    wrong = replace(wrong, expressions=("g11**2 + g22**2 + 3*g12**2",))
    verify = gridgen_sym.symbolic.verify
    monkeypatch.setattr(gridgen_sym.symbolic, "verify", lambda: verify([wrong]))
    assert "not a known erratum" in run("verify", code=1)


def test_generate_checks_and_writes(monkeypatch):
    import gridgen_sym.codegen.generate as module

    monkeypatch.setattr(module, "check_generated", lambda: "")
    assert "is what is derived now" in run("generate", "--check")
    monkeypatch.setattr(module, "check_generated", lambda: "--- a\n+++ b\n")
    assert "--- a\n+++ b\n" in run("generate", "--check", code=1)
    monkeypatch.setattr(module, "write_generated", lambda: [Path.cwd() / "generated" / "a.c"])
    assert run("generate").splitlines() == [os.path.join("generated", "a.c"), "1 files changed"]


# ---- a user's functional ----


@pytest.mark.slow
def test_a_users_functional_of_ten_lines_goes_the_whole_way(mine, monkeypatch):
    assert len(MINE.splitlines()) <= 10
    assert "smooth" in run("derive", "smooth", "--functionals", mine)
    monkeypatch.undo()
    environment = {**os.environ, "GRIDGEN_SYM_QUIET": "1"}
    said = program("--functionals", mine, "check", "smooth", env=environment)
    assert (said.returncode, said.stdout.count("ok  "), said.stdout.count("\n")) == (0, 6, 6)


@pytest.mark.slow
@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("solver", ["newton", "local", "euler-lagrange"])
def test_a_users_functional_makes_grids_with_every_solver(mine, solver, backend):
    swan = ["grid", "swan", "-f", "smooth", "--functionals", mine, "--size", 12, 12, "-o", "a.npz"]
    assert "converged in" in run(*swan, "--solver", solver, "--backend", backend)
    assert gg.quality(gg.read("a.npz")).valid


@pytest.mark.slow
@pytest.mark.parametrize("backend", BACKENDS)
def test_the_environment_chooses_the_backend(mine, backend, monkeypatch):
    monkeypatch.setenv("GRIDGEN_SYM_BACKEND", backend)
    assert f"{backend} (GRIDGEN_SYM_BACKEND)" in run("info")
    run("--functionals", mine, "grid", "chevron", "-f", "smooth", "--size", 6, 6)


FILES = {
    "a bad line": ("import gridgen_sym as gg\n\nnowhere + 1\n", "bad.py, line 3: NameError"),
    "a syntax error": ("x = (\n", "bad.py, line 1: '(' was never closed"),
    "a bad density": ('import gridgen_sym as gg\ngg.define("a", "g11 + zz")\n', "bad.py, line 2: "),
    "nothing": ("x = 1\n", "adds no functional"),
    "an exit": ("raise SystemExit(3)\n", "bad.py, line 1: SystemExit"),
}


@pytest.mark.parametrize("case", FILES)
def test_a_bad_file_of_functionals_is_named(case):
    text, message = FILES[case]
    Path("bad.py").write_text(text)
    assert message in run("--functionals", "bad.py", "domains", code=2)


def test_a_missing_file_of_functionals_is_named():
    assert "no.py: there is no such file" in run("grid", "--functionals", "no.py", "swan", "-f", "a", code=2)


def test_checks_can_fail(monkeypatch):
    """Give `check` the kernels of another functional: what depends on them fails, and the command exits with 1."""
    from gridgen_sym.selfcheck import digits, limit

    right = limit.kernels
    monkeypatch.setattr(limit, "kernels", lambda _, *given, **options: right(gg.functional("area"), *given, **options))
    said = run("check", "length", code=1)
    assert said.count("FAILED") == 1
    assert "FAILED  discrete gradient" in said
    monkeypatch.setattr(digits, "_density", lambda *_, found=digits._density: found(gg.functional("area")))
    assert run("check", "length", code=1).count("FAILED") == 4


# ---- the program ----


def test_paper_hands_over_the_folder(monkeypatch):
    module = pytest.importorskip("gridgen_sym.paper_examples")
    called = []
    monkeypatch.setattr(module, "run", lambda folder, progress: called.append(folder))
    run("paper", "-o", "here")
    assert called == [Path("here")]


def test_info_tells_the_backend_and_the_cache(tmp_path):
    said = run("info")
    assert gg.__version__ in said
    for label in ("backend", "compiler", "OpenMP", "threads", "cache", "generated", "python", "sympy"):
        assert f"\n{label} " in said


def program(*arguments, env=None):
    command = [sys.executable, "-m", "gridgen_sym", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, env=env)


def test_the_module_runs_as_a_program():
    told = program("--version")
    assert (told.returncode, told.stdout) == (0, f"gridgen-sym, version {gg.__version__}\n")
    bad = program("grid", "nowhere.vts", "-f", "winslow")
    assert bad.returncode == 2
    assert bad.stdout == ""
    assert bad.stderr.startswith("Error: cannot read nowhere.vts")


@pytest.mark.slow
def test_a_terminal_without_the_signs_of_mathematics_shows_others():
    told = program("functionals", env={**os.environ, "PYTHONIOENCODING": "ascii"})
    assert told.returncode == 0
    assert "half of each: (J? + g12?)/4" in told.stdout


def test_help_and_import_do_not_load_what_they_do_not_need():
    code = (
        "import sys, gridgen_sym, gridgen_sym.cli as cli\n"
        "cli.main(['--help'], standalone_mode=False)\n"
        "print(*sorted({'sympy', 'jinja2', 'matplotlib', 'rich', 'scipy', 'mpmath'} & set(sys.modules)), sep=',')\n"
    )
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert told.stdout.splitlines()[-1] == ""


def test_a_grid_with_a_committed_functional_does_not_load_sympy():
    code = (
        "import sys, gridgen_sym.cli as cli\n"
        "cli.main(['grid', 'chevron', '-f', 'winslow', '--size', '6', '6'], standalone_mode=False)\n"
        "assert 'sympy' not in sys.modules\n"
    )
    subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)


NOTCHED = "x,y\n0,0\n2.9,0\n3.1,0.7\n3.3,0\n6,0\n6,1.5\n6,3\n0,3\n"


def test_corners_and_sampling_of_an_outline(monkeypatch):
    monkeypatch.delenv("GRIDGEN_SYM_QUIET", raising=False)
    Path("notched.csv").write_text("# corners: 0 4 5 7\n" + NOTCHED)
    said = run("grid", "notched.csv", "-f", "winslow", "--size", 24, 12, "-o", "moved.npz")
    assert "corner 2 of 'notched' is moved from point 5" in said
    assert gg.read("moved.npz").xy[-1, -1].tolist() == [6, 3]
    run("grid", "notched.csv", "-f", "winslow", "--size", 24, 12, "--corners", "0 4 6 7", "--sampling", "equal")
    Path("bare.csv").write_text(NOTCHED)
    run("grid", "bare.csv", "-f", "winslow", "--size", 24, 12, "--corners", "auto", "-o", "auto.npz")
    assert gg.read("auto.npz") == gg.read("moved.npz")
    assert "it has no corners" in run("grid", "bare.csv", "-f", "winslow", code=2)
    Path("bare.dat").write_text(NOTCHED[4:].replace(",", " "))
    run("grid", "bare.dat", "-f", "winslow", "--size", 24, 12, "--corners", "auto", "-o", "blanks.npz")
    assert gg.read("blanks.npz") == gg.read("auto.npz")
    assert "--corners is auto, four" in run("grid", "notched.csv", "-f", "winslow", "--corners", "0,4", code=2)
    assert "--corners belongs to an outline" in run("grid", "swan", "-f", "winslow", "--corners", "auto", code=2)
    assert "--sampling belongs to an outline" in run("grid", "moved.npz", "-f", "length", "--sampling", "equal", code=2)


def test_a_certificate_is_told_and_drawn():
    pytest.importorskip("matplotlib")
    Path("notched.csv").write_text("# corners: 0 4 5 7\n" + NOTCHED)
    arguments = ["grid", "notched.csv", "-f", "winslow", "--size", 24, 12, "--corners", "0,4,5,7"]
    said = run(*arguments, "-o", "bad.npz", "--plot", "bad.png", code=1)
    assert said.count("at corner 2, node (24, 12) at (6, 1.5), the boundary turns the wrong way") == 1
    assert Path("bad.png").read_bytes().startswith(b"\x89PNG")
    said = run("quality", "bad.npz", "--plot", "again.png", code=1)
    assert "no valid grid exists: at corner 2" in said
    assert Path("again.png").read_bytes() == Path("bad.png").read_bytes()
    run("grid", "square", "-f", "winslow", "-o", "good.npz")
    assert "no valid grid exists" not in run("quality", "good.npz", "--plot", "good.png")
    assert Path("good.png").is_file()


def test_a_clockwise_grid_file_is_mirrored_unless_that_is_forbidden(monkeypatch):
    monkeypatch.delenv("GRIDGEN_SYM_QUIET", raising=False)
    gg.Grid(gg.domain("swan", 9, 9).xy[::-1]).write("clockwise.npz")
    said = run("grid", "clockwise.npz", "-f", "winslow", "-o", "mended.npz")
    assert "left and right are exchanged" in said
    assert gg.read("mended.npz").xy[0, 0].tolist() == [0, 0]
    assert "the boundary runs clockwise" in run("grid", "clockwise.npz", "-f", "winslow", "--no-reorient", code=1)


# ---- several blocks ----


@pytest.fixture
def two_blocks():
    """Two blocks of the swan with names of boundaries, in a file with a map beside it."""
    whole = gg.domain("swan", 9, 9)
    blocks = [gg.Grid.from_planes(*whole.planes[:, a : a + 5]) for a in (0, 4)]
    layout = gg.MultiBlock(blocks, boundaries={"wall": [(0, "bottom"), (1, "bottom")], "inlet": [(0, "left")]})
    layout.write("two.p2dfmt")
    return layout


def test_several_blocks_are_one_grid(two_blocks):
    said = run("grid", "two.p2dfmt", "-f", "winslow", "-o", "out.vtm", "--plot", "out.png")
    assert "start: two.p2dfmt, 2 blocks, 1 connection, 64 cells, 4 of them folded" in said
    assert "blocks                        2" in said
    assert "wrote out.vtm" in said
    assert Path("out.png").read_bytes().startswith(b"\x89PNG")
    found = gg.read("out.vtm")
    assert found.bonds == two_blocks.bonds
    assert found.boundaries == two_blocks.boundaries
    expected = gg.optimize(gg.domain("swan", 9, 9), "winslow").grid
    assert found.blocks[1].planes == pytest.approx(expected.planes[:, 4:], abs=1e-6)


def test_boundaries_slide_on_the_command_line(two_blocks):
    for text, slide in (("wall,0/left", ["wall", ("0", "left")]), ("all", "all")):
        run("grid", "two.p2dfmt", "-f", "winslow", "--slide", text, "-o", "slid.p2dfmt")
        assert gg.read("slid.p2dfmt").blocks == pytest.approx(
            [gg.Grid(block.xy) for block in gg.optimize(two_blocks, "winslow", slide=slide).grid.blocks]
        )


def test_several_blocks_are_adapted(two_blocks):
    formula = "tanh(9*(x - 0.5))"
    said = run("adapt", "two.p2dfmt", "--to", formula, "--max-iterations", "2", "-o", "adapted.p2dfmt")
    assert "density times area, variation at the start" in said
    found = gg.adapt(two_blocks, formula, max_iterations=2)
    assert gg.read("adapted.p2dfmt").blocks[0].planes == pytest.approx(found.grid.blocks[0].planes, abs=1e-9)


def test_quality_of_several_blocks(two_blocks):
    assert "block 0: not valid" in run("quality", "two.p2dfmt", "--plot", "two.png", code=1)
    told = json.loads(run("quality", "two.p2dfmt", "--json", code=1))
    assert told == gg.quality(two_blocks).as_dict()
    assert (told["folded_cells"], told["blocks"]["1"]["cells"]) == (gg.quality(two_blocks).folded_cells, 32)


def test_the_cut_of_one_block_moves_where_a_layout_is_wanted():
    gg.MultiBlock([ring(np.linspace(0, 2 * np.pi, 9), 1.0, [*np.linspace(2, 3, 8), 2.0], 5)]).write("ring.xyz")
    assert "start: ring.xyz, 8 x 4 cells" in run("grid", "ring.xyz", "-f", "winslow", "-o", "fixed.xyz")
    said = run("grid", "ring.xyz", "-f", "winslow", "--layout", "-o", "free.xyz")
    assert "1 block, 1 connection, 32 cells" in said
    start, fixed, free = (gg.read(f"{name}.xyz").planes[:, 0, 1:-1] for name in ("ring", "fixed", "free"))
    assert np.array_equal(fixed, start)
    assert np.abs(free - start).max() > 1e-3
    assert "blocks                        1" in run("quality", "free.xyz", "--layout")


def test_a_file_as_a_target_may_have_another_angle(two_blocks):
    valid = gg.optimize(two_blocks, "winslow").grid
    valid.write("valid.p2dfmt")
    for target, angle in (("valid.p2dfmt", None), ("valid.p2dfmt, 90", 90)):
        run("grid", "two.p2dfmt", "-f", "winslow", "--target", target, "-o", "out.p2dfmt")
        wanted = {name: gg.Target.of(block, angle) for name, block in zip(valid.names, valid.blocks, strict=True)}
        expected = gg.optimize(two_blocks, "winslow", target=wanted).grid
        assert gg.read("out.p2dfmt").blocks[0].planes == pytest.approx(expected.blocks[0].planes, abs=1e-9)
    assert "the angle 'right' is not a number" in run(
        "grid", "two.p2dfmt", "-f", "winslow", "--target", "valid.p2dfmt, right", code=2
    )


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("grid", "two.p2dfmt", "-f", "winslow", "-o", "out.vts"), "holds one block, and here are 2"),
        (
            ("grid", "two.p2dfmt", "-f", "winslow", "--solver", "euler-lagrange", "--control", "0,0"),
            "does not take 'control'",
        ),
        (("grid", "two.p2dfmt", "-f", "winslow", "--interior-only"), "does not take 'interior_only'"),
        (("grid", "two.p2dfmt", "-f", "quasi_harmonic", "--continuation", "omega=1,0.1"), "came a MultiBlock of 2"),
        (("grid", "two.p2dfmt", "-f", "winslow", "--slide", "outlet"), "unknown boundary 'outlet' in slide"),
        (
            ("grid", "swan", "-f", "winslow", "--layout"),
            "--layout belongs to a grid file or a layout's name, which swan",
        ),
        (("adapt", "two.p2dfmt", "--to", "x", "-o", "out.vts"), "holds one block, and here are 2"),
        (("grid", "back.p2dfmt", "-f", "winslow"), "block 1 of back.p2dfmt runs clockwise"),
    ],
)
def test_what_several_blocks_do_not_take_is_told(two_blocks, arguments, told):
    first, second = two_blocks.blocks
    gg.MultiBlock([first, gg.Grid(second.xy[::-1])], []).write("back.p2dfmt")
    assert told in run(*arguments, code=2)
    assert not Path("out.vts").exists()


TOML = """\
[points]
A = [0.0, 0.0]
B = [1.0, 0.0]
C = [1.0, 1.0]
D = [0.0, 1.0]

[blocks]
only = ["A", "B", "C", "D"]

[cells]
A-B = 4
B-C = 3

[boundaries]
wall = ["A-B"]
"""


def test_layouts_by_name_and_description():
    listed = run("layouts").splitlines()
    assert [line.split()[0] for line in listed] == gg.layout_names()
    assert "start: tee:across=6,width=2, 4 blocks, 3 connections" in run(
        "grid", "tee:across=6,width=2", "-f", "winslow", "-o", "tee.p2dfmt"
    )
    found = gg.read("tee.p2dfmt")
    assert found.boundaries == gg.layout("tee", across=6, width=2.0).boundaries
    assert "annulus, 40 x 40 cells" in run("grid", "annulus", "-f", "winslow", "--max-iterations", 1)
    assert "annulus, 1 block, 1 connection" in run("grid", "annulus", "-f", "winslow", "--layout")
    Path("square.toml").write_text(TOML)
    said = run("grid", "square.toml", "-f", "winslow", "--refine", 2, "-o", "square.vtm")
    assert "1 block, 0 connections, 48 cells" in said
    assert list(gg.read("square.vtm", layout=True).boundaries) == ["wall"]


def test_walls_of_layouts_are_on_boundaries_or_sides():
    Path("square.toml").write_text(TOML)
    for place in ("wall", "only/bottom", "bottom"):
        run("grid", "square.toml", "-f", "winslow", "--refine", 3, "--wall", f"{place}:first=0.01", "-o", "w.vtm")
        assert gg.read("w.vtm").y[2:-2, 1] == pytest.approx(0.01, rel=0.05)


def test_walls_may_stand_in_the_description():
    """An option replaces the wall of the file, and so does a target all of them."""
    Path("walled.toml").write_text(TOML + "[walls]\nwall = { first = 0.01, growth = 1.3 }\n")
    command = "grid", "walled.toml", "-f", "winslow", "--refine", 3, "-o", "w.vtm"
    heights = []
    for more in ((), ("--wall", "wall:first=0.02"), ("--target", "1, 1")):
        run(*command, *more)
        heights.append(gg.read("w.vtm").y[2:-2, 1])
    assert heights[0] == pytest.approx(0.01, rel=0.05)
    assert heights[1] == pytest.approx(0.02, rel=0.05)
    assert heights[2] == pytest.approx(1 / 9, rel=0.05)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("square.toml", "--size", 4, 4), "square.toml has its own numbers of cells and sides: drop --size"),
        (("swan", "--refine", 2), "--refine belongs to a layout in TOML or a mesh, which swan is not"),
        (("tee", "--refine", 2), "--refine belongs to a layout in TOML or a mesh, which tee is not"),
        (("tee:across",), "a parameter of the layout 'tee' is written NAME=VALUE; came 'across'"),
        (("tee:acros=3",), "the layout 'tee' has no parameter 'acros'"),
        (
            ("square.toml", "--wall", "floor:first=1e-2"),
            "floor",
        ),
        (
            ("square.toml", "--wall", "only/bottom:first=1e-2", "--wall", "wall:first=1e-2"),
            "bottom of block only has two walls",
        ),
    ],
)
def test_faults_of_layouts_are_told(arguments, told):
    Path("square.toml").write_text(TOML)
    assert told in run("grid", *arguments, "-f", "winslow", code=2)


@pytest.mark.parametrize("file", ["out.su2", "out.cgns", "out.vts"])
def test_what_a_file_cannot_hold_is_told_before_the_solve(two_blocks, file):
    odd = {("in let" if file == "out.su2" else "i" * 99): [(0, "left")]}
    gg.write(gg.MultiBlock(two_blocks.blocks, boundaries=odd), "two.p2dfmt")
    said = run("grid", "two.p2dfmt", "-f", "winslow", "-o", file, code=2)
    assert "cannot hold" in said or "holds one block" in said
    assert "start" not in said
