"""The arrows of the house: who may import whom, and what must not be loaded by `import gridgen_sym`."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import gridgen_sym

PACKAGE = Path(gridgen_sym.__file__).parent
FILES = sorted(PACKAGE.rglob("*.py"))
LONGEST_FILE = 500
#: Data flows from left to right.
PIPELINE = ("functionals", "symbolic", "codegen", "runtime", "solvers", "adaptation")
#: Grids stand on the ground: they import no other package, and of the pipeline only what moves nodes imports them.
GROUND = "grids"
MOVES_NODES = {"solvers", "adaptation"}
#: What stands on top of everything, and is imported by nothing of it.
TOP = {"cli", "documentation", "paper_examples", "selfcheck"}
EVERY_PACKAGE = {*PIPELINE, GROUND, *TOP}
#: Modules beside the packages that any package may use, and that use no package themselves.
SHARED = {"errors", "messages", "resources", "atomic", "__version__"}
#: What must not be loaded until it is needed.
HEAVY = ("sympy", "jinja2", "matplotlib")


def file_name(path):
    return path.relative_to(PACKAGE).as_posix()


def package_of(path):
    """Return the package that a file belongs to, or None at the top."""
    parts = path.relative_to(PACKAGE).parts
    return parts[0] if len(parts) > 1 else None


def imported_modules(tree, path):
    """Yield (absolute name of an imported module or name, whether it is imported when the file is loaded)."""
    late = {id(inner) for node in ast.walk(tree) if isinstance(node, ast.FunctionDef) for inner in ast.walk(node)}
    late |= {
        id(inner)
        for node in ast.walk(tree)
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test)
        for inner in ast.walk(node)
    }
    here = ("gridgen_sym", *path.relative_to(PACKAGE).parts[:-1])
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = ".".join((*here[: len(here) - node.level + 1], *filter(None, [node.module])))
            base = base if node.level else node.module
            names = [f"{base}.{alias.name}" for alias in node.names]
        else:
            continue
        for name in names:
            yield name, id(node) not in late


def imported_packages(tree, path):
    """Return the packages and shared modules of ours that a file imports, at any place in it."""
    names = (name.split(".") for name, _ in imported_modules(tree, path))
    return {parts[1] for parts in names if parts[0] == "gridgen_sym" and len(parts) > 1}


def objections(tree, path):
    """Return the packages that a file must not import and does."""
    package = package_of(path)
    if package == GROUND:
        allowed = {GROUND}
    elif package in PIPELINE:
        allowed = set(PIPELINE[: PIPELINE.index(package) + 1]) | ({GROUND} if package in MOVES_NODES else set())
    else:
        # The files beside the packages are the public face and the way into the command line.
        allowed = EVERY_PACKAGE
    return sorted(imported_packages(tree, path) & (EVERY_PACKAGE - allowed))


def parse(path):
    return ast.parse(path.read_text(encoding="utf-8"), str(path))


def test_every_package_has_its_place():
    assert {path.parent.name for path in PACKAGE.glob("*/__init__.py")} == EVERY_PACKAGE


@pytest.mark.parametrize("path", FILES, ids=file_name)
def test_packages_import_only_what_stands_to_their_left(path):
    assert not objections(parse(path), path)


@pytest.mark.parametrize("name", sorted(SHARED - {"__version__"}))
def test_shared_modules_import_no_package(name):
    path = PACKAGE / f"{name}.py"
    assert imported_packages(parse(path), path) <= SHARED


@pytest.mark.parametrize(
    ("place", "text", "expected"),
    [
        ("symbolic/x.py", "from ..codegen import kernel", ["codegen"]),
        ("functionals/x.py", "def f():\n    from ..symbolic.discrete import J", ["symbolic"]),
        ("grids/x.py", "import gridgen_sym.runtime", ["runtime"]),
        ("runtime/x.py", "from gridgen_sym import solvers", ["solvers"]),
        ("runtime/x.py", "from .. import grids", ["grids"]),
        ("solvers/x.py", "def f():\n    from ..cli import main", ["cli"]),
        ("solvers/x.py", "from ..adaptation import adapt", ["adaptation"]),
        ("adaptation/x.py", "from ..solvers import optimize\nfrom ..grids import Grid", []),
        ("runtime/x.py", "def f():\n    from ..codegen.programs import kernel", []),
        ("solvers/x.py", "from ..grids.grid import Grid\nfrom .result import Result", []),
    ],
)
def test_a_wrong_import_is_objected_to(place, text, expected):
    assert objections(ast.parse(text), PACKAGE / place) == expected


LIGHT = [path for path in FILES if package_of(path) in (None, "runtime", *MOVES_NODES, GROUND)]


@pytest.mark.parametrize("path", LIGHT, ids=file_name)
def test_what_solves_loads_no_symbolic_package(path):
    early = {name.split(".")[0] for name, when_loaded in imported_modules(parse(path), path) if when_loaded}
    assert not early & {"sympy", "jinja2"}


def modules_loaded_by(statement):
    told = subprocess.run(
        [sys.executable, "-c", f"import sys\n{statement}\nprint(*sys.modules)"],
        capture_output=True,
        text=True,
        check=True,
    )
    return set(told.stdout.split())


def test_import_loads_nothing_heavy():
    loaded = modules_loaded_by("import gridgen_sym")
    assert "gridgen_sym" in loaded
    assert not loaded & {*HEAVY, "scipy.sparse", "scipy.spatial", "scipy.interpolate"}


@pytest.mark.parametrize("package", ["runtime", "grids", "solvers", "adaptation", "functionals"])
def test_packages_that_solve_load_nothing_heavy(package):
    assert not modules_loaded_by(f"import gridgen_sym.{package}") & {*HEAVY}


@pytest.mark.parametrize("path", FILES, ids=file_name)
def test_files_are_short_and_finished(path):
    # The paper's equations are a table of data, one entry each.
    text = path.read_text(encoding="utf-8")
    if path.relative_to(PACKAGE).as_posix() != "functionals/paper.py":
        assert len(text.splitlines()) <= LONGEST_FILE
    words = ("TO" + "DO", "FIX" + "ME")
    assert not [word for word in words if word in text]
