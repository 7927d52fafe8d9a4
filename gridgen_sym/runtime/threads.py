"""How many threads work on a grid, and how those wait that have nothing to do."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

#: Grids with fewer nodes are worked on by one thread: starting more would take longer.
_NODES_PER_THREAD = 8192
#: How an OpenMP library is told to wait, at the time when it is loaded: GCC's for so many turns of a loop, then asleep.
_WAITING = {"OMP_WAIT_POLICY": "passive", "GOMP_SPINCOUNT": "10000"}


def thread_count() -> int:
    """Return the number of threads for large grids: OMP_NUM_THREADS, else the processors that may be used."""
    wanted = os.environ.get("OMP_NUM_THREADS", "").partition(",")[0].strip()
    if wanted.isdigit() and int(wanted) > 0:
        return int(wanted)
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def threads_for(nodes: int) -> int:
    """Return the number of threads for a grid of so many nodes."""
    return max(1, min(thread_count(), nodes // _NODES_PER_THREAD))


@contextmanager
def threads_that_sleep() -> Iterator[None]:
    """Let an OpenMP library that is loaded here put threads that wait for long to sleep, if the user does not object.

    By default they go on asking whether they may go on. Where other programs have the processors, too, they then hold
    up the very thread that they wait for.
    """
    if any(name in os.environ for name in _WAITING):
        yield
        return
    os.environ.update(_WAITING)
    try:
        yield
    finally:
        for name in _WAITING:
            os.environ.pop(name, None)
