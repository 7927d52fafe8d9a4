"""Compile generated C with the system's compiler, once per source, command, compiler and processor."""

from __future__ import annotations

import contextlib
import ctypes
import os
import platform
import shutil
import signal
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from ..errors import GridgenError
from ..messages import say, say_once
from . import cache
from .threads import threads_that_sleep

#: No -ffast-math: a fold and a NaN must stay visible.
FLAGS = (
    "-std=c99", "-O3", "-march=native", "-ffp-contract=fast", "-fno-math-errno", "-fno-trapping-math",
    "-fPIC", "-shared", "-fvisibility=hidden",
)  # fmt: skip
_OPENMP_TRIAL = "#include <omp.h>\nint trial(void) { return omp_get_max_threads(); }\n"
_COMPILE_SECONDS, _VERSION_SECONDS = 300, 30
_WITHOUT = "GRIDGEN_SYM_BACKEND=numpy works without a compiler."


@dataclass(frozen=True, slots=True)
class Compiler:
    """A C compiler that has been found.

    Attributes:
        path: the program.
        version: first line of what it says of itself.
        openmp: whether it can compile and link OpenMP.
    """

    path: str
    version: str
    openmp: bool

    def command(self, source: Path, library: Path) -> list[str]:
        """Return the command that compiles one source file to a shared library."""
        parallel = ("-fopenmp",) if self.openmp else ("-Wno-unknown-pragmas",)
        return [self.path, *FLAGS, *parallel, "-o", str(library), str(source), "-lm"]


@lru_cache(maxsize=1)
def find_compiler() -> Compiler | None:
    """Return the C compiler named by CC, or cc, gcc or clang; None where there is none."""
    named = os.environ.get("CC", "").split()
    if named and not shutil.which(named[0]):
        say_once(f"CC names {named[0]!r}, which is not found: cc, gcc and clang are tried instead")
    for candidate in (*named[:1], "cc", "gcc", "clang"):
        path = shutil.which(candidate)
        if path and (version := _version(path)):
            return Compiler(path, version, _supports_openmp(path, version))
    return None


def _version(path: str) -> str:
    told = _run([path, "--version"], _VERSION_SECONDS)
    return told.stdout.splitlines()[0] if told and told.returncode == 0 and told.stdout else ""


def _supports_openmp(path: str, version: str) -> bool:
    """Try OpenMP once per compiler; the answer is kept in the cache."""
    stem = f"openmp-{cache.digest(path, version)}"
    answer = cache.find(stem, "")
    if answer is None:
        told = _openmp_trial(path)
        if told is None or told.returncode < 0:
            return False  # It was killed, or did not end: no answer.
        answer = cache.keep(stem, "", b"no" if told.returncode else b"yes")
    return answer.read_bytes() == b"yes"


def _openmp_trial(path: str) -> subprocess.CompletedProcess[str] | None:
    with contextlib.suppress(OSError), tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "trial.c"
        source.write_text(_OPENMP_TRIAL)
        command = [path, "-fopenmp", "-fPIC", "-shared", "-o", str(Path(folder) / "trial.so"), str(source)]
        return _run(command, _COMPILE_SECONDS)
    return None


def open_library(name: str, source: str, part: str = "") -> ctypes.CDLL:
    """Load the shared library of a C source, which is compiled now or found in the cache.

    Args:
        name: of the file, and what the user is told to wait for.
        source: the C source.
        part: what part of it this is, for the user.

    Raises:
        GridgenError: as for `compile_library`; or if the system does not let the library be loaded.
    """
    library = compile_library(name, source, part)
    try:
        with threads_that_sleep():
            return ctypes.CDLL(str(library))
    except OSError as error:
        raise GridgenError(
            f"the compiled kernels of {name} cannot be loaded ({error}): set GRIDGEN_SYM_CACHE to a folder from which "
            "programs may run, or use the NumPy backend with GRIDGEN_SYM_BACKEND=numpy"
        ) from error


def compile_library(name: str, source: str, part: str = "") -> Path:
    """Return the shared library of a C source, compiled now or found in the cache; arguments as for `open_library`.

    Raises:
        GridgenError: if there is no compiler, or if it rejects the source, with its messages, or is killed.
    """
    compiler = find_compiler()
    if compiler is None:
        raise GridgenError("no C compiler was found: install one (cc, gcc or clang), set CC, or use the NumPy backend")
    placeholder = compiler.command(Path("source.c"), Path("library"))
    stem = f"{name}-{cache.digest(source, *placeholder, compiler.version, _processor())}"
    library = cache.find(stem, ".so")
    if library is None:
        say(f"compiling the kernels of {name}{f': {part}' if part else ''} (once per machine) ...")
        library = cache.keep(stem, ".so", _build(compiler, name, source))
    return library


def _build(compiler: Compiler, name: str, source: str) -> bytes:
    """Return the content of a shared library."""
    try:
        with tempfile.TemporaryDirectory(prefix="gridgen_sym-build-") as folder:
            code, built = Path(folder) / f"{name}.c", Path(folder) / f"{name}.so"
            code.write_text(source, encoding="utf-8")
            told = _run(compiler.command(code, built), _COMPILE_SECONDS)
            _check(compiler, name, told)
            return built.read_bytes()
    except OSError as error:
        raise GridgenError(
            f"the kernels of {name} cannot be compiled in {tempfile.gettempdir()}: {error.strerror or error}; free "
            f"some space, or set TMPDIR to another folder. {_WITHOUT}"
        ) from error


def _check(compiler: Compiler, name: str, told: subprocess.CompletedProcess[str] | None) -> None:
    """Raise a `GridgenError` unless the compiler ended well."""
    if told is None:
        raise GridgenError(f"{compiler.path} did not finish the kernels of {name} in {_COMPILE_SECONDS} s. {_WITHOUT}")
    # The driver tells with exit code 1 of a part of it that was killed.
    if told.returncode < 0 or "terminated program" in told.stderr:
        raise GridgenError(
            f"{compiler.path} was killed while it compiled the kernels of {name}, perhaps for want of memory: run this "
            f"again. {_WITHOUT}"
        )
    if told.returncode:
        raise GridgenError(
            f"{compiler.path} ({compiler.version}) rejected the generated kernels of {name}; this is a bug of "
            f"gridgen_sym unless the compiler is broken or the disk full. Its messages:\n{told.stderr.strip()[:4000]}\n"
            f"{_WITHOUT}"
        )


def _run(command: list[str], seconds: float) -> subprocess.CompletedProcess[str] | None:
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


def _processor() -> str:
    """Return what -march=native depends on."""
    information = Path("/proc/cpuinfo")
    if sys.platform == "linux" and information.exists():
        kept = {
            line
            for line in information.read_text().splitlines()
            if line.startswith(("flags", "Features", "model name"))
        }
        return "\n".join(sorted(kept))
    return f"{platform.machine()} {platform.processor()}"
