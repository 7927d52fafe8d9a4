"""The number of threads for a grid, and how idle threads wait."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from ..messages import report_once

#: Grids with fewer nodes use one thread: starting more would take longer.
_NODES_PER_THREAD = 8192
#: How an OpenMP library is to wait, which it reads when it is loaded: GCC's for so many turns of a loop, then asleep.
_WAITING = {"OMP_WAIT_POLICY": "passive", "GOMP_SPINCOUNT": "10000"}
_COUNT = re.compile("0*[1-9][0-9]{0,8}")


@dataclass(slots=True)
class _Team:
    """The state of OpenMP's threads: a forked process has none of its parent's, and would wait for them forever.

    Attributes:
        started: whether more than one thread has been asked for in this process.
        lost: whether this process was forked from one that had started some.
    """

    started: bool = False
    lost: bool = False

    def note_fork(self) -> None:
        """Record, in a child process, that the threads are lost."""
        self.lost |= self.started


_team = _Team()
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_team.note_fork)


def thread_count() -> int:
    """Return the number of threads for large grids: OMP_NUM_THREADS, else the processors that may be used."""
    processors = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    text = os.environ.get("OMP_NUM_THREADS", "").strip()
    wanted = text.partition(",")[0].strip()
    if _COUNT.fullmatch(wanted):
        return int(wanted)
    if text:
        report_once(
            f"OMP_NUM_THREADS is {text[:60]!r}, which does not begin with a whole number from 1 on: "
            f"all {processors} processors are used"
        )
    return processors


def threads_for(nodes: int) -> int:
    """Return the number of threads for a grid of so many nodes.

    It is one in a process that was forked (by `multiprocessing`, say) from one that had used more.
    """
    most = nodes // _NODES_PER_THREAD
    if most <= 1:
        return 1
    count = min(thread_count(), most)
    if count > 1 and _team.lost:
        report_once(
            "this process was forked from one that had used several threads, so it uses one: let multiprocessing "
            "start processes by 'spawn' or 'forkserver' to use more"
        )
        return 1
    _team.started |= count > 1
    return count


@contextmanager
def threads_that_sleep() -> Iterator[None]:
    """Let an OpenMP library that is loaded here put waiting threads to sleep, unless the user has chosen otherwise.

    By default they spin. Where other programs use the processors, too, they then delay the thread that they wait
    for.
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
