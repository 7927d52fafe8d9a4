"""The Euler–Lagrange equations
============================

The classical Winslow solver, and Newton's method on the same equations.

Relaxation freezes the coefficients of the second derivatives while each node solves its own equations; Newton's method
uses the derived Jacobian. Both find the same grid.
"""

import numpy as np

import gridgen_sym as gg

start = gg.domain("chevron", 33, 33)
newton = gg.solve_euler_lagrange(start, "winslow", tolerance=1e-12)
relaxation = gg.solve_euler_lagrange(start, "winslow", "relaxation", tolerance=1e-12)

assert newton.converged
assert relaxation.converged
assert newton.quality.valid
assert np.abs(newton.grid.planes - relaxation.grid.planes).max() < 1e-9
print(f"Newton: {newton.iterations} steps; relaxation: {relaxation.iterations} sweeps")
gg.plot_grids([("Newton's method", newton.grid), ("relaxation", relaxation.grid)], "chevron.png")

# %%
# Winslow's equations even out the spacing that the boundary has. Control functions keep it: those of Thomas and
# Middlecoff carry it inwards.

xi, eta = np.meshgrid(np.linspace(0, 1, 25), np.linspace(0, 1, 17), indexing="ij")
radius, angle = 1 + np.expm1(3 * eta) / np.expm1(3), np.pi * (1 - xi) / 2
annulus = gg.Grid(np.stack((radius * np.cos(angle), radius * np.sin(angle)), axis=-1))
plain = gg.solve_euler_lagrange(annulus, "winslow")
controlled = gg.solve_euler_lagrange(annulus, "winslow", control="thomas-middlecoff")
assert controlled.converged
assert controlled.quality.valid
gg.plot_grids([("without control", plain.grid), ("Thomas and Middlecoff", controlled.grid)], "control.png")
