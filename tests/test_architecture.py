"""The arrows of the house: who may import whom, no import circle, and what `import gridgen_sym` must not load."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

import gridgen_sym

PACKAGE = Path(gridgen_sym.__file__).parent
FILES = sorted(PACKAGE.rglob("*.py"))
LONGEST_FILE = 500
#: A package imports only what stands before it, but for the packages on the ground, which import only each other.
ORDER = (
    *("functionals", "symbolic", "codegen", "runtime", "backends"),
    *("grids", "geography", "ocean", "outlines", "boundary", "topology", "certificates", "io"),
    *("fields", "layouts", "plotting"),
    *("solvers", "sensitivities", "adaptation", "selfcheck", "paper_examples", "documentation", "cli"),
)
#: They know nothing of functionals and kernels.
GROUND = {"grids", "geography", "ocean", "outlines", "boundary", "topology", "certificates", "io"}
#: The order within a package that has packages of its own.
INNER_ORDER = {
    "symbolic": ("derive", "classify", "report", "paper"),
    "solvers": ("run", "linear", "sliding", "newton", "untangling", "multilevel", "layout", "equations"),
}
#: Modules beside the packages that any package may use, and that use no package themselves.
SHARED = {
    "archives",
    "arrays",
    "atomic",
    "cache",
    "deprecation",
    "errors",
    "later",
    "messages",
    "options",
    "parsing",
    "resources",
    "startup",
    "version",
}
#: The public face and the way into the command line: nothing imports them, and they may import everything.
FACE = {"__init__", "__main__", "jax", "torch"}
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


def imported_parts(tree, path):
    """Yield the names below `gridgen_sym` that a file imports, at any place in it, split at the dots."""
    for name, _ in imported_modules(tree, path):
        parts = name.split(".")
        if parts[0] == "gridgen_sym" and len(parts) > 1:
            yield parts[1:]


def objections(tree, path):
    """Return the packages, shared modules and names of the top that a file must not import and does."""
    package = package_of(path)
    if package is None:
        allowed = {*ORDER, *SHARED} if path.stem in FACE else SHARED
    elif package in GROUND:
        allowed = (GROUND & {*ORDER[: ORDER.index(package) + 1]}) | SHARED
    else:
        allowed = {*ORDER[: ORDER.index(package) + 1]} | SHARED
    return sorted({parts[0] for parts in imported_parts(tree, path)} - allowed)


def inner_objections(tree, path):
    """Return the inner packages that stand after a file's own, and that it imports."""
    parts = path.relative_to(PACKAGE).parts
    order = INNER_ORDER.get(parts[0], ())
    if len(parts) < 3 or parts[1] not in order:
        return []
    later = order[order.index(parts[1]) + 1 :]
    return sorted({name[1] for name in imported_parts(tree, path) if name[0] == parts[0] and name[1] in later})


def parse(path):
    return ast.parse(path.read_text(encoding="utf-8"), str(path))


TREES = {path: parse(path) for path in FILES}


def test_every_package_has_its_place():
    assert {path.parent.name for path in PACKAGE.glob("*/__init__.py")} == {*ORDER}
    assert {path.stem for path in PACKAGE.glob("*.py")} == SHARED | FACE
    for package, inner in INNER_ORDER.items():
        assert {path.parent.name for path in (PACKAGE / package).glob("*/__init__.py")} == {*inner}


def test_the_page_on_the_architecture_has_every_package_in_its_order():
    page = (PACKAGE.parent / "docs" / "explanations" / "architecture.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `(\w+)`( \(ground\))? \|", page, re.MULTILINE)
    assert [name for name, _ in rows] == [*ORDER]
    assert {name for name, ground in rows if ground} == GROUND
    for names in (SHARED, *INNER_ORDER.values()):
        assert all(f"`{name}`" in page for name in names)


def test_packages_import_only_what_stands_to_their_left():
    assert not {file_name(path): found for path, tree in TREES.items() if (found := objections(tree, path))}
    assert not {file_name(path): found for path, tree in TREES.items() if (found := inner_objections(tree, path))}


@pytest.mark.parametrize(
    ("place", "text", "expected"),
    [
        ("symbolic/x.py", "from ..codegen import kernel", ["codegen"]),
        ("functionals/x.py", "def f():\n    from ..symbolic.derive.discrete import J", ["symbolic"]),
        ("grids/x.py", "import gridgen_sym.runtime", ["runtime"]),
        ("grids/x.py", "from ..boundary import Outline", ["boundary"]),
        ("boundary/x.py", "from ..functionals import functional", ["functionals"]),
        ("runtime/x.py", "from gridgen_sym import solvers", ["solvers"]),
        ("runtime/x.py", "from .. import grids", ["grids"]),
        ("solvers/x.py", "def f():\n    from ..cli import main", ["cli"]),
        ("solvers/x.py", "from ..adaptation import adapt", ["adaptation"]),
        ("documentation/x.py", "from ..cli import main", ["cli"]),
        ("codegen/x.py", "from .. import __version__", ["__version__"]),
        ("cli/x.py", "from gridgen_sym import define", ["define"]),
        ("errors.py", "from .grids import Grid", ["grids"]),
        ("adaptation/x.py", "from ..solvers import optimize\nfrom ..grids import Grid", []),
        ("runtime/x.py", "def f():\n    from ..codegen.programs import kernel", []),
        ("solvers/x.py", "from ..grids.grid import Grid\nfrom .run.result import Result", []),
    ],
)
def test_a_wrong_import_is_objected_to(place, text, expected):
    assert objections(ast.parse(text), PACKAGE / place) == expected


@pytest.mark.parametrize(
    ("place", "text", "expected"),
    [
        ("solvers/run/x.py", "from ..untangling.strategies import STRATEGIES", ["untangling"]),
        ("symbolic/derive/x.py", "def f():\n    from ..classify import classify", ["classify"]),
        ("symbolic/paper/x.py", "from ..classify import classify", []),
        ("solvers/optimize.py", "from .untangling.strategies import STRATEGIES", []),
    ],
)
def test_a_wrong_import_within_a_package_is_objected_to(place, text, expected):
    assert inner_objections(ast.parse(text), PACKAGE / place) == expected


def test_back_ends_are_found_by_name_and_not_imported():
    """What is built in is no nearer than what a user adds; the site shows how each of them prints."""
    users = {
        package_of(path)
        for path, tree in TREES.items()
        if ["backends"] in [[*p[:1]] for p in imported_parts(tree, path)]
    }
    assert users - {"backends"} == {"documentation"}


@pytest.mark.parametrize("name", ["c", "numpy"])
def test_what_loads_kernels_loads_no_symbolic_package(name):
    assert not modules_loaded_by(f"import gridgen_sym.backends.{name}.loader") & {*HEAVY}


def module_of(path):
    parts = ("gridgen_sym", *path.relative_to(PACKAGE).with_suffix("").parts)
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imports_between(trees):
    """Return for each module those of ours that it imports at any place, for types too."""
    modules = {module_of(path): path for path in trees}
    found = {}
    for name, path in modules.items():
        wanted = {full for full, _ in imported_modules(trees[path], path)}
        wanted = {full if full in modules else full.rpartition(".")[0] for full in wanted}
        found[name] = sorted((wanted & {*modules}) - {name})
    return found


def circles(imports):
    """Return the files that are left when those that import no file that is left are taken away, again and again."""
    left = dict(imports)
    while ends := [name for name, wanted in left.items() if not {*wanted} & {*left}]:
        for name in ends:
            del left[name]
    return left


def test_there_is_no_import_circle():
    assert not circles(imports_between(TREES))


def test_a_circle_is_found():
    assert circles({"a": ["b"], "b": ["c"], "c": ["a"], "d": ["a"], "e": []}).keys() == {"a", "b", "c", "d"}
    assert not circles({"a": ["b", "c"], "b": ["c"], "c": []})


def test_the_site_imports_nothing_but_the_package_and_is_imported_by_nothing_of_it():
    assert not [path for path, tree in TREES.items() if "derived_pages" in ast.dump(tree)]


LIGHT = [
    path
    for path in FILES
    if package_of(path) in (None, "runtime", "fields", "plotting", "solvers", "adaptation", *sorted(GROUND))
]


def loaded_early(path):
    """Return the packages that a file imports at module level."""
    return {name.split(".")[0] for name, when_loaded in imported_modules(TREES[path], path) if when_loaded}


def test_what_solves_loads_no_symbolic_package():
    assert not {file_name(path) for path in LIGHT if loaded_early(path) & {"sympy", "jinja2"}}


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
    assert not loaded & {*HEAVY, "scipy.sparse", "scipy.spatial", "scipy.interpolate", "http", "email", "asyncio"}
    # Files are loaded for `Grid.write`; all else comes with the first name that is used.
    packages = {name.split(".")[1] for name in loaded if name.startswith("gridgen_sym.")}
    assert packages & {*ORDER} == {"grids", "io"}


@pytest.mark.parametrize(
    "package", ["runtime", "fields", "plotting", "solvers", "adaptation", "functionals", *sorted(GROUND)]
)
def test_packages_that_solve_load_nothing_heavy(package):
    assert not modules_loaded_by(f"import gridgen_sym.{package}") & {*HEAVY}


def test_files_are_short_and_finished():
    texts = {file_name(path): path.read_text(encoding="utf-8") for path in FILES}
    # The paper's equations are a table of data, one entry each.
    short = {name: text for name, text in texts.items() if name != "functionals/paper.py"}
    assert not {name for name, text in short.items() if len(text.splitlines()) > LONGEST_FILE}
    words = ("TO" + "DO", "FIX" + "ME")
    assert not {name for name, text in texts.items() if any(word in text for word in words)}
