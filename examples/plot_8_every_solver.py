"""Every solver on one grid
========================

Two ways to the minimum of the discrete energy, and two ways to the solution of its Euler-Lagrange equations. All four
start from the same grid. The first two find the same minimum, the other two the same solution. The distance
between the two is the discretization error, which falls with the square of the mesh width.
"""

import numpy as np
from matplotlib.figure import Figure

import gridgen_sym as gg

start = gg.domain("wavy", 33, 33)
results = {
    "newton": gg.optimize(start, "winslow", tolerance=1e-9),
    "local": gg.optimize(start, "winslow", "local", tolerance=1e-9),
    "euler-lagrange": gg.solve_euler_lagrange(start, "winslow", tolerance=1e-9),
    "relaxation": gg.solve_euler_lagrange(start, "winslow", "relaxation", tolerance=1e-9),
}

axes = (figure := Figure(figsize=(7, 4), layout="constrained")).add_subplot()
for name, result in results.items():
    assert result.converged
    assert result.quality.valid
    print(f"{name:<15} {result.iterations:>4} iterations, energy {result.energy:.10g}")
    norms = np.array([step.gradient_norm for step in result.history])
    axes.semilogy(norms / norms[0], marker="o" if len(norms) < 20 else "", label=name)
axes.set(xlabel="Newton step, or sweep", ylabel="norm of the gradient or residual, relative", xscale="symlog")
axes.legend()
figure.savefig("solvers.png", dpi=120)

assert abs(results["local"].energy / results["newton"].energy - 1) < 1e-9
planes = {name: result.grid.planes for name, result in results.items()}
assert np.abs(planes["euler-lagrange"] - planes["relaxation"]).max() < 1e-6
