"""What is derived is kept, and made again when anything that it depends on changes, or when it is damaged."""

from __future__ import annotations

import os
import resource
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import gridgen_sym
from gridgen_sym import cache as cache_module
from gridgen_sym.codegen import derivations, kept_texts
from gridgen_sym.codegen.backend import find_backend
from gridgen_sym.codegen.kept_texts import definition_files, generator_files, kept, key_of_files, report_files
from gridgen_sym.codegen.render import render_document
from gridgen_sym.functionals import define, functional
from gridgen_sym.functionals.definition import Functional
from gridgen_sym.resources import resource_folder

ROOT = Path(gridgen_sym.__file__).parents[1]
#: Modules that are loaded where something is derived, and that have no part in what is derived.
WITHOUT_INFLUENCE = {"arrays", "atomic", "cache", "errors", "later", "messages", "parsing", "resources", "startup"}


@pytest.fixture(autouse=True)
def cache(monkeypatch, tmp_path):
    """Start with an empty cache."""
    monkeypatch.setenv("GRIDGEN_SYM_CACHE", str(tmp_path / "cache"))
    for memory in (cache_module.cache_folder, kept_texts._builtin_keys):
        memory.cache_clear()
    yield tmp_path / "cache"
    for memory in (cache_module.cache_folder, kept_texts._builtin_keys):
        memory.cache_clear()


def text_of(definition, part="report"):
    """Return what is kept of a definition, and how often it was made for that."""
    made = []
    path = kept(definition, part, ".txt", lambda: made.append(1) or f"{len(made)} times")
    return path.read_text(), len(made)


# ---- the key ----


def test_what_is_kept_is_not_made_again():
    mine = Functional("mine", "g11 + 2*g22")
    assert [text_of(mine)[1] for _ in range(3)] == [1, 0, 0]
    # Another object of the same definition, as in another process.
    assert text_of(Functional("mine", "g11 + 2*g22"))[1] == 0
    assert text_of(Functional("mine", lambda m: m.g11 + 2 * m.g22))[1] == 0


@pytest.mark.parametrize(
    "changed",
    [
        {"density": "(g11 + k*g22)/J"},
        {"corner_factor": 2},
        {"parameters": {"k": -1.0}},  # The barrier and the type are those at the defaults.
        {"constraints": ("k > 0",)},  # Polyconvexity is decided for what they allow.
        {"description": "Other words."},
        {"name": "other"},
    ],
    ids=lambda changed: next(iter(changed)),
)
def test_every_part_of_a_definition_counts(changed):
    same = {"name": "mine", "density": "(g11 + 2*k*g22)/J", "parameters": {"k": 1.0}}
    text_of(Functional(**same))
    assert text_of(Functional(**(same | changed)))[1] == 1
    assert text_of(Functional(**same))[1] == 0


def test_what_it_is_and_what_prints_it_count():
    mine = Functional("mine", "g11 + 2*g22")
    text_of(mine)
    assert text_of(mine, "summary")[1] == 1
    made = []
    kept(mine, "report", ".txt", lambda: made.append(1) or "", printer="another")
    assert made


def test_releases_of_packages_count(monkeypatch):
    before = kept_texts._versions()
    kept_texts._versions.cache_clear()
    monkeypatch.setattr(kept_texts, "version", lambda package: "99" if package == "sympy" else "1")
    try:
        assert kept_texts._versions() not in (before, "")
        assert "99" in kept_texts._versions()
    finally:
        kept_texts._versions.cache_clear()


def test_files_count_and_what_is_newer_than_the_process_is_not_trusted(tmp_path, monkeypatch):
    """A file that has been edited since may not be what runs here: the next process must not find what it gives."""
    file, keys = tmp_path / "one.py", []
    for text, date in (("a = 1", 0), ("a = 2", 0), ("a = 2", None)):
        file.write_text(text)
        if date is not None:
            os.utime(file, (date, date))
        keys.append(key_of_files([file]))
    assert len(set(keys)) == 3
    assert key_of_files([file]) == keys[2]
    monkeypatch.setattr(kept_texts, "key_of_process", lambda: "another process")
    assert key_of_files([file]) != keys[2]


def test_nothing_that_derives_reads_files_that_the_key_leaves_out():
    folders = [ROOT / "gridgen_sym" / name for name in (*kept_texts._GENERATOR, "backends", "documentation")]
    files = {path for folder in folders for path in folder.rglob("*") if path.is_file()}
    # One is compiled beside the kernels, and printed by nobody.
    others = {path.name for path in files if path.parent.name != "__pycache__" and path.suffix != ".py"}
    assert others == {"each_block.c"}


@pytest.mark.slow
def test_every_module_that_derives_is_part_of_the_key():
    """A module that is loaded on the way and forgotten in the key would let an old derivation pass for a new one."""
    script = """
import sys
from gridgen_sym.codegen.backend import find_backend
from gridgen_sym.codegen import derivations
from gridgen_sym.functionals import functional
length = functional("length")
derivations.report_text(length)
print(*(module.__file__ for name, module in sys.modules.items() if name.startswith("gridgen_sym.")))
derivations.report_latex(length), derivations.summary(length)
for name in ("c", "numpy"):
    derivations.kernel_files(length, "frozen", find_backend(name))
print(*(module.__file__ for name, module in sys.modules.items() if name.startswith("gridgen_sym.")))
"""
    told = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True, cwd=ROOT)
    reporting, loaded = (
        {Path(file).relative_to(ROOT / "gridgen_sym").as_posix() for file in line.split()}
        for line in told.stdout.splitlines()
    )
    report = {path.relative_to(ROOT / "gridgen_sym").as_posix() for path in report_files()}
    assert {file for file in loaded if file.split("/")[0] in ("functionals", "symbolic")} <= report
    keeping = {"__init__", "backend", "derivations", "facts", "kept_texts", "source", "version"}
    assert {file for file in reporting if file.startswith("codegen/")} <= {f"codegen/{name}.py" for name in keeping}
    known = {
        path.relative_to(ROOT / "gridgen_sym").as_posix() for path in generator_files() if "templates" not in path.parts
    }
    # Back ends have keys of their own; files are loaded for `Grid.write`, with every name of the package.
    other = {file for file in loaded - known if file.split("/")[0] not in ("backends", "grids", "io")}
    assert other - {f"{name}.py" for name in WITHOUT_INFLUENCE} == {
        path.relative_to(ROOT / "gridgen_sym").as_posix() for path in definition_files()
    }
    templates = {path for path in resource_folder("templates").rglob("*.jinja")}
    assert templates <= set(generator_files())


# ---- the files ----


def test_a_damaged_text_is_made_again(cache):
    mine = Functional("mine", "g11 + 2*g22")
    text_of(mine)
    (file,) = (cache / "sources").glob("mine-*.txt")
    file.write_text("half")
    assert text_of(mine) == ("1 times", 1)
    assert text_of(mine) == ("1 times", 0)


def test_reports_kernels_and_lists_are_derived_once(monkeypatch, capsys):
    mine = define("mine", "g11 + 2*g22", description="Odd.")
    backends = [find_backend(name) for name in ("c", "numpy")]

    def everything():
        kernels = [
            path.read_text() for backend in backends for path in derivations.kernel_files(mine, "plain", backend)
        ]
        return kernels, derivations.report_text(mine), derivations.report_latex(mine), derivations.summary(mine)

    first = everything()
    assert capsys.readouterr().err.count("deriving the kernels of mine (plain)") == 1
    assert "Odd." in first[1]
    assert first[3].equations == ("linear", "uncoupled", "elliptic")
    derivations._kernel.cache_clear()
    monkeypatch.setattr(Functional, "expression", None)  # Nothing can be derived from now on.
    assert everything() == first


def test_committed_equations_are_printed_unless_they_may_be_outdated(monkeypatch, tmp_path):
    generated, length = tmp_path / "generated", functional("length")
    (generated / "docs").mkdir(parents=True)
    (generated / "docs" / "length.md").write_text(render_document(length, "committed\n").text)
    monkeypatch.setattr(derivations, "resource_folder", lambda _: generated)
    monkeypatch.setattr(derivations, "report_text", lambda _: "derived now")
    monkeypatch.setattr(derivations, "is_checkout", lambda: False)  # Nothing changes after a wheel was built.
    assert derivations.known_report(length) == "committed\n"
    assert derivations.known_report(Functional("length", "g11**4 + J**2")) == "derived now"
    monkeypatch.setattr(derivations, "is_checkout", lambda: True)
    assert derivations.known_report(length) == "derived now"
    monkeypatch.setattr(derivations, "is_newer", lambda _: False)
    (generated / "derived_from.txt").write_text(derivations.state().text)
    assert derivations.known_report(length) == "committed\n"
    with monkeypatch.context() as patch:  # As if one file had changed.
        files = derivations.report_files()
        patch.setattr(derivations, "report_files", lambda: files[1:])
        assert derivations.known_report(length) == "derived now"
    monkeypatch.setattr(derivations, "is_newer", lambda _: True)
    assert derivations.state() is None
    assert derivations.known_report(length) == "derived now"


def test_what_is_not_used_for_long_is_removed(cache):
    used, unused = Functional("used", "g11 + 2*g22"), Functional("unused", "g11 + 3*g22")
    text_of(used), text_of(unused)
    (cache / "sources" / "notes-of-somebody.txt").write_text("mine")
    for file in (cache / "sources").iterdir():
        os.utime(file, (0, 0))
    assert text_of(used)[1] == 0  # Reading it counts as a use.
    text_of(Functional("new", "g11 + 4*g22"))
    assert {file.name.partition("-")[0] for file in (cache / "sources").iterdir()} == {"used", "new", "notes"}


# ---- the command line ----


def program(*arguments, folder=None, cache):
    """Run the command line, and return what it printed, what it told, and the processor time that it took."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    environment = os.environ | {"GRIDGEN_SYM_CACHE": str(cache), "PYTHONPATH": str(folder or ROOT)}
    environment.pop("GRIDGEN_SYM_QUIET", None)
    environment["PYTHONDONTWRITEBYTECODE"] = "1"  # A file that is edited within a second may keep its date and size.
    told = subprocess.run(
        [sys.executable, "-X", "importtime", "-m", "gridgen_sym", *arguments],
        capture_output=True,
        text=True,
        check=True,
        env=environment,
        cwd=folder or ROOT,  # Which stands before PYTHONPATH.
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return told.stdout, told.stderr, after.ru_utime - before.ru_utime


@pytest.mark.parametrize(
    "command",
    [
        "derive length --latex",
        pytest.param("derive winslow", marks=pytest.mark.slow),
        pytest.param("functionals", marks=pytest.mark.slow),
    ],
)
def test_what_is_kept_is_printed_without_sympy(command, cache):
    first, _, _ = program(*command.split(), cache=cache)
    again, told, seconds = program(*command.split(), cache=cache)
    assert again == first != ""
    assert "sympy" not in told
    assert seconds < 1


@pytest.mark.slow
def test_generate_derives_only_what_has_changed(tmp_path, cache):
    clone = tmp_path / "clone"
    for part in ("gridgen_sym", "templates", "generated"):
        shutil.copytree(ROOT / part, clone / part, ignore=shutil.ignore_patterns("__pycache__", "mathjax"))
    library = clone / "gridgen_sym" / "functionals" / "library.py"
    parts = library.read_text(encoding="utf-8").split("\n\n\n@builtin(")
    text = "\n\n\n@builtin(".join([parts[0], *parts[2:4]]).rstrip() + "\n"  # Length and orthogonality.
    (library.parent / "adaptive.py").write_text("")

    def generate(text, *arguments):
        library.write_text(text, encoding="utf-8")
        printed, told, seconds = program("generate", *arguments, folder=clone, cache=cache)
        return printed, {line.split()[-3] for line in told.splitlines() if "deriving the kernels" in line}, seconds

    assert generate(text)[1] == {"length", "orthogonality"}
    printed, derived, seconds = generate(text)
    assert (printed, derived) == ("0 files changed\n", set())
    assert seconds < 3
    printed, derived, _ = generate(text.replace("return m.g12**2 / 2", "return m.g12**2 / 3"))
    assert derived == {"orthogonality"}
    assert {line.rpartition("/")[2] for line in printed.splitlines()[:-1]} == {
        *(f"orthogonality.{suffix}" for suffix in ("c", "py", "json", "md")),
        "derived_from.txt",
    }
    assert generate(text)[1] == set()
