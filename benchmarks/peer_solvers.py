"""The solvers of the race: each starts the clock, and stops it to let it look at the energy after every iteration."""

from __future__ import annotations

from typing import Any

import numpy as np
from peer_clock import Clock

import gridgen_sym as gg
from gridgen_sym.arrays import Array
from gridgen_sym.runtime import kernels


class _ReachedError(Exception):
    """Raised in a callback, to end a solver that has nothing better to offer."""


def solve(peer: str, grid: gg.Grid, clock: Clock) -> str:
    """Minimize with the solver of this name; return why it stopped."""
    if peer == "gridgen_sym":
        return _own(grid, clock)
    if peer == "numba_superlu":
        from peer_numba import newton

        return newton(np.ascontiguousarray(grid.planes), clock)
    if peer == "mfem_tmop":
        from peer_mfem import tmop

        return tmop(grid, clock)
    return _scipy(peer, grid, clock)


def _own(grid: gg.Grid, clock: Clock) -> str:
    def look(step: gg.Step) -> None:
        clock.stop()
        if step.stage == "minimize" and step.shape == grid.shape:
            clock.look(step.energy)
        clock.start()

    clock.start()
    result = gg.optimize(grid, "winslow", tolerance=1e-10, spacing="index", callback=look, progress=False)
    clock.stop()
    return result.message


def _scipy(peer: str, grid: gg.Grid, clock: Clock) -> str:
    from scipy.optimize import minimize

    kernel_set = kernels(gg.functional("winslow"))
    # The functional does not depend on the scale; with edges of about 1, first steps of length 1 are sensible.
    planes, size = grid.planes * max(grid.shape), (grid.shape[0] - 2) * (grid.shape[1] - 2)
    gradient, refused = np.empty_like(planes), 10 * kernel_set.energy(planes)[0]

    def place(free: Array) -> None:
        planes[:, 1:-1, 1:-1] = free.reshape(2, grid.shape[0] - 2, grid.shape[1] - 2)

    def value(free: Array) -> tuple[float, Array]:
        place(free)
        energy, smallest, _ = kernel_set.energy_gradient(planes, out=gradient)
        # A fold is refused: the line searches then try a shorter step.
        return (energy if smallest > 0 else refused), gradient[:, 1:-1, 1:-1].ravel()

    def hessian(free: Array) -> Any:
        place(free)
        # gridgen_sym numbers the unknowns node by node; here all x come first, then all y.
        order = np.arange(2 * size).reshape(2, size).T.ravel()
        matrix = gg.hessian(gg.Grid.from_planes(planes[0], planes[1]), "winslow", spacing="index").tocsr()
        back = np.argsort(order)
        return matrix[back][:, back]

    def look(free: Array) -> None:
        clock.stop()
        energy, _ = value(free)
        if clock.look(energy):
            raise _ReachedError
        clock.start()

    start = planes[:, 1:-1, 1:-1].ravel().copy()
    many = {"maxiter": 200_000}
    clock.start()
    try:
        if peer == "newton_cg":
            found = minimize(
                value, start, jac=True, hess=hessian, method="Newton-CG", callback=look, options={**many, "xtol": 1e-13}
            )
        else:
            options = {**many, "maxfun": 400_000, "ftol": 0.0, "gtol": 0.0, "maxcor": 20}
            found = minimize(value, start, jac=True, method="L-BFGS-B", callback=look, options=options)
    except _ReachedError:
        return "reached"
    return str(found.message)
