"""Fixtures of several folders of tests."""

from __future__ import annotations

import os

# Before NumPy is loaded. Where other programs have the processors, too, the threads of BLAS wait for each other longer
# than they work: a sparse solver that takes a second then takes a minute.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import pytest
from hypothesis import HealthCheck, settings

if "PYTEST_XDIST_WORKER" in os.environ:
    # Tests that run side by side share the processors: two threads each would wait for each other.
    os.environ.setdefault("OMP_NUM_THREADS", "1")

from support_solvers import BACKENDS

from gridgen_sym.functionals import registry
from gridgen_sym.runtime import find_compiler

# Property-based tests draw the same examples on every machine, and none fails because a machine is busy.
settings.register_profile("steady", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("steady")


@pytest.fixture(autouse=True)
def not_quiet(monkeypatch):
    """Let messages be told, also where the user's environment silences them."""
    monkeypatch.delenv("GRIDGEN_SYM_QUIET", raising=False)


@pytest.fixture(autouse=True)
def clean_registry(monkeypatch):
    """Forget the functionals that a test defines."""
    monkeypatch.setattr(registry, "_registry", dict(registry._registry))


@pytest.fixture
def live_line(monkeypatch):
    """Record what happens to the live line on the terminal: "start", its texts, "stop"."""
    shown = []

    class Status:
        def start(self):
            shown.append("start")

        def update(self, text):
            shown.append(text)

        def stop(self):
            shown.append("stop")

    monkeypatch.setattr("rich.console.Console.status", lambda console, text: Status())
    return shown


@pytest.fixture(params=BACKENDS)
def backend(request: pytest.FixtureRequest) -> str:
    """Each backend in turn; the compiled one where there is a compiler."""
    if request.param == "c" and find_compiler() is None:
        pytest.skip("needs a C compiler")
    return str(request.param)
