"""TMOP of MFEM through PyMFEM, on a grid, until an energy is reached."""

from __future__ import annotations

import mfem.ser as mfem
import numpy as np
from peer_clock import Clock
from tmop_newton import TmopNewton

import gridgen_sym as gg

_STEPS = 200


def tmop(grid: gg.Grid, clock: Clock) -> str:
    """Minimize; one Newton step at a time, so that the energy can be looked at between them."""
    ni, nj = grid.shape
    mesh = mfem.Mesh.MakeCartesian2D(ni - 1, nj - 1, mfem.Element.QUADRILATERAL, False, 1.0, 1.0, False)

    def place(nodes: mfem.GridFunction) -> None:
        nodes.GetDataArray()[:] = np.concatenate([plane.T.ravel() for plane in grid.planes])

    newton, corners = TmopNewton(mesh, place), 4 * (ni - 1) * (nj - 1)
    for step in range(_STEPS):
        clock.start()
        newton.step()
        clock.stop()
        if clock.look(newton.energy()):
            return f"reached after {step + 1} steps"
        if newton.norm < 1e-11 * max(1.0, corners) ** 0.5:
            break
    return f"no further progress after {step + 1} steps"
