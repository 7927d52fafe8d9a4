"""A quadrilateral mesh of MFEM as a layout of blocks: gridgen_sym and TMOP on the same refined mesh, in one run.

    python benchmarks/layouts_mfem.py icf.mesh [--refine 8]

Needs `pip install mfem`. The mesh's own boundary stays in both. Prints processor seconds, on one thread, and the sum of
the condition numbers (g11 + g22)/J over the corners of all cells, that of Winslow's functional with steps of 1. TMOP
minimizes its shape metric 2, which is the same sum but for a constant, with Newton's method and MINRES as in
`peer_mfem.py`, until its energy no longer falls.
"""

from __future__ import annotations

import argparse
import os
import time

os.environ["OMP_NUM_THREADS"] = "1"

import mfem.ser as mfem
import numpy as np
from mfem._ser import tmop_modules
from scipy.spatial import cKDTree

import gridgen_sym as gg

#: Eisenstat and Walker's second choice, as MFEM's SetAdaptiveLinRtol(2, 0.5, 0.9), and the most steps.
_FIRST, _LARGEST, _FACTOR, _POWER, _STEPS = 0.5, 0.9, 0.9, 0.5 * (1 + 5**0.5), 100
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
    collection = mfem.H1_FECollection(1, 2)
    space = mfem.FiniteElementSpace(mesh, collection, 2, mfem.Ordering.byNODES)
    mesh.SetNodalFESpace(space)
    nodes = mfem.GridFunction(space)
    mesh.SetNodalGridFunction(nodes)
    nodes.SetTrueVector()
    outer = np.concatenate(
        [grid.planes[:, mask != 0].T for grid, mask in zip(layout.blocks, layout.outer, strict=True)]
    )
    apart, _ = cKDTree(outer).query(nodes.GetDataArray().reshape(2, -1).T)
    held = np.flatnonzero(apart < 1e-9 * np.ptp(outer))
    metric = tmop_modules.TMOP_Metric_002()
    target = tmop_modules.TargetConstructor(tmop_modules.TargetConstructor.IDEAL_SHAPE_UNIT_SIZE)
    target.SetNodes(nodes)
    integrator = tmop_modules.TMOP_Integrator(metric, target)
    rules = mfem.IntegrationRules(0, mfem.Quadrature1D.GaussLobatto)
    integrator.SetIntegrationRules(rules, 1)
    form = mfem.NonlinearForm(space)
    form.SetAssemblyLevel(mfem.AssemblyLevel_PARTIAL)
    integrator.thisown = 0
    form.AddDomainIntegrator(integrator)
    form.Setup()
    essential = mfem.intArray([*held.tolist(), *(held + space.GetTrueVSize() // 2).tolist()])
    form.SetEssentialTrueDofs(essential)
    linear = mfem.MINRESSolver()
    linear.SetMaxIter(2000)
    linear.SetAbsTol(0.0)
    jacobi = mfem.OperatorJacobiSmoother()
    jacobi.SetPositiveDiagonal(True)
    linear.SetPreconditioner(jacobi)
    newton = tmop_modules.TMOPNewtonSolver(rules.Get(mfem.Geometry.SQUARE, 1), 0)
    newton.SetIntegrationRules(rules, 1)
    newton.SetPreconditioner(linear)
    newton.SetMaxIter(1)
    newton.SetRelTol(1e-14)
    newton.SetAbsTol(0.0)
    newton.SetPrintLevel(-1)
    newton.SetOperator(form)
    vector, right, residual = nodes.GetTrueVector(), mfem.Vector(0), mfem.Vector(space.GetTrueVSize())
    tolerance, before, last = _FIRST, 0.0, np.inf
    begin = time.process_time()
    for step in range(_STEPS):
        form.Mult(vector, residual)
        norm = residual.Norml2()
        if step:
            safe = _FACTOR * tolerance**_POWER
            tolerance = _FACTOR * (norm / before) ** _POWER
            tolerance = min(_LARGEST, max(tolerance, safe) if safe > 0.1 else tolerance)
        before = norm
        linear.SetRelTol(tolerance)
        newton.Mult(right, vector)
        nodes.SetFromTrueVector()
        energy = 8 * form.GetGridFunctionEnergy(nodes) + 8 * mesh.GetNE()
        if last - energy < _LITTLE * energy:
            break
        last = energy
    return time.process_time() - begin, energy


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
