"""A quadrilateral mesh of MFEM as a layout of blocks: gridgen_sym and TMOP on the same refined mesh, in one run.

    python benchmarks/layouts_mfem.py icf.mesh [--refine 8]

Needs `pip install mfem`. The mesh's own boundary stays in both. Prints processor seconds, on one thread, and the sum of
the condition numbers (g11 + g22)/J over the corners of all cells, that of Winslow's functional with steps of 1. TMOP
minimizes its shape metric 2, which is the same sum but for a constant, until its energy no longer falls.
"""

from __future__ import annotations

import argparse
import os
import time

os.environ["OMP_NUM_THREADS"] = "1"

import mfem.ser as mfem
import numpy as np
from scipy.spatial import cKDTree
from tmop_newton import TmopNewton

import gridgen_sym as gg

#: The most steps.
_STEPS = 100
#: TMOP has ended where a step lowers the energy by less than this part.
_LITTLE = 1e-10
_REPEATS = 3


def solve(layout: gg.MultiBlock) -> tuple[float, float, gg.LayoutResult]:
    """Return the least processor seconds of some runs, the sum of condition numbers, and the result."""
    seconds = []
    for _ in range(_REPEATS):
        begin = time.process_time()
        result = gg.optimize(layout, "winslow", progress=False)
        seconds.append(time.process_time() - begin)
    assert result.converged
    assert result.quality.valid
    return min(seconds), gg.energy(result.grid, "winslow", spacing="index"), result


def tmop(path: str, refine: int, layout: gg.MultiBlock) -> tuple[float, float]:
    """Return processor seconds and the sum of condition numbers; nodes at the layout's outer boundary stay."""
    mesh = mfem.Mesh(path, 1, 1)
    for _ in range(round(np.log2(refine))):
        mesh.UniformRefinement()
    mesh.SetCurvature(1)
    blocks = zip(layout.blocks, layout.outer, strict=True)
    outer = np.concatenate([grid.planes[:, mask != 0].T for grid, mask in blocks])

    def held(nodes: np.ndarray) -> list[int]:
        apart, _ = cKDTree(outer).query(nodes.T)
        return [int(number) for number in np.flatnonzero(apart < 1e-9 * np.ptp(outer))]

    newton, last = TmopNewton(mesh, held=held), np.inf
    seconds = 0.0
    for _ in range(_STEPS):
        begin = time.process_time()
        newton.step()
        seconds += time.process_time() - begin
        energy = newton.energy()
        if last - energy < _LITTLE * energy:
            break
        last = energy
    return seconds, energy


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mesh", help="of quadrilaterals, in MFEM's format")
    parser.add_argument("--refine", type=int, default=8, help="cells along a side of a quadrilateral, a power of 2")
    given = parser.parse_args()
    layout = gg.read_layout(given.mesh, refine=given.refine)
    (seconds, energy, _), (others, other) = solve(layout), tmop(given.mesh, given.refine, layout)
    print(f"{len(layout)} blocks, {layout.node_count} nodes\n")
    print("| | s | sum of condition numbers |\n| --- | --- | --- |")
    print(f"| `gg.optimize` | {seconds:.3f} | {energy:.3f} |")
    print(f"| TMOP | {others:.2f} ({others / seconds:.0f} times) | {other:.3f} |")


if __name__ == "__main__":
    main()
