"""TMOP's Newton method as its authors advise to tune it, on a mesh of MFEM, step by step.

Shape metric 2 is (|T|²/det T)/2 - 1; with ideal targets of unit size T is the Jacobian matrix of the cell, and with
Gauss–Lobatto points of order 1 the sum over the corners is (winslow - 2 x corners)/8. The linear systems are solved by
MINRES with Jacobi's preconditioner.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import mfem.ser as mfem
import numpy as np
from mfem._ser import tmop_modules

#: Eisenstat and Walker's second choice, as MFEM's SetAdaptiveLinRtol(2, 0.5, 0.9).
_FIRST, _LARGEST, _FACTOR, _POWER = 0.5, 0.9, 0.9, 0.5 * (1 + 5**0.5)


class TmopNewton:
    """Newton's method on the nodes of a mesh.

    Attributes:
        nodes: of the mesh; `energy` brings it up to date.
        norm: of the gradient before the last step.
    """

    def __init__(
        self,
        mesh: mfem.Mesh,
        place: Callable[[mfem.GridFunction], None] | None = None,
        held: Callable[[np.ndarray], Sequence[int]] | None = None,
    ) -> None:
        """Set up.

        Args:
            mesh: of quadrilaterals.
            place: puts the nodes where they begin; by default they stay.
            held: returns the numbers of the nodes that stay, from the coordinates (2, nodes); by default all at the
                boundary.
        """
        # MFEM's objects refer to each other without owning them.
        self._mesh, self._collection = mesh, mfem.H1_FECollection(1, 2)
        self._space = mfem.FiniteElementSpace(mesh, self._collection, 2, mfem.Ordering.byNODES)
        mesh.SetNodalFESpace(self._space)
        self.nodes = mfem.GridFunction(self._space)
        mesh.SetNodalGridFunction(self.nodes)
        if place is not None:
            place(self.nodes)
        self.nodes.SetTrueVector()
        self._metric = tmop_modules.TMOP_Metric_002()
        self._target = tmop_modules.TargetConstructor(tmop_modules.TargetConstructor.IDEAL_SHAPE_UNIT_SIZE)
        self._target.SetNodes(self.nodes)
        integrator = tmop_modules.TMOP_Integrator(self._metric, self._target)
        self._rules = mfem.IntegrationRules(0, mfem.Quadrature1D.GaussLobatto)
        integrator.SetIntegrationRules(self._rules, 1)
        self._form = mfem.NonlinearForm(self._space)
        self._form.SetAssemblyLevel(mfem.AssemblyLevel_PARTIAL)
        integrator.thisown = 0
        self._form.AddDomainIntegrator(integrator)
        self._form.Setup()
        self._hold(held)
        self._linear = mfem.MINRESSolver()
        self._linear.SetMaxIter(2000)
        self._linear.SetAbsTol(0.0)
        self._jacobi = mfem.OperatorJacobiSmoother()
        self._jacobi.SetPositiveDiagonal(True)
        self._linear.SetPreconditioner(self._jacobi)
        self._newton = tmop_modules.TMOPNewtonSolver(self._rules.Get(mfem.Geometry.SQUARE, 1), 0)
        self._newton.SetIntegrationRules(self._rules, 1)
        self._newton.SetPreconditioner(self._linear)
        self._newton.SetMaxIter(1)
        self._newton.SetRelTol(1e-14)
        self._newton.SetAbsTol(0.0)
        self._newton.SetPrintLevel(-1)
        self._newton.SetOperator(self._form)
        self._vector, self._right = self.nodes.GetTrueVector(), mfem.Vector(0)
        self._residual = mfem.Vector(self._space.GetTrueVSize())
        self._tolerance, self.norm = _FIRST, 0.0

    def _hold(self, held: Callable[[np.ndarray], Sequence[int]] | None) -> None:
        if held is None:
            self._fixed = mfem.intArray(self._mesh.bdr_attributes.Max())
            self._fixed.Assign(1)
            self._form.SetEssentialBC(self._fixed)
            return
        numbers = list(held(self.nodes.GetDataArray().reshape(2, -1)))
        count = self._space.GetTrueVSize() // 2
        self._fixed = mfem.intArray([*numbers, *(number + count for number in numbers)])
        self._form.SetEssentialTrueDofs(self._fixed)

    def step(self) -> None:
        """Take one step."""
        self._form.Mult(self._vector, self._residual)
        norm = self._residual.Norml2()
        if self.norm:
            safe = _FACTOR * self._tolerance**_POWER
            wanted = _FACTOR * (norm / self.norm) ** _POWER
            self._tolerance = min(_LARGEST, max(wanted, safe) if safe > 0.1 else wanted)
        self.norm = norm
        self._linear.SetRelTol(self._tolerance)
        self._newton.Mult(self._right, self._vector)

    def energy(self) -> float:
        """Return Winslow's energy, the sum over the corners of all cells of (g11 + g22)/J."""
        self.nodes.SetFromTrueVector()
        return float(8 * self._form.GetGridFunctionEnergy(self.nodes) + 8 * self._mesh.GetNE())
