"""Compile generated C with the system's compiler, once per source, command, compiler and processor."""

from __future__ import annotations

import ctypes
import platform
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from itertools import chain
from pathlib import Path

from ..cache import digest, find_kept, keep
from ..errors import GridgenError
from ..messages import report
from .process import run, seconds_left
from .threads import threads_that_sleep
from .toolchain import Compiler
from .toolchain import find_compiler as find_compiler

_COMPILE_SECONDS = 300
#: Characters of the compiler's messages that are shown.
_MESSAGES = 4000
#: What a source includes besides the system's headers, by default.
NO_HEADERS: Mapping[str, str] = {}
_WITHOUT = "GRIDGEN_SYM_BACKEND=numpy works without a compiler."


def open_library(
    name: str, source: str, part: str = "", headers: Mapping[str, str] = NO_HEADERS, *, marked: bool = False
) -> ctypes.CDLL:
    """Load the shared library of a C source, which is compiled now or found in the cache.

    Args:
        name: of the file, and what is reported while it is compiled.
        source: the C source.
        part: what part of it this is, for the user.
        headers: texts of the files that it may include, by name.
        marked: whether the loops that matter are marked as vectors for OpenMP.

    Raises:
        GridgenError: as for `compile_library`; or if the system does not let the library be loaded.
    """
    library = compile_library(name, source, part, headers, marked=marked)
    try:
        with threads_that_sleep():
            return ctypes.CDLL(str(library))
    except OSError as error:
        raise GridgenError(
            f"the compiled kernels of {name} cannot be loaded ({error}): set GRIDGEN_SYM_CACHE to a folder from which "
            "programs may run, or use the NumPy backend with GRIDGEN_SYM_BACKEND=numpy"
        ) from error


def compile_library(
    name: str, source: str, part: str = "", headers: Mapping[str, str] = NO_HEADERS, *, marked: bool = False
) -> Path:
    """Return the shared library of a C source, compiled now or found in the cache; arguments as for `open_library`.

    Raises:
        GridgenError: if there is no compiler, or if it rejects the source, with its messages, or is killed.
    """
    compiler = find_compiler()
    if compiler is None:
        raise GridgenError("no C compiler was found: install one (cc, gcc or clang), set CC, or use the NumPy backend")
    placeholder = compiler.command(Path("source.c"), Path("library"), marked=marked)
    stem = f"{name}-{digest(source, *chain(*headers.items()), *placeholder, compiler.version, _processor())}"
    library = find_kept(stem, ".so")
    if library is None:
        report(f"compiling the kernels of {name}{f': {part}' if part else ''} (once per machine) ...")
        library = keep(stem, ".so", _build(compiler, name, source, headers, marked))
    return library


def _build(compiler: Compiler, name: str, source: str, headers: Mapping[str, str], marked: bool) -> bytes:
    """Return the content of a shared library."""
    try:
        with tempfile.TemporaryDirectory(prefix="gridgen_sym-build-") as folder:
            code, built = Path(folder) / f"{name}.c", Path(folder) / f"{name}.so"
            for file, text in {code.name: source, **headers}.items():
                (code.parent / file).write_text(text, encoding="utf-8")
            result = run(compiler.command(code, built, marked=marked), min(_COMPILE_SECONDS, seconds_left()))
            if result is None:
                seconds_left()  # Raises if it was the run's deadline that ended the compiler.
            _check(compiler, name, result)
            return built.read_bytes()
    except OSError as error:
        raise GridgenError(
            f"the kernels of {name} cannot be compiled in {tempfile.gettempdir()}: {error.strerror or error}; free "
            f"some space, or set TMPDIR to another folder. {_WITHOUT}"
        ) from error


def _check(compiler: Compiler, name: str, result: subprocess.CompletedProcess[str] | None) -> None:
    """Raise a `GridgenError` unless the compiler ended well."""
    if result is None:
        raise GridgenError(f"{compiler.words} did not finish the kernels of {name} in {_COMPILE_SECONDS} s. {_WITHOUT}")
    # The driver exits with 1 when a part of it was killed.
    if result.returncode < 0 or "terminated program" in result.stderr:
        raise GridgenError(
            f"{compiler.words} was killed while it compiled the kernels of {name}, perhaps for want of memory: run "
            f"this again. {_WITHOUT}"
        )
    if result.returncode:
        raise GridgenError(f"{_rejection(compiler, name, result.stderr.strip()[:_MESSAGES])}\n{_WITHOUT}")


def _rejection(compiler: Compiler, name: str, messages: str) -> str:
    """Return whose fault it is that a kernel was rejected, and the compiler's messages."""
    program = f"{compiler.words} ({compiler.version})"
    failure = compiler.failure()
    if failure:
        return (
            f"{program} compiles no program at all, not even one of four lines: install another compiler or the "
            f"headers of the C library (Debian: apt install libc6-dev), or correct CC. Its messages:\n"
            f"{failure[:_MESSAGES]}"
        )
    if compiler.options:
        return (
            f"{program} rejected the generated kernels of {name}, perhaps because of the options in CC: try it without "
            f"them. Its messages:\n{messages}"
        )
    return (
        f"{program} rejected the generated kernels of {name}; this is a bug of gridgen_sym unless the compiler is "
        f"broken or the disk full. Its messages:\n{messages}"
    )


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
