"""Threads that wait: asleep unless the user says otherwise, and nothing of it stays in the environment."""

from __future__ import annotations

import ctypes
import os
import subprocess
import sys

import pytest

from gridgen_sym.runtime import find_compiler
from gridgen_sym.runtime.threads import threads_that_sleep

_PROGRAM = """
import os
import gridgen_sym as gg
before = dict(os.environ)
assert gg.optimize(gg.domain("wavy", 9, 9), "winslow").converged
assert dict(os.environ) == before
"""


def displayed(**variables):
    """What the OpenMP library tells of its settings when kernels are loaded."""
    clean = {name: value for name, value in os.environ.items() if name not in ("OMP_WAIT_POLICY", "GOMP_SPINCOUNT")}
    told = subprocess.run(
        [sys.executable, "-c", _PROGRAM],
        env={**clean, "OMP_DISPLAY_ENV": "verbose", "GRIDGEN_SYM_BACKEND": "c", **variables},
        capture_output=True,
        text=True,
        check=True,
    )
    return told.stderr


@pytest.mark.skipif(find_compiler() is None, reason="there is no C compiler")
def test_threads_that_wait_are_put_to_sleep_unless_the_user_objects():
    if "GOMP_SPINCOUNT" not in displayed():
        pytest.skip("the OpenMP library is not GCC's")
    assert "OMP_WAIT_POLICY = 'PASSIVE'" in displayed()
    assert "GOMP_SPINCOUNT = '10000'" in displayed()
    assert "OMP_WAIT_POLICY = 'ACTIVE'" in displayed(OMP_WAIT_POLICY="active")
    assert "GOMP_SPINCOUNT = '77'" in displayed(GOMP_SPINCOUNT="77")


def test_nothing_stays_in_the_environment(monkeypatch):
    monkeypatch.delenv("OMP_WAIT_POLICY", raising=False)
    monkeypatch.delenv("GOMP_SPINCOUNT", raising=False)
    with threads_that_sleep():
        assert os.environ["OMP_WAIT_POLICY"] == "passive"
    assert "OMP_WAIT_POLICY" not in os.environ
    with pytest.raises(OSError, match="no library"), threads_that_sleep():
        ctypes.CDLL("no library")
    assert "OMP_WAIT_POLICY" not in os.environ
    monkeypatch.setenv("OMP_WAIT_POLICY", "active")
    with threads_that_sleep():
        assert os.environ["OMP_WAIT_POLICY"] == "active"
        assert "GOMP_SPINCOUNT" not in os.environ
    assert os.environ["OMP_WAIT_POLICY"] == "active"
