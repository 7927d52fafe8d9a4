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
from measure import Timing, fastest, start_grid, threads

import gridgen_sym as gg
from gridgen_sym.runtime import kernels, thread_count

#: The two real outlines have valid grids of every size: borders whose nodes turn the wrong way at a corner have none.
DOMAINS = ("wavy", "swan", "horseshoe", "ohio", "nlf416_half_o")
FUNCTIONALS = ("winslow", "modified_liao", "knupp", "length")
TOLERANCE = 1e-8


@dataclass(frozen=True, slots=True)
class Cost:
    """The cost of one solve in seconds, and that of one energy + gradient pass.

    Attributes:
        unit: seconds of one pass: of the processor on one thread, wall seconds on several.
        units: passes that cost as much as the solve, by the same clock.
        disturbed: whether others had the processor, or the memory, so much that `units` measures them.
    """

    functional: str
    boundary: str
    size: int
    threads: int
    wall: float
    cpu: float
    unit: float
    units: float
    steps: int
    outcome: str
    message: str
    disturbed: bool


def unit_of(grid: gg.Grid, name: str) -> Timing:
    """Measure one energy + gradient pass, its result preallocated."""
    coordinates = np.ascontiguousarray(grid.planes)
    kernel_set, gradient = kernels(gg.functional(name)), np.empty_like(coordinates)
    return fastest(lambda: kernel_set.energy_gradient(coordinates, out=gradient), runs=20, seconds=0.1)


def measure(boundary: str, name: str, size: int, *, runs: int, limit: float) -> Cost:
    """Solve from transfinite interpolation; the unit is measured before and after, the smaller counts.

    On one thread the clock is the processor's: it stands still while others have the processor. Several threads are
    there to save wall time, and wait for each other: there wall seconds count, and the row is disturbed where the
    process had less than one processor, or where a pass took longer than on one thread. Any row is where the passes
    before and after the solve differ by a quarter.
    """
    grid = start_grid(boundary, size)
    before, kept = unit_of(grid, name), []

    def solve() -> None:
        begin = time.process_time()

        def look(step: gg.Step) -> None:
            if time.process_time() - begin > limit:
                raise KeyboardInterrupt  # optimize then returns what it has

        kept[:] = [gg.optimize(grid, name, tolerance=TOLERANCE, callback=look, progress=False)]

    with threads(1):
        single = unit_of(grid, name)
    first = fastest(solve, runs=1, seconds=0.0)
    best = fastest(solve, runs=runs - 1, seconds=0.0) if runs > 1 and first.cpu < limit / 2 else first
    after, wall, cpu = unit_of(grid, name), min(first.wall, best.wall), min(first.cpu, best.cpu)
    several = thread_count() > 1
    passes = (before.wall, after.wall) if several else (before.cpu, after.cpu)
    alone = not several or (wall < 1.2 * cpu and min(passes) < 1.1 * single.wall)
    return Cost(
        functional=name,
        boundary=boundary,
        size=size,
        threads=thread_count(),
        wall=wall,
        cpu=cpu,
        unit=min(passes),
        units=(wall if several else cpu) / min(passes),
        steps=kept[0].iterations,
        outcome=_outcome(kept[0], limit),
        message=kept[0].message,
        disturbed=not alone or max(passes) > 1.25 * min(passes),
    )


def _outcome(result: gg.Result, limit: float) -> str:
    folded = result.quality.folded_cells
    if result.interrupted:
        return f"not within {limit:.0f} processor seconds"
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
    parser.add_argument("--largest", type=int, required=True)
    parser.add_argument("--limit", type=float, default=40.0, help="processor seconds for one solve")
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
