"""Compile generated C with the system's compiler, once per source, command, compiler and processor."""

from __future__ import annotations

import hashlib
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from ..errors import GridgenError
from ..messages import say, say_once

#: No -ffast-math: a fold and a NaN must stay visible.
FLAGS = (
    "-std=c99", "-O3", "-march=native", "-ffp-contract=fast", "-fno-math-errno", "-fno-trapping-math",
    "-fPIC", "-shared", "-fvisibility=hidden",
)  # fmt: skip
_OPENMP_TRIAL = "#include <omp.h>\nint trial(void) { return omp_get_max_threads(); }\n"
_COMPILE_SECONDS = 300


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
    try:
        told = subprocess.run([path, "--version"], capture_output=True, text=True, timeout=30, check=False)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return told.stdout.splitlines()[0] if told.returncode == 0 and told.stdout else ""


def _supports_openmp(path: str, version: str) -> bool:
    """Try OpenMP once per compiler; the answer is kept in the cache."""
    answer = cache_folder() / f"openmp-{_hash(path, version)}"
    if answer.exists():
        return answer.read_text() == "yes"
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "trial.c"
        source.write_text(_OPENMP_TRIAL)
        command = [path, "-fopenmp", "-fPIC", "-shared", "-o", str(Path(folder) / "trial.so"), str(source)]
        try:
            told = subprocess.run(command, capture_output=True, timeout=_COMPILE_SECONDS, check=False)
        except subprocess.TimeoutExpired:
            return False
        works = told.returncode == 0
    _store(answer, b"yes" if works else b"no")
    return works


def compile_library(name: str, source: str) -> Path:
    """Return the shared library of a C source, compiled now or found in the cache.

    Safe for many processes at once: each builds under a name of its own and renames.

    Raises:
        GridgenError: if there is no compiler, or if it rejects the source, with its messages.
    """
    compiler = find_compiler()
    if compiler is None:
        raise GridgenError("no C compiler was found: install one (cc, gcc or clang), set CC, or use the NumPy backend")
    placeholder = compiler.command(Path("source.c"), Path("library"))
    key = _hash(source, *placeholder, compiler.version, _processor())
    library = cache_folder() / f"{name}-{key}.so"
    if not library.exists():
        say(f"compiling the kernels of {name} (once per machine) ...")
        _build(compiler, name, source, library)
    return library


def _build(compiler: Compiler, name: str, source: str, library: Path) -> None:
    with tempfile.TemporaryDirectory(dir=library.parent, prefix=".build-") as folder:
        code, built = Path(folder) / f"{name}.c", Path(folder) / f"{name}.so"
        code.write_text(source, encoding="utf-8")
        try:
            told = subprocess.run(
                compiler.command(code, built),
                capture_output=True,
                text=True,
                timeout=_COMPILE_SECONDS,
                check=False,
            )
        except subprocess.TimeoutExpired as error:
            raise GridgenError(
                f"{compiler.path} did not finish the kernels of {name} in {_COMPILE_SECONDS} s"
            ) from error
        if told.returncode != 0:
            raise GridgenError(
                f"{compiler.path} ({compiler.version}) rejected the generated kernels of {name}; this is a bug of "
                f"gridgen_sym unless the compiler is broken. Its messages:\n{told.stderr.strip()[:4000]}\n"
                "GRIDGEN_SYM_BACKEND=numpy works without a compiler."
            )
        os.replace(built, library)


@lru_cache(maxsize=1)
def cache_folder() -> Path:
    """Return the folder of compiled kernels: GRIDGEN_SYM_CACHE, else the user's cache folder.

    Where that cannot be written, a temporary folder that lives as long as the process, and says so.
    """
    import platformdirs

    chosen = os.environ.get("GRIDGEN_SYM_CACHE")
    folder = Path(chosen) if chosen else platformdirs.user_cache_path("gridgen_sym")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return folder
    except OSError as error:
        say_once(
            f"the cache folder {folder} cannot be written ({error.strerror}): kernels are compiled again in every "
            "process; set GRIDGEN_SYM_CACHE to a folder that can"
        )
        return Path(_process_folder().name)


@lru_cache(maxsize=1)
def _process_folder() -> tempfile.TemporaryDirectory[str]:
    return tempfile.TemporaryDirectory(prefix="gridgen_sym-")


def _store(path: Path, content: bytes) -> None:
    from ..atomic import write_bytes

    write_bytes(path, content)


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


def _hash(*parts: str) -> str:
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:24]
