"""How long it takes to begin: import, a warm command, and the compilation of every kernel file."""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

from measure import Table, fastest

import gridgen_sym as gg

_HEADER = ("what", "wall seconds", "cpu seconds", "limit")
_COMPILE = """
import sys, time
import gridgen_sym as gg
from gridgen_sym.runtime import kernels
begin = time.perf_counter()
found, grid = kernels(gg.functional(sys.argv[1]), backend="c"), gg.domain("wavy", 5, 5)
for semidefinite in (False, True):
    found.hessian(grid.planes, semidefinite=semidefinite)
print(time.perf_counter() - begin)
"""


def _command(*arguments: str, **environment: str) -> str:
    told = subprocess.run(
        [sys.executable, *arguments], capture_output=True, text=True, check=True, env={**os.environ, **environment}
    )
    return told.stdout


def _children(call: list[str], runs: int) -> tuple[float, float]:
    """Return the smallest wall and processor seconds of a command, run several times."""
    walls, cpus = [], []
    for _ in range(runs):
        before = _children_cpu()
        walls.append(fastest(lambda: _command(*call), runs=1, seconds=0.0).wall)
        cpus.append(_children_cpu() - before)
    return min(walls), min(cpus)


def _children_cpu() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def run(quick: bool) -> list[Table]:
    """Measure, and return the table."""
    runs = 5 if quick else 10
    table = Table(
        "Import, a warm command, compilation",
        f"The smallest of {runs} runs, compilations once each into an empty cache.",
        _HEADER,
    )
    bare = _children(["-c", "pass"], runs)
    table.add("Python alone", *bare, "")
    imported = _children(["-c", "import gridgen_sym"], runs)
    table.add("`import gridgen_sym`, without Python", imported[0] - bare[0], imported[1] - bare[1], 0.3)
    with tempfile.TemporaryDirectory() as folder:
        command = ["grid", "swan", "-f", "winslow", "--size", "64", "64", "-o", str(Path(folder) / "swan.vts")]
        _command("-m", "gridgen_sym", *command)
        warm = _children(["-m", "gridgen_sym", *command], runs)
        table.add("`gridgen-sym grid swan -f winslow --size 64 64 -o swan.vts`", *warm, 0.5)
    names = ["winslow", "modified_liao"] if quick else sorted(gg.functionals(literature=False))
    for name in names:
        with tempfile.TemporaryDirectory() as cache:
            before = _children_cpu()
            seconds = float(_command("-c", _COMPILE, name, GRIDGEN_SYM_CACHE=cache))
            table.add(
                f"compile and load Newton's kernels of `{name}`",
                seconds,
                _children_cpu() - before,
                5,
            )
    return [table]


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer runs and kernels")
    for result in run(parser.parse_args().quick):
        print(result.markdown())
