"""Long calls into compiled libraries run in another thread, so that Ctrl-C does not wait for their end."""

from __future__ import annotations

import os
import signal
import threading

import numpy as np
import pytest

import gridgen_sym as gg
from gridgen_sym.runtime.process import interruptible


@pytest.mark.skipif(os.name != "posix", reason="needs POSIX signals")
def test_an_interrupt_ends_the_wait_and_not_the_work():
    released, ended = threading.Event(), threading.Event()

    def work():
        signal.pthread_kill(threading.main_thread().ident, signal.SIGINT)
        released.wait(60)
        ended.set()

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            interruptible(work)
        assert not ended.is_set()
    finally:
        signal.signal(signal.SIGINT, before)
        released.set()
    assert ended.wait(60)


def test_values_and_errors_come_through():
    assert interruptible(lambda: 3) == 3
    with pytest.raises(ZeroDivisionError):
        interruptible(lambda: 1 / 0)


def test_points_are_triangulated_so(monkeypatch):
    from scipy import spatial

    threads, original = [], spatial.Delaunay

    def delaunay(points):
        threads.append(threading.current_thread())
        return original(points)

    monkeypatch.setattr(spatial, "Delaunay", delaunay)
    points = np.random.default_rng(0).random((50, 2))
    field = gg.scattered_field(points, points[:, 0], outside="nearest")
    assert field(np.array([0.5]), np.array([0.5]))[0] == pytest.approx(0.5)
    assert len(threads) == 1
    assert threads[0] is not threading.main_thread()
