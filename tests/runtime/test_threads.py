"""Threads that wait: asleep unless the user says otherwise, and nothing of it stays in the environment."""

from __future__ import annotations

import ctypes
import os
import subprocess
import sys

import pytest

from gridgen_sym import messages
from gridgen_sym.runtime import find_compiler, thread_count, threads_for
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


@pytest.mark.slow
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


@pytest.mark.parametrize("wanted", ["²", "0", "-2", "many", "1_0", "", "9" * 5000, "1.5"])
def test_a_number_of_threads_that_is_none_is_told_and_all_processors_are_used(wanted, monkeypatch, capsys):
    monkeypatch.setattr(messages, "_reported", set())
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    processors = thread_count()
    monkeypatch.setenv("OMP_NUM_THREADS", wanted)
    assert thread_count() == processors
    told = capsys.readouterr().err
    assert ("OMP_NUM_THREADS is" in told) == bool(wanted)
    assert len(told) < 250


@pytest.mark.parametrize(("wanted", "count"), [("3", 3), (" 4,2", 4), ("007", 7)])
def test_a_number_of_threads(wanted, count, monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", wanted)
    assert thread_count() == count
    assert [threads_for(nodes) for nodes in (1, 16383, 16384, 10**7)] == [1, 1, 2, count]


_FORKED = """
import multiprocessing as mp
import gridgen_sym as gg

def energy(_):
    return gg.energy(gg.domain("wavy", 161, 161), "winslow")

if __name__ == "__main__":
    before = energy(0) if {first} else 0.0
    with mp.get_context("fork").Pool(1) as pool:
        told = pool.map_async(energy, range(2)).get(timeout=50)
    print(before, *told)
"""


@pytest.mark.skipif(find_compiler() is None or not hasattr(os, "fork"), reason="needs a C compiler and fork")
@pytest.mark.parametrize("first", [True, False])
def test_a_process_forked_from_one_that_used_threads_uses_one_and_does_not_hang(first):
    """OpenMP's threads are not in the child, which would wait for them for ever."""
    environment = os.environ | {"OMP_NUM_THREADS": "2", "GRIDGEN_SYM_BACKEND": "c"}
    environment.pop("GRIDGEN_SYM_QUIET", None)
    told = subprocess.run(
        [sys.executable, "-c", _FORKED.format(first=first)],
        env=environment, capture_output=True, text=True, check=True, timeout=100,
    )  # fmt: skip
    before, *after = map(float, told.stdout.split())
    assert after[0] == after[1] > 0
    if first:
        assert after[0] == pytest.approx(before, rel=1e-14)
    # Where nothing was started before, the child has threads of its own.
    assert told.stderr.count("so it uses one") == first
