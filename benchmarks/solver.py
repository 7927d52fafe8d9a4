"""Cost of Newton's method in work units, against the number of nodes; and the peak memory of the solvers.

One work unit is one energy + gradient pass of the generated kernel, on the same grid, in the same run, with the same
number of threads, its result preallocated.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from measure import FOLDER, Series, Table, plot
from solver_cost import FUNCTIONALS

_HEADER = ("functional", "boundary", "nodes", "threads", "wall seconds", "cpu seconds", "ms per unit", "work units",
           "steps", "outcome")  # fmt: skip
_TEXT = (
    "`gridgen_sym.optimize(start, functional, tolerance=1e-8)` from transfinite interpolation: nested iteration, "
    "untangling where the start is folded, all Python overhead counted. Seconds are the smallest of a few runs; steps "
    "are those on the finest grid. Units are counted in processor seconds on one thread, which stop while others "
    "have the processor, and in wall seconds on two. A case that fails or takes too long is not tried on larger grids. "
    "`disturbed`: the unit changed by a quarter during the solve, or two threads had less than one processor or a unit "
    "no faster than on one, so that the row measures the machine's load; it is not in the plot."
)
Units = dict[tuple[int, str, str], tuple[list[float], list[float]]]


def run(quick: bool, largest: int | None = None, picture: Path | None = None) -> list[Table]:
    """Measure, and return the tables of cost and of memory.

    Args:
        quick: fewer cases, and 20 processor seconds for one solve.
        largest: side of the largest grid; by default 1024 if quick, else 2048.
        picture: where to draw the cost.
    """
    table, units, failed = Table("Newton's method in work units", _TEXT, _HEADER), Units(), set()
    for count in (1, 2):
        for cost in _costs(quick, largest or (1024 if quick else 2048), count):
            name, boundary, size = cost["functional"], cost["boundary"], cost["size"]
            spent = cost["units"]
            table.add(name, boundary, f"{size}²", count, cost["wall"], cost["cpu"], cost["unit"] * 1e3, round(spent),
                      cost["steps"], cost["outcome"] + ", disturbed" * cost["disturbed"])  # fmt: skip
            if cost["disturbed"]:
                continue
            if cost["outcome"] == "converged":
                x, y = units.setdefault((count, name, boundary), ([], []))
                x.append(size * size)
                y.append(spent)
            elif (name, boundary, size) not in failed:
                failed.add((name, boundary, size))
                table.note(f"{name} on {boundary}, {size}²: {' '.join(cost['message'].split())}")
    if picture:
        plot(picture, _panels(units), "nodes", "work units")
    return [table, memory(1024)]


def _costs(quick: bool, largest: int, count: int) -> Iterator[dict[str, Any]]:
    """Yield what a process with this many threads measures."""
    command = [sys.executable, str(FOLDER / "solver_cost.py"), "--largest", str(largest)]
    command += ["--quick", "--limit", "20"] if quick else []
    environment = {**os.environ, "OMP_NUM_THREADS": str(count)}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as process:
        assert process.stdout is not None
        yield from map(json.loads, process.stdout)
    if process.returncode:
        raise RuntimeError(f"solver_cost.py ended with code {process.returncode}")


def _panels(units: Units) -> list[tuple[str, Series]]:
    one = {boundary: of for (count, name, boundary), of in units.items() if (count, name) == (1, "winslow")}
    two = {boundary: of for (count, name, boundary), of in units.items() if (count, name) == (2, "winslow")}
    by_name = {name: of for (count, name, boundary), of in units.items() if (count, boundary) == (1, "wavy")}
    by_name = {name: by_name[name] for name in FUNCTIONALS if name in by_name}
    return [("winslow, 1 thread", one), ("winslow, 2 threads", two), ("wavy, 1 thread", by_name)]


_CHILD = """
import pathlib, resource, sys
import gridgen_sym as gg
method, size, steps = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
gg.optimize(gg.domain("wavy", 17, 17), "winslow", progress=False)
if size:
    grid = gg.domain("wavy", size, size)
    gg.optimize(grid, "winslow", method, tolerance=1e-8, max_iterations=steps, progress=False)
# On Linux ru_maxrss begins with the size of the parent; the high-water mark of /proc does not.
status = pathlib.Path("/proc/self/status")
lines = status.read_text().splitlines() if status.exists() else []
marks = [line.split()[1] for line in lines if line.startswith("VmHWM")]
print(marks[0] if marks else resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)
"""


def memory(size: int) -> Table:
    """Return the peak memory of both methods, in bytes per node, over that of a process that solves a 17 x 17 grid."""
    table = Table(
        f"Peak memory at {size} x {size} nodes",
        "Largest resident set of a process that makes the start grid and solves winslow on wavy, less that of one that "
        "solves 17 x 17 nodes, over the number of nodes (the start itself takes 16 bytes).",
        ("method", "bytes per node", "limit"),
    )
    for method, limit in (("newton", 700), ("local", 100)):
        # The local method needs the same memory in every sweep.
        peak, base = (_peak(method, of, 3 if method == "local" else 50) for of in (size, 0))
        table.add(method, (peak - base) / size**2, limit)
    return table


def _peak(method: str, size: int, steps: int) -> float:
    command = [sys.executable, "-c", _CHILD, method, str(size), str(steps)]
    told = subprocess.run(
        command, capture_output=True, text=True, check=True, env={**os.environ, "OMP_NUM_THREADS": "1"}
    )
    return float(told.stdout) * (1 if sys.platform == "darwin" else 1024)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer cases")
    parser.add_argument("--largest", type=int, help="side of the largest grid; 1024 if quick, else 2048")
    options = parser.parse_args()
    for result in run(options.quick, options.largest):
        print(result.markdown())
