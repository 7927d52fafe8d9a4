"""Finding a compiler, and a cache that nothing breaks: a bad compiler, many processes, a killed one, no folder."""

from __future__ import annotations

import ctypes
import errno
import os
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import gridgen_sym as gg
from gridgen_sym import domain, messages
from gridgen_sym.backends.c.loader import PARTS, headers, part_of
from gridgen_sym.codegen.backend import find_backend
from gridgen_sym.codegen.interface import FUNCTIONS
from gridgen_sym.errors import GridgenError
from gridgen_sym.functionals import Functional, define, functional
from gridgen_sym.functionals.variant import kernel_name
from gridgen_sym.runtime import cache_folder, choose_backend, compiler, find_compiler, kernels, process, toolchain
from gridgen_sym.runtime.compiler import compile_library
from gridgen_sym.runtime.sources import find_sources
from gridgen_sym.solvers.run.deadline import StopRequest
from gridgen_sym.solvers.run.status import StopReason

ANSWER = 'int answer(void);\n__attribute__((visibility("default"))) int answer(void) { return 42; }\n'
COMPILER = next((path for name in ("cc", "gcc", "clang") if (path := shutil.which(name))), None)
needs_compiler = pytest.mark.skipif(COMPILER is None, reason="needs a C compiler")


def forget():
    find_compiler.cache_clear()
    cache_folder.cache_clear()
    # The module and its function `kernels` have one name in the package.
    sys.modules["gridgen_sym.runtime.kernels"]._load.cache_clear()


@pytest.fixture
def cache(monkeypatch, tmp_path):
    """Start with an empty cache, and with nothing found or said before."""
    for name in ("CC", "GRIDGEN_SYM_BACKEND", "GRIDGEN_SYM_QUIET"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("GRIDGEN_SYM_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(messages, "_reported", set())
    forget()
    yield tmp_path / "cache"
    forget()


@pytest.fixture
def no_compiler(monkeypatch, tmp_path, cache):
    (tmp_path / "empty").mkdir()
    monkeypatch.setenv("PATH", str(tmp_path / "empty"))


def script(path: Path, *lines: str) -> str:
    """Write a compiler that is a shell script; it tells its version, and has no OpenMP."""
    told = 'case "$1" in --version) echo "script 1.0"; exit 0;; esac'
    serial = 'for argument in "$@"; do [ "$argument" = -fopenmp ] && exit 1; done'
    path.write_text("\n".join(["#!/bin/sh", told, serial, *lines]) + "\n")
    path.chmod(0o755)
    return str(path)


@pytest.fixture
def quick_compiler(monkeypatch, tmp_path, cache):
    """The real compiler, without the optimization that takes most of its time."""
    options = 'for argument in "$@"; do shift; [ "$argument" = -O3 ] || set -- "$@" "$argument"; done'
    monkeypatch.setenv("CC", script(tmp_path / "quick", options, f'exec "{COMPILER}" "$@"'))


def libraries(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.glob("*.so"))


def wait_for(condition):
    give_up = time.monotonic() + 60
    while not condition():
        assert time.monotonic() < give_up
        time.sleep(0.02)


def answer_of(library: Path) -> int:
    return ctypes.CDLL(str(library)).answer()


# ---- no compiler ----


@pytest.mark.usefixtures("no_compiler")
def test_no_compiler_falls_back_to_numpy_and_says_so_once(capsys):
    for name in ("length", "area", "length"):
        assert kernels(functional(name)).backend == "numpy"
    told = capsys.readouterr().err
    assert told.count("no C compiler was found") == 1
    assert "install one" in told
    assert "GRIDGEN_SYM_BACKEND=numpy" in told


@pytest.mark.usefixtures("no_compiler")
def test_asking_for_numpy_says_nothing(capsys, monkeypatch):
    monkeypatch.setenv("GRIDGEN_SYM_BACKEND", "numpy")
    assert kernels(functional("length")).backend == "numpy"
    assert capsys.readouterr().err == ""


@pytest.mark.usefixtures("no_compiler")
def test_asking_for_c_without_a_compiler_is_an_error(monkeypatch):
    with pytest.raises(GridgenError, match="'c' needs a C compiler: install one"):
        choose_backend("c")
    monkeypatch.setenv("GRIDGEN_SYM_BACKEND", "c")
    with pytest.raises(GridgenError, match="'c' needs a C compiler"):
        kernels(functional("length"))
    with pytest.raises(GridgenError, match="no C compiler was found: install one"):
        compile_library("tiny", ANSWER)


def test_a_compiler_that_does_not_run_is_none(monkeypatch, tmp_path, cache):
    broken = tmp_path / "cc"
    broken.write_text("#!/bin/sh\nexit 127\n")
    broken.chmod(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert find_compiler() is None


@pytest.mark.parametrize("name", ["fortran", "C", "cython"])
def test_an_unknown_backend_is_an_error(name, monkeypatch, cache):
    with pytest.raises(GridgenError, match=f"unknown backend '{name}'.*'c' or 'numpy'"):
        choose_backend(name)
    monkeypatch.setenv("GRIDGEN_SYM_BACKEND", name)
    with pytest.raises(GridgenError, match=f"unknown backend '{name}'"):
        kernels(functional("length"))


# ---- a compiler that fails ----


def test_a_compiler_that_rejects_a_kernel_is_an_error_with_its_messages(monkeypatch, tmp_path, cache):
    rejecting = ('case "$*" in *length*) echo "length.c:7:1: error: not today" >&2; exit 1;; esac', "exit 0")
    monkeypatch.setenv("CC", script(tmp_path / "rejecting", *rejecting))
    with pytest.raises(GridgenError, match=r"rejected the generated kernels of length(.|\n)*error: not today") as told:
        kernels(functional("length"))
    assert "script 1.0" in str(told.value)
    assert "GRIDGEN_SYM_BACKEND=numpy" in str(told.value)
    assert libraries(cache) == []
    assert not list(cache.glob(".build-*"))


def test_a_compiler_that_compiles_nothing_is_not_called_a_bug(monkeypatch, tmp_path, cache):
    monkeypatch.setenv("CC", script(tmp_path / "broken", 'echo "stdint.h: No such file" >&2', "exit 1"))
    with pytest.raises(GridgenError, match=r"compiles no program at all(.|\n)*stdint.h: No such file") as told:
        compile_library("tiny", ANSWER)
    assert "bug" not in str(told.value)


# ---- the words of CC ----


@needs_compiler
def test_all_words_of_cc_are_used(monkeypatch, tmp_path, cache):
    """As in "ccache gcc -O0": a program that runs the compiler, which comes right after it; options win over ours."""
    launcher = tmp_path / "my launcher"
    launcher.write_text(f'#!/bin/sh\necho "$@" >> "{tmp_path}/log"\nexec "$@"\n')
    launcher.chmod(0o755)
    monkeypatch.setenv("CC", f"'{launcher}' {COMPILER} -O0 -DNOTHING='a b'")
    assert answer_of(compile_library("tiny", ANSWER)) == 42
    first, *_, last = (tmp_path / "log").read_text().splitlines()
    assert first == f"{COMPILER} --version"
    assert last.startswith(f"{COMPILER} -std=c99 -O3")
    assert last.index("-O0 -DNOTHING=a b") > last.index("-O3")
    assert len(libraries(cache)) == 1
    monkeypatch.setenv("CC", f"'{launcher}' {COMPILER} -O1")
    find_compiler.cache_clear()
    compile_library("tiny", ANSWER)
    assert len(libraries(cache)) == 2


@needs_compiler
def test_options_of_cc_that_reject_a_kernel_are_not_called_a_bug(monkeypatch, cache):
    monkeypatch.setenv("CC", f"{COMPILER} -Wmissing-prototypes -Werror")
    with pytest.raises(GridgenError, match="perhaps because of the options in CC: try it without them") as told:
        compile_library("tiny", "double odd(void) { return 1; }\n")
    assert "bug" not in str(told.value)


@pytest.mark.parametrize(
    ("named", "message"),
    [
        ("no-such-compiler", "CC is 'no-such-compiler', but there is no program 'no-such-compiler': correct CC, or"),
        ("'gcc", "which a shell could not split into words"),
        ("false -O0", "CC is 'false -O0', but  .*false --version  fails, so that it is no working compiler"),
        ("cc -Ofast", "-Ofast lets the compiler assume that no number is infinite or NaN.*leave it out"),
    ],
)
def test_a_cc_that_cannot_be_used_is_an_error_and_not_replaced(named, message, monkeypatch, cache):
    monkeypatch.setenv("CC", named)
    with pytest.raises(GridgenError, match=message):
        kernels(functional("length"))
    assert kernels(functional("length"), backend="numpy").backend == "numpy"


# ---- a compiler that takes too long, or is killed ----


def test_a_compiler_that_never_ends_is_an_error_and_is_ended_with_its_parts(monkeypatch, tmp_path, cache):
    """A compiler is a driver: a part of it that goes on would hold its pipes open, and the wait with them."""
    monkeypatch.setenv("CC", script(tmp_path / "endless", f'sleep 600 & echo $! > "{tmp_path}/part"', "wait"))
    monkeypatch.setattr(compiler, "_COMPILE_SECONDS", 1)
    with pytest.raises(GridgenError, match="did not finish the kernels of tiny in 1 s"):
        compile_library("tiny", ANSWER)
    assert_ended(int((tmp_path / "part").read_text()))


def test_a_deadline_ends_the_compiler_with_its_parts(monkeypatch, tmp_path, cache):
    """Also before it begins."""
    end = time.monotonic() + 1.0

    def left():
        seconds = end - time.monotonic()
        if seconds <= 0:
            raise StopRequest(StopReason.TIME_LIMIT, "over")
        return seconds

    monkeypatch.setenv("CC", script(tmp_path / "endless", f'sleep 600 & echo $! > "{tmp_path}/part"', "wait"))
    for _ in range(2):
        with pytest.raises(StopRequest), process.time_limited(left):
            compile_library("tiny", ANSWER)
    assert process.seconds_left() == float("inf")
    assert_ended(int((tmp_path / "part").read_text()))


@pytest.mark.slow
@needs_compiler
def test_the_time_limit_of_a_run_includes_its_compilations(monkeypatch, tmp_path, cache):
    endless = 'case "$*" in *winslow_regularized*) sleep 600;; esac'
    monkeypatch.setenv("CC", script(tmp_path / "endless", endless, f'exec "{COMPILER}" "$@"'))
    start, began = gg.domain("zee", 17, 17), time.monotonic()
    result = gg.untangle(start, time_limit=2.0, backend="c")
    assert time.monotonic() - began < 60
    assert result.stopped_by == "time limit"
    assert result.quality.folded_cells <= gg.quality(start).folded_cells


def test_an_interrupt_ends_the_compiler(monkeypatch, tmp_path, cache):
    part = tmp_path / "part"
    monkeypatch.setenv(
        "CC", script(tmp_path / "endless", f'echo $$ > "{part}.new"; mv "{part}.new" "{part}"', "sleep 600")
    )
    # A shell that runs tests in the background lets them, and all that they start, ignore interrupts.
    heed = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n"
    with subprocess.Popen(
        [sys.executable, "-c", heed + _BUILD], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    ) as building:
        wait_for(part.exists)
        building.send_signal(signal.SIGINT)
        assert "KeyboardInterrupt" in building.communicate(timeout=30)[1]
    assert_ended(int(part.read_text()))


@pytest.mark.skipif(os.name != "posix", reason="needs POSIX signals")
def test_an_interrupt_just_after_a_program_has_started_ends_it(monkeypatch):
    """It comes between the start of the program and the time at which anyone knows of it."""
    started = []

    class Popen(subprocess.Popen):
        def __init__(self, *arguments, **options):
            super().__init__(*arguments, **options)
            started.append(self.pid)
            signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(subprocess, "Popen", Popen)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            process.run(["sleep", "600"], 60)
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, before)
    assert_ended(started[0])


def assert_ended(process):
    """Check that a process has gone, or waits only for whoever adopted it to take note."""
    status = Path(f"/proc/{process}/stat")

    def ended():
        try:
            os.kill(process, 0)
            return status.exists() and status.read_text().rpartition(")")[2].split()[0] == "Z"
        except OSError:
            return True

    wait_for(ended)


@needs_compiler
@pytest.mark.parametrize(
    "death", ["kill -9 $$", "echo 'cc: fatal error: Killed signal terminated program cc1' >&2; exit 1"]
)
def test_a_killed_compiler_is_told_apart_from_a_bug(monkeypatch, tmp_path, cache, death):
    """The system kills what takes too much memory; nothing is wrong with the kernels."""
    alive = tmp_path / "alive"
    monkeypatch.setenv("CC", script(tmp_path / "dying", f'[ -e "{alive}" ] && exec "{COMPILER}" "$@"', death))
    with pytest.raises(GridgenError, match=r"was killed while it compiled the kernels of tiny.*run this again"):
        compile_library("tiny", ANSWER)
    assert libraries(cache) == []
    alive.touch()
    assert answer_of(compile_library("tiny", ANSWER)) == 42


# ---- the cache ----


@needs_compiler
def test_a_library_is_built_once(cache, capsys):
    library = compile_library("tiny", ANSWER)
    assert answer_of(library) == 42
    built = library.stat().st_mtime_ns
    assert compile_library("tiny", ANSWER) == library
    assert library.stat().st_mtime_ns == built
    assert capsys.readouterr().err.count("compiling the kernels of tiny") == 1
    assert libraries(cache) == [library.name]


@needs_compiler
def test_the_key_changes_with_everything_that_the_library_depends_on(monkeypatch, cache):
    told = [compile_library("tiny", ANSWER)]
    told.append(compile_library("tiny", ANSWER.replace("42", "43")))
    told.append(compile_library("tiny", ANSWER, headers={"other.h": "#define OTHER 1\n"}))
    told.append(compile_library("tiny", ANSWER, headers={"other.h": "#define OTHER 2\n"}))
    with monkeypatch.context() as change:
        change.setattr(toolchain, "FLAGS", (*toolchain.FLAGS, "-DNOTHING"))
        told.append(compile_library("tiny", ANSWER))
    found = find_compiler()
    changed = ({"version": "another"}, {"openmp": not found.openmp}, {"options": ("-O0",)})
    for other in (replace(found, **change) for change in changed):
        with monkeypatch.context() as change:
            change.setattr(compiler, "find_compiler", lambda other=other: other)
            told.append(compile_library("tiny", ANSWER))
    with monkeypatch.context() as change:
        change.setattr(compiler, "_processor", lambda: "another")
        told.append(compile_library("tiny", ANSWER))
    assert len(set(told)) == len(told) == 9
    assert answer_of(told[1]) == 43


def test_no_flag_hides_a_fold_or_a_nan():
    command = toolchain.Compiler("cc", "", openmp=True).command(Path("source.c"), Path("library.so"))
    assert not {"-ffast-math", "-Ofast", "-ffinite-math-only", "-funsafe-math-optimizations"} & set(command)


_BUILD = f"""
import ctypes, sys
from gridgen_sym.runtime.compiler import compile_library
print(ctypes.CDLL(str(compile_library("tiny", {ANSWER!r}))).answer())
"""


@pytest.mark.slow
@needs_compiler
def test_many_processes_at_once_leave_one_library(cache):
    started = [
        subprocess.Popen([sys.executable, "-c", _BUILD], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        for _ in range(6)
    ]
    told = [process.communicate(timeout=120) for process in started]
    assert [process.returncode for process in started] == [0] * 6, told
    assert [out for out, _ in told] == ["42\n"] * 6
    left = sorted(path.name for path in cache.iterdir())
    assert len(left) == 2, left
    assert left[0].startswith("openmp-")
    assert left[1].startswith("tiny-")
    assert left[1].endswith(".so")


@needs_compiler
def test_a_killed_build_blocks_nothing(monkeypatch, tmp_path, cache):
    waiting, started = tmp_path / "wait", tmp_path / "started"
    waiting.touch()
    monkeypatch.setenv(
        "CC",
        script(
            tmp_path / "slow",
            f'touch "{started}"',
            f'while [ -e "{waiting}" ]; do sleep 0.05; done',
            f'exec "{COMPILER}" "$@"',
        ),
    )
    building = subprocess.Popen([sys.executable, "-c", _BUILD], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    wait_for(started.exists)
    building.send_signal(signal.SIGKILL)  # Of Python only: its compiler goes on.
    building.wait(timeout=30)
    assert libraries(cache) == []
    waiting.unlink()
    assert answer_of(compile_library("tiny", ANSWER)) == 42
    assert len(libraries(cache)) == 1


@needs_compiler
def test_a_cache_folder_that_cannot_be_written_is_replaced_and_said(monkeypatch, tmp_path, cache, capsys):
    (tmp_path / "file").write_text("not a folder")
    monkeypatch.setenv("GRIDGEN_SYM_CACHE", str(tmp_path / "file" / "below"))
    assert answer_of(compile_library("tiny", ANSWER)) == 42
    assert answer_of(compile_library("tiny", ANSWER.replace("42", "44"))) == 44
    told = capsys.readouterr().err
    assert told.count("cannot be written") == 1
    assert "set GRIDGEN_SYM_CACHE" in told


needs_owners = pytest.mark.skipif(not hasattr(os, "geteuid"), reason="needs POSIX permissions")


@needs_owners
def test_a_new_cache_is_closed_to_others_whatever_the_umask_says(cache):
    before = os.umask(0)
    try:
        find_sources(define("mine", "g11 + 2*g22"), "plain", find_backend("c"))
    finally:
        os.umask(before)
    assert {path.stat().st_mode & 0o077 for path in (cache, *cache.rglob("*"))} == {0}


@needs_owners
@pytest.mark.parametrize("folder", ["", "sources"])
@pytest.mark.parametrize("mode", [0o770, 0o702, 0o777])
def test_a_cache_folder_in_which_others_can_write_is_refused_with_the_repair(cache, folder, mode):
    """What is kept there is run: who can write there could run what they want in the user's name."""
    mine = define("mine", "g11 + 2*g22")
    find_sources(mine, "plain", find_backend("c"))
    opened = cache / folder
    opened.chmod(mode)
    forget()
    repair = f"run  chmod go-w {opened}  or set GRIDGEN_SYM_CACHE"
    with pytest.raises(GridgenError, match=f"can be written by other users .mode {mode:04o}.*{repair}"):
        find_sources(mine, "plain", find_backend("c"))
    opened.chmod(0o755)
    assert all(path.is_relative_to(cache) for path in find_sources(mine, "plain", find_backend("c")))


@needs_owners
def test_a_folder_for_everyone_is_no_cache_and_stays_as_it_is(cache):
    cache.mkdir(mode=0o700)
    cache.chmod(0o1777)  # Like /tmp: nobody should be told to close that.
    with pytest.raises(GridgenError, match="can be written by other users") as told:
        cache_folder()
    assert "chmod" not in str(told.value)


@needs_owners
def test_a_cache_folder_of_another_user_is_refused(monkeypatch, cache):
    cache.mkdir(mode=0o700)
    monkeypatch.setattr(os, "geteuid", lambda: cache.stat().st_uid + 1)
    if cache.stat().st_uid == 0:
        os.chown(cache, 12345, 12345)
    with pytest.raises(
        GridgenError, match=r"belongs to another user \(number \d+\).*set GRIDGEN_SYM_CACHE to a folder"
    ):
        cache_folder()


@needs_owners
@needs_compiler
def test_a_kept_file_that_others_can_write_is_made_again(cache):
    library = compile_library("tiny", ANSWER)
    library.chmod(0o666)
    before = library.stat().st_ino
    assert compile_library("tiny", ANSWER) == library
    assert library.stat().st_ino != before
    assert library.stat().st_mode & 0o022 == 0


@needs_compiler
@pytest.mark.parametrize(
    "damage", [lambda data: b"", lambda data: data[: len(data) // 2], lambda data: data[:-1] + b"?"]
)
def test_a_damaged_library_is_not_loaded_but_made_again(cache, damage):
    """Half a library maps well enough to be loaded, and then ends the process."""
    library = compile_library("tiny", ANSWER)
    whole = library.read_bytes()
    library.unlink()  # Not written over: this process may have it loaded.
    library.write_bytes(damage(whole))
    assert answer_of(compile_library("tiny", ANSWER)) == 42


@needs_compiler
def test_a_damaged_answer_about_openmp_is_asked_again(cache):
    found = find_compiler()
    (answer,) = cache.glob("openmp-*")
    answer.write_bytes(b"")
    find_compiler.cache_clear()
    assert find_compiler() == found


def full_disk(monkeypatch, folder: Path):
    """Let every write below a folder fail as on a full disk."""
    rename = Path.replace

    def replace(self, target):
        if Path(target).is_relative_to(folder):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return rename(self, target)

    monkeypatch.setattr(Path, "replace", replace)


@needs_compiler
@pytest.mark.usefixtures("quick_compiler")
def test_a_full_disk_costs_the_cache_only(monkeypatch, cache, capsys):
    full_disk(monkeypatch, cache)
    assert answer_of(compile_library("tiny", ANSWER)) == 42
    mine = kernels(define("mine", "g11 + 3*g22"), backend="c")
    assert mine.energy(np.mgrid[:3, :3].astype(float), None)[0] == 16 * 4
    told = capsys.readouterr().err
    assert "No space left on device" in told
    assert "lost with this process" in told
    assert [path for path in cache.rglob("*") if path.is_file()] == []


@needs_compiler
def test_no_room_to_compile_in_is_an_error_that_helps(monkeypatch, cache):
    def write_text(self, *arguments, **keywords):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Path, "write_text", write_text)
    with pytest.raises(GridgenError, match=r"cannot be compiled in .*No space left on device.*set TMPDIR"):
        compile_library("tiny", ANSWER)


@needs_compiler
def test_a_library_that_may_not_be_loaded_is_an_error_that_helps(monkeypatch, cache):
    """As where the cache folder is mounted so that nothing in it may run."""

    def refuse(path):
        raise OSError(f"{path}: failed to map segment from shared object")

    monkeypatch.setattr(ctypes, "CDLL", refuse)
    with pytest.raises(GridgenError, match=r"cannot be loaded.*set GRIDGEN_SYM_CACHE to a folder from which"):
        compiler.open_library("tiny", ANSWER)


_SOLVE = """
import sys
import gridgen_sym as gg
gg.define("mine", "g11 + g22 + k*g12**2", parameters={"k": 0.5})
print(gg.optimize(gg.domain("swan", 9, 9), "mine").grid.planes.tobytes().hex())
"""


@pytest.mark.slow
@needs_compiler
@pytest.mark.usefixtures("quick_compiler")
def test_two_processes_with_one_cold_cache_make_the_same_grid(cache):
    """The whole way at once: derivation, compilation of kernels and of multigrid, solution."""
    command = [sys.executable, "-c", _SOLVE]
    started = [subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) for _ in range(2)]
    told = [process.communicate(timeout=300) for process in started]
    assert [process.returncode for process in started] == [0, 0], told
    assert told[0][0] == told[1][0] != "\n"
    kept = [path for path in cache.rglob("*") if path.is_file()]
    assert not [
        path for path in kept if path.suffix not in (".so", ".c", ".json") and not path.name.startswith("openmp-")
    ]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["gcc", "clang"])
def test_everything_runs_under_a_compiler_that_is_strict(name, monkeypatch, cache):
    """The flags of CC come after ours, so that kernels, multigrid and the trial of OpenMP are compiled with them."""
    if not shutil.which(name):
        pytest.skip(f"there is no {name}")
    monkeypatch.setenv("CC", f"{name} -O1 -Wall -Wextra -Wconversion -Werror")
    solve = (
        "import gridgen_sym as gg\nfor name in ('winslow', 'knupp'):\n"
        "    gg.optimize(gg.domain('swan', 17, 17), name, backend='c')\n"
        "gg.solve_euler_lagrange(gg.domain('wavy', 17, 17), 'winslow', backend='c')\n"
        "gg.optimize(gg.domain('wavy', 9, 9), 'area_winslow', 'local', weight='1 + x**2', backend='c')\n"
    )
    told = subprocess.run([sys.executable, "-c", solve], capture_output=True, text=True, check=False)
    assert told.returncode == 0, told.stderr
    assert "warning" not in told.stderr
    assert len(libraries(cache)) > 6


# ---- parts of a kernel file ----


@pytest.mark.slow
@needs_compiler
def test_a_part_is_compiled_when_it_is_first_called_and_said(cache, capsys):
    coordinates = np.ascontiguousarray(domain("wavy", 5, 5).planes)
    found = kernels(functional("length"), backend="c")
    energy = found.energy(coordinates)[0]
    assert len(libraries(cache)) == 1
    assert capsys.readouterr().err == (
        "gridgen_sym: compiling the kernels of length: energy and gradient (once per machine) ...\n"
    )
    planes = found.hessian(coordinates)
    assert found.hessian(coordinates)[3, 1, 1] == planes[3, 1, 1] == -8.0
    assert len(libraries(cache)) == 2
    assert capsys.readouterr().err.count("compiling the kernels of length: Hessian") == 1
    forget()
    assert kernels(functional("length"), backend="c").energy(coordinates)[0] == energy
    assert capsys.readouterr().err == ""


@pytest.mark.slow
@needs_compiler
def test_each_part_exports_its_functions_and_no_others(cache):
    assert sorted(name for names in PARTS.values() for name in names) == sorted(FUNCTIONS)
    sources = {
        variant: find_sources(functional("length"), variant, find_backend("c"))[1].read_text(encoding="utf-8")
        for variant in ("plain", "target+mixed")
    }
    for part, _ in PARTS:
        variant = "target+mixed" if part == "MIXED" else "plain"
        source, name = sources[variant], kernel_name("length", variant)
        library = ctypes.CDLL(str(compile_library("length", part_of(source, part), headers=headers())))
        exported = {function for function in FUNCTIONS if hasattr(library, f"{name}_{function}")}
        assert exported == {name for (other, _), names in PARTS.items() for name in names if other == part}


# ---- sources derived when first used ----


@pytest.mark.parametrize("suffix", [".c", ".json"])
def test_damaged_sources_are_derived_again(cache, suffix):
    mine = define("mine", "g11 + 2*g22")
    before = [path.read_bytes() for path in find_sources(mine, "plain", find_backend("c"))]
    (damaged,) = (cache / "sources").glob(f"*{suffix}")
    damaged.write_bytes(damaged.read_bytes()[:100])
    assert [path.read_bytes() for path in find_sources(mine, "plain", find_backend("c"))] == before


def test_a_functional_of_a_user_is_derived_once_and_kept(cache, capsys):
    def find(text):
        mine = define("mine", text, parameters={"k": 1}, replace=True)
        return find_sources(mine, "plain", find_backend("numpy"))

    first = find("g11 + 2*g22 + k*J**2")
    assert all(path.is_relative_to(cache) and path.exists() for path in first)
    assert find("g11 + 2*g22 + k*J**2") == first
    assert capsys.readouterr().err.count("deriving the kernels of mine") == 1
    assert not set(find("g11 + 3*g22 + k*J**2")) & set(first)


def test_only_the_language_in_use_is_printed_and_kept(cache):
    find_sources(define("mine", "g11 + 2*g22"), "plain", find_backend("numpy"))
    assert {path.suffix for path in (cache / "sources").iterdir()} == {".json", ".py"}


def test_another_functional_of_a_built_in_name_has_kernels_of_its_own(cache):
    facts, _ = find_sources(Functional("length", "g11 + 2*g22"), "plain", find_backend("numpy"))
    assert facts.is_relative_to(cache)
    assert "2*g22" in facts.read_text()


@pytest.mark.parametrize("name", ["c", "numpy"])
def test_committed_sources_are_not_derived_again(cache, capsys, name):
    find_sources(functional("winslow"), "plain", find_backend(name))
    assert capsys.readouterr().err == ""
    assert not (cache / "sources").exists()
