"""Run a program to its end, within a time, and leave nothing of it behind."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess


def run(command: list[str], seconds: float) -> subprocess.CompletedProcess[str] | None:
    """Run a program to its end; None if it cannot be started, or does not end in time.

    Whatever ends the wait, Ctrl-C too, ends the program with all that it has started: a compiler is a driver, whose
    parts would hold its pipes open.
    """
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
        return None
    with process:
        try:
            out, err = process.communicate(timeout=seconds)
        except subprocess.TimeoutExpired:
            _kill(process)
            return None
        except BaseException:
            _kill(process)
            raise
    return subprocess.CompletedProcess(command, process.returncode, out, err)


def _kill(process: subprocess.Popen[str]) -> None:
    with contextlib.suppress(OSError):
        os.killpg(process.pid, signal.SIGKILL)
