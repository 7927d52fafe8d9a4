"""Measure Newton's method on many grids in this process; prints one line of JSON for each.

A process of its own for each number of threads: libraries read OMP_NUM_THREADS when they are loaded.
"""

from __future__ import annotations

import argparse
import json
import time
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from measure import fastest, start_grid, threads

import gridgen_sym as gg
from gridgen_sym.runtime import kernels, thread_count

DOMAINS = ("wavy", "swan", "horseshoe", "texas", "ohio")
FUNCTIONALS = ("winslow", "modified_liao", "knupp", "length")
TOLERANCE = 1e-8


@dataclass(frozen=True, slots=True)
class Cost:
    """The cost of one solve: seconds, and the seconds of one energy + gradient pass."""

    functional: str
    boundary: str
    size: int
    threads: int
    wall: float
    cpu: float
    unit: float
    steps: int
    outcome: str
    message: str
    disturbed: bool


def unit_of(grid: gg.Grid, name: str) -> float:
    """Return the seconds of one energy + gradient pass, its result preallocated."""
    coordinates = np.ascontiguousarray(grid.planes)
    kernel_set, gradient = kernels(gg.functional(name)), np.empty_like(coordinates)
    return fastest(lambda: kernel_set.energy_gradient(coordinates, out=gradient), runs=20, seconds=0.1).wall


def measure(boundary: str, name: str, size: int, *, runs: int, limit: float) -> Cost:
    """Solve from transfinite interpolation; the unit is measured before and after, the smaller counts."""
    grid = start_grid(boundary, size)
    before, kept = unit_of(grid, name), []

    def solve() -> None:
        begin = time.perf_counter()

        def look(step: gg.Step) -> None:
            if time.perf_counter() - begin > limit:
                raise KeyboardInterrupt  # optimize then returns what it has

        kept[:] = [gg.optimize(grid, name, tolerance=TOLERANCE, callback=look, progress=False)]

    with threads(1):
        single = unit_of(grid, name)
    first = fastest(solve, runs=1, seconds=0.0)
    best = fastest(solve, runs=runs - 1, seconds=0.0) if runs > 1 and first.wall < limit / 2 else first
    wall, cpu, unit = min(first.wall, best.wall), min(first.cpu, best.cpu), min(before, unit_of(grid, name))
    return Cost(
        functional=name,
        boundary=boundary,
        size=size,
        threads=thread_count(),
        wall=wall,
        cpu=cpu,
        unit=unit,
        steps=kept[0].iterations,
        outcome=_outcome(kept[0], limit),
        message=kept[0].message,
        disturbed=wall > 1.2 * cpu or (thread_count() > 1 and unit > 1.1 * single),
    )


def _outcome(result: gg.Result, limit: float) -> str:
    folded = result.quality.folded_cells
    if result.interrupted:
        return f"not within {limit:.0f} s"
    if folded:
        return f"{folded} cells stay folded"
    return "converged" if result.converged else "stopped early"


def cases(quick: bool) -> list[tuple[str, str]]:
    """Return (functional, boundary): every boundary for winslow; wavy for the others, or all with all."""
    others = DOMAINS[:1] if quick else DOMAINS
    return [("winslow", boundary) for boundary in DOMAINS] + [(f, b) for f in FUNCTIONALS[1:] for b in others]


def main() -> None:
    """Measure all cases; one that fails or takes too long is not tried on larger grids."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--largest", type=int, default=1024)
    parser.add_argument("--limit", type=float, default=60.0, help="seconds for one solve")
    options = parser.parse_args()
    for name in FUNCTIONALS:
        gg.optimize(start_grid("swan", 17), name, progress=False)
    for name, boundary in cases(options.quick):
        for size in (64, 128, 256, 512, 1024, 2048):
            if size > (256 if options.quick and name != "winslow" else options.largest):
                break
            runs = 5 if size <= 128 else 3 if size <= 512 else 2
            cost: dict[str, Any] = asdict(measure(boundary, name, size, runs=runs, limit=options.limit))
            print(json.dumps(cost), flush=True)
            if cost["outcome"] != "converged":
                break


if __name__ == "__main__":
    main()
