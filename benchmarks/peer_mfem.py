"""TMOP of MFEM through PyMFEM, as its authors advise to tune it.

Shape metric 2 is (|T|²/det T)/2 - 1; with ideal targets of unit size T is the Jacobian matrix of the cell, and with
Gauss–Lobatto points of order 1 the sum over the corners is (winslow - 2 x corners)/8.
"""

from __future__ import annotations

import mfem.ser as mfem
import numpy as np
from mfem._ser import tmop_modules
from peer_clock import Clock

import gridgen_sym as gg

#: Eisenstat and Walker's second choice, as MFEM's SetAdaptiveLinRtol(2, 0.5, 0.9).
_FIRST, _LARGEST, _FACTOR, _POWER = 0.5, 0.9, 0.9, 0.5 * (1 + 5**0.5)
_STEPS = 200


def tmop(grid: gg.Grid, clock: Clock) -> str:
    """Minimize; one Newton step at a time, so that the energy can be looked at between them."""
    ni, nj = grid.shape
    mesh = mfem.Mesh.MakeCartesian2D(ni - 1, nj - 1, mfem.Element.QUADRILATERAL, False, 1.0, 1.0, False)
    collection = mfem.H1_FECollection(1, 2)
    space = mfem.FiniteElementSpace(mesh, collection, 2, mfem.Ordering.byNODES)
    mesh.SetNodalFESpace(space)
    nodes = mfem.GridFunction(space)
    mesh.SetNodalGridFunction(nodes)
    nodes.GetDataArray()[:] = np.concatenate([plane.T.ravel() for plane in grid.planes])
    nodes.SetTrueVector()
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
    boundary = mfem.intArray(mesh.bdr_attributes.Max())
    boundary.Assign(1)
    form.SetEssentialBC(boundary)
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
    corners = 4 * (ni - 1) * (nj - 1)
    tolerance, before = _FIRST, 0.0
    clock.start()
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
        clock.stop()
        nodes.SetFromTrueVector()
        if clock.look(8 * form.GetGridFunctionEnergy(nodes) + 2 * corners):
            return f"reached after {step + 1} steps"
        if norm < 1e-11 * max(1.0, corners) ** 0.5:
            break
        clock.start()
    return f"no further progress after {step + 1} steps"
