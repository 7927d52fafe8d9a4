"""The tasks of a developer: `nox -s check`, `test`, `docs`, `generate`, `bench`; `nox -l` lists them all.

With `--no-venv` a session uses the active environment as it is and installs nothing.
"""

import tempfile

import nox

nox.options.default_venv_backend = "venv"
nox.options.sessions = ["check", "test"]
nox.options.error_on_missing_interpreters = False

#: A quick choice that reaches every dependency: formulas, kernels, solvers, files, pictures, the command line.
COMPATIBILITY = (
    "tests/test_public_names.py",
    "tests/codegen/test_printers.py",
    "tests/runtime/test_backends_agree.py",
    "tests/solvers/test_optimize.py",
    "tests/solvers/test_layouts.py",
    "tests/topology/test_multiblock.py",
    "tests/io/test_files.py",
    "tests/io/test_registry.py",
    "tests/io/test_cgns.py",
    "tests/plotting/test_grids.py",
)

#: What SymPy derives and classifies, each kind of it once.
DERIVATIONS = (
    "tests/symbolic/test_corner_model.py",
    "tests/symbolic/test_continuous.py",
    "tests/symbolic/test_fields.py",
    "tests/symbolic/test_field_equations.py",
)

#: Other people's readers of grid files; only the tests use them.
INDEPENDENT_READERS = ("gmsh", "vtk", "pyCGNS", "xgcm")
#: Drives Chromium (Debian's packages chromium and chromium-driver), where there is one.
BROWSER = "selenium>=4.20"


def install(session: nox.Session, *arguments: str) -> None:
    """Install into the session's own environment; with `--no-venv` leave the active one alone."""
    if session.virtualenv.venv_backend != "none":
        session.install(*arguments)


@nox.session
def check(session: nox.Session) -> None:
    """Style, types, generated files and the paper's equations."""
    install(session, "-e", ".[dev,plot]")
    session.run("ruff", "check", ".")
    session.run("ruff", "format", "--check", ".")
    session.run("mypy")
    with tempfile.TemporaryDirectory() as empty:  # So that everything is derived now.
        session.run("gridgen-sym", "generate", "--check", env={"GRIDGEN_SYM_CACHE": empty})
    session.run("gridgen-sym", "verify")


@nox.session
def test(session: nox.Session) -> None:
    """The main tier of the tests; `nox -s test -- -m slow` runs the slow tier."""
    install(session, "-e", ".[dev]")
    session.run("pytest", "-n", "auto", *session.posargs)


@nox.session(python="3.11")
def oldest(session: nox.Session) -> None:
    """A choice of tests with the oldest versions that pyproject.toml allows."""
    install(session, "-c", ".ci/oldest.txt", "-e", ".[test]")
    # Old releases warn of newer ones of the packages that they use themselves.
    warnings = ("-W", "ignore::DeprecationWarning")
    # An older SymPy may derive otherwise; the newest one is that of the main tier.
    session.run("pytest", "-n", "auto", *warnings, *COMPATIBILITY, *DERIVATIONS, *session.posargs)


@nox.session(python=["3.12", "3.13"])
def newest(session: nox.Session) -> None:
    """The same choice of tests with the newest releases, on the newest Python."""
    install(session, "--upgrade", "--upgrade-strategy", "eager", "-e", ".[test]")
    session.run("pytest", "-n", "auto", *COMPATIBILITY, "tests/symbolic/test_corner_model.py", *session.posargs)


@nox.session
def extras(session: nox.Session) -> None:
    """The tests that need more packages: those of the other extras, and programs that read what we write."""
    install(session, "-c", ".ci/extras.txt", "-e", ".[test,geo,ocean,jax,torch]", *INDEPENDENT_READERS, BROWSER)
    session.run("pytest", "-n", "auto", "-m", "extras", *session.posargs)


@nox.session
def docs(session: nox.Session) -> None:
    """Build the site; warnings are errors."""
    install(session, "-e", ".[docs]")
    session.run("python", "-m", "sphinx", "-W", "--keep-going", "-b", "html", "docs", "docs/_build/html")


@nox.session
def generate(session: nox.Session) -> None:
    """Write `generated/` from the formulas and the templates."""
    install(session, "-e", ".[dev]")
    session.run("gridgen-sym", "generate")


@nox.session
def bench(session: nox.Session) -> None:
    """Measure quickly, and write docs/benchmarks.md."""
    install(session, "-e", ".[plot]", "numba", "mfem")
    session.run("python", "benchmarks/run.py", *(session.posargs or ["--quick"]))
