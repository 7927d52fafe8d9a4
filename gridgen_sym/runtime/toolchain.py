"""Find the C compiler: the one that CC names, with all its words, or else cc, gcc or clang."""

from __future__ import annotations

import contextlib
import os
import shlex
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from functools import lru_cache
from itertools import takewhile
from pathlib import Path

from ..cache import digest, find_kept, keep
from ..errors import GridgenError, quoted
from .process import run

#: No -ffast-math: a fold and a NaN must stay visible.
FLAGS = (
    "-std=c99", "-march=native", "-ffp-contract=fast", "-fno-math-errno", "-fno-trapping-math",
    "-fPIC", "-shared", "-fvisibility=hidden",
)  # fmt: skip
_FAST_MATH = ("-ffast-math", "-Ofast", "-ffinite-math-only", "-funsafe-math-optimizations")
_OPENMP_TRIAL = "#include <omp.h>\nint trial(void);\nint trial(void) { return omp_get_max_threads(); }\n"
#: What every kernel needs: a compiler that rejects this one is broken.
_TRIAL = (
    "#include <math.h>\n#include <stdint.h>\n"
    "double trial(double x);\ndouble trial(double x) { return sqrt(x) + (double)INT64_MAX; }\n"
)
_TRIAL_SECONDS, _VERSION_SECONDS = 300, 30
_UNSET = "correct CC, or unset it, so that cc, gcc or clang is used"


@dataclass(frozen=True, slots=True)
class Compiler:
    """A C compiler that has been found.

    Attributes:
        path: the program.
        version: first line of what it reports as its version.
        openmp: whether it can compile and link OpenMP.
        wraps: the words of CC between the program and the first option: `gcc` in `ccache gcc`.
        options: the words of CC from the first option on; they follow our own options, so that they win.
    """

    path: str
    version: str
    openmp: bool
    wraps: tuple[str, ...] = ()
    options: tuple[str, ...] = ()

    @property
    def words(self) -> str:
        """The program with all words of CC, as a shell takes them."""
        return shlex.join((self.path, *self.wraps, *self.options))

    def command(self, source: Path, library: Path, *, marked: bool = False) -> list[str]:
        """Return the command that compiles one source file to a shared library.

        Args:
            source: the file.
            library: the library.
            marked: whether the loops that matter are marked as vectors for OpenMP. The optimizer need not look for
                them then: with -O2 kernels are as fast, and compiled in two thirds of the time.
        """
        level = "-O2" if marked and self.openmp else "-O3"
        parallel = ("-fopenmp",) if self.openmp else ("-Wno-unknown-pragmas",)
        files = ("-o", str(library), str(source), "-lm")
        return [self.path, *self.wraps, FLAGS[0], level, *FLAGS[1:], *parallel, *self.options, *files]

    def failure(self) -> str:
        """Return what the compiler reports of a program of four lines; empty if it compiles that."""
        with tempfile.TemporaryDirectory(prefix="gridgen_sym-trial-") as folder:
            source = Path(folder) / "trial.c"
            source.write_text(_TRIAL)
            result = run(self.command(source, source.with_suffix(".so")), _TRIAL_SECONDS)
        if result is None:
            return "it does not end"
        return (result.stderr.strip() or f"exit code {result.returncode}") if result.returncode else ""


@lru_cache(maxsize=1)
def find_compiler() -> Compiler | None:
    """Return the C compiler that CC names, or else cc, gcc or clang; None where there is none.

    Raises:
        GridgenError: if CC names something that cannot be used; it is not replaced by another compiler.
    """
    words = _words_of_cc()
    if words:
        return _named(words)
    for candidate in ("cc", "gcc", "clang"):
        path = shutil.which(candidate)
        if path and (version := _version((path,))):
            return Compiler(path, version, _supports_openmp((path,), version))
    return None


def _words_of_cc() -> list[str]:
    text = os.environ.get("CC", "")
    try:
        return shlex.split(text)
    except ValueError as error:
        raise GridgenError(
            f"CC is {quoted(text)}, which a shell could not split into words ({error}): {_UNSET}"
        ) from error


def _named(words: list[str]) -> Compiler:
    """Return the compiler that the words of CC name."""
    named = shlex.join(words)
    path = shutil.which(words[0])
    if not path:
        raise GridgenError(f"CC is {quoted(named)}, but there is no program {quoted(words[0])}: {_UNSET}")
    wraps = tuple(takewhile(lambda word: not word.startswith("-"), words[1:]))
    options = tuple(words[1 + len(wraps) :])
    unsafe = [option for option in options if option in _FAST_MATH]
    if unsafe:
        raise GridgenError(
            f"CC is {quoted(named)}, but {unsafe[0]} lets the compiler assume that no number is infinite or NaN, by "
            "which folded cells are found: leave it out"
        )
    version = _version((path, *wraps))
    if not version:
        asked = shlex.join((path, *wraps, "--version"))
        raise GridgenError(f"CC is {quoted(named)}, but  {asked}  fails, so that it is no working compiler: {_UNSET}")
    return Compiler(path, version, _supports_openmp((path, *wraps, *options), version), wraps, options)


def _version(program: tuple[str, ...]) -> str:
    result = run([*program, "--version"], _VERSION_SECONDS)
    return result.stdout.splitlines()[0] if result and result.returncode == 0 and result.stdout else ""


def _supports_openmp(words: tuple[str, ...], version: str) -> bool:
    """Try OpenMP once per compiler; the answer is kept in the cache."""
    stem = f"openmp-{digest(*words, version)}"
    answer = find_kept(stem, "")
    if answer is None:
        result = _openmp_trial(words)
        if result is None or result.returncode < 0:
            return False  # It was killed, or did not end: no answer.
        answer = keep(stem, "", b"no" if result.returncode else b"yes")
    return answer.read_bytes() == b"yes"


def _openmp_trial(words: tuple[str, ...]) -> subprocess.CompletedProcess[str] | None:
    with contextlib.suppress(OSError), tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "trial.c"
        source.write_text(_OPENMP_TRIAL)
        command = [*words, "-fopenmp", "-fPIC", "-shared", "-o", str(Path(folder) / "trial.so"), str(source)]
        return run(command, _TRIAL_SECONDS)
    return None
