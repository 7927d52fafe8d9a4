"""Run a program with a time limit, and end all processes that it has started; wait so that Ctrl-C ends the wait."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextvars import ContextVar
from typing import TypeVar

_Made = TypeVar("_Made")

#: Returns the seconds that are left to whoever needs a program, and raises when there are none.
_seconds_left: ContextVar[Callable[[], float]] = ContextVar("_seconds_left", default=lambda: float("inf"))


@contextlib.contextmanager
def time_limited(seconds_left: Callable[[], float]) -> Iterator[None]:
    """Limit the time of compilations within the context.

    Args:
        seconds_left: returns the seconds that are left; what it raises when the time is over ends the compilation.
    """
    token = _seconds_left.set(seconds_left)
    try:
        yield
    finally:
        _seconds_left.reset(token)


def seconds_left() -> float:
    """Return the seconds that the context allows; raises what the context does when the time is over."""
    return _seconds_left.get()()


def interruptible(work: Callable[[], _Made]) -> _Made:
    """Return what a function makes in another thread; Ctrl-C does not wait for its end.

    For long calls into compiled libraries: Python answers Ctrl-C between its own instructions only. What has been
    interrupted goes on unseen until it ends, or the process does.
    """
    made: Future[_Made] = Future()

    def make() -> None:
        try:
            made.set_result(work())
        except BaseException as error:
            made.set_exception(error)

    threading.Thread(target=make, daemon=True).start()
    return made.result()


def run(command: list[str], seconds: float) -> subprocess.CompletedProcess[str] | None:
    """Run a program to its end; None if it cannot be started, or does not end in time.

    Whatever ends the wait, Ctrl-C too, ends the program with all that it has started: a compiler is a driver, whose
    parts would hold its pipes open.
    """
    interrupt = _HeldInterrupt()  # Until it is known what there is to end.
    try:
        process = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            errors="replace",
            start_new_session=True,
        )
    except OSError:
        interrupt.release()
        return None
    with process:
        try:
            interrupt.release()
            out, err = process.communicate(timeout=seconds)
        except subprocess.TimeoutExpired:
            _kill(process)
            return None
        except BaseException:
            _kill(process)
            raise
    return subprocess.CompletedProcess(command, process.returncode, out, err)


class _HeldInterrupt:
    """Ctrl-C, deferred in the main thread, which receives it, until it is released."""

    def __init__(self) -> None:
        """Hold it back from now on."""
        self._came, self._handler = False, signal.getsignal(signal.SIGINT)
        self._holds = callable(self._handler) and threading.current_thread() is threading.main_thread()
        if self._holds:
            signal.signal(signal.SIGINT, self._note)

    def _note(self, *_: object) -> None:
        self._came = True

    def release(self) -> None:
        """Let it through, now if it was deferred."""
        if self._holds:
            signal.signal(signal.SIGINT, self._handler)
        if self._came:
            signal.raise_signal(signal.SIGINT)


def _kill(process: subprocess.Popen[str]) -> None:
    with contextlib.suppress(OSError):
        os.killpg(process.pid, signal.SIGKILL)
