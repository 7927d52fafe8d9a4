"""Solving and adapting in turns
==============================

The paper asks for weights from a posteriori estimates of the error. Here scikit-fem solves on the quadrilaterals of the
grid, `gg.adapt` makes a density of nodes of the solution alone, and moves the nodes; then the equations are solved
again. Poisson's equation has a circular shock or a ring for its solution, advection and diffusion have boundary layers
of width 1/50 at two sides. The density is that of the curvature, or that of the estimate of Zienkiewicz and Zhu. The L2
errors are those of bilinear elements against the exact solutions, at equal numbers of nodes. The smooth grid is that of
Winslow's functional, on the square the uniform one; 17 x 17 nodes are too few to resolve the ring.
"""

import numpy as np
import skfem
from matplotlib.figure import Figure
from skfem.helpers import dot, grad

import gridgen_sym as gg

WIDTH = 0.02  # The diffusivity, and so the width of the boundary layers.


def bump(x, y, slope, center, radius):
    """Return a tanh of the distance from a circle, and minus its Laplacian."""
    r = np.maximum(np.hypot(x - center, y - center), 1e-12)
    t = np.tanh(slope * (r - radius))
    return t, slope * (1 - t**2) * (2 * slope * t - 1 / r)


def shock(x, y):
    """Return a solution of Poisson's equation: a quarter of a circle round a corner of the square."""
    return bump(x, y, 50, 0, 0.5)[0]


def ring(x, y):
    """Return another: a whole circle."""
    return bump(x, y, 40, 0.5, 0.25)[0]


def layer(x, y):
    """Return the solution of advection and diffusion, zero at the sides, with its layers at x = 1 and y = 1."""
    return profile(x) * profile(y)


def profile(x):
    """Return the solution of - WIDTH u'' + u' = 1 that is zero at 0 and 1."""
    return x - (np.exp((x - 1) / WIDTH) - np.exp(-1 / WIDTH)) / (1 - np.exp(-1 / WIDTH))


def layer_source(x, y):
    """Return - WIDTH Laplacian u + u_x + u_y."""
    return profile(x) + profile(y)


def solver(exact, source, diffusion, velocity):
    """Return a function of a grid: the nodal values of the solution by bilinear elements on its cells."""

    @skfem.BilinearForm
    def operator(u, v, w):
        return diffusion * dot(grad(u), grad(v)) + velocity * (grad(u)[0] + grad(u)[1]) * v

    @skfem.LinearForm
    def load(v, w):
        return source(*w.x) * v

    def solve(grid):
        number = np.arange(grid.x.size).reshape(grid.shape)
        cells = np.stack((number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]))
        mesh = skfem.MeshQuad(grid.planes.reshape(2, -1), cells.reshape(4, -1))
        basis = skfem.Basis(mesh, skfem.ElementQuad1(), intorder=6)
        boundary, u = mesh.boundary_nodes(), np.zeros(basis.N)
        u[boundary] = exact(*mesh.p[:, boundary])
        system = skfem.condense(operator.assemble(basis), load.assemble(basis), x=u, D=boundary)
        return skfem.solve(*system).reshape(grid.shape)

    return solve


PROBLEMS = {
    "Poisson, circular shock": ("square", shock, solver(shock, lambda x, y: bump(x, y, 50, 0, 0.5)[1], 1.0, 0.0)),
    "Poisson, ring": ("wavy", ring, solver(ring, lambda x, y: bump(x, y, 40, 0.5, 0.25)[1], 1.0, 0.0)),
    "advection and diffusion": ("square", layer, solver(layer, layer_source, WIDTH, 1.0)),
}
SIZES = (17, 33, 65)
WAYS = ("uniform", "smooth", "curvature", "recovery_error")

figure = Figure(figsize=(10, 7), layout="constrained")
print(f"{'problem':<24} {'nodes':>7} " + " ".join(f"{way:>14}" for way in WAYS))
for k, (name, (domain, exact, solve)) in enumerate(PROBLEMS.items()):
    errors = []
    for nodes in SIZES:
        uniform = gg.domain(domain, nodes, nodes)
        smooth = gg.optimize(uniform, "winslow").grid
        pairs = [(grid, solve(grid)) for grid in (uniform, smooth)]
        for monitor in WAYS[2:]:
            result = gg.adapt(smooth, solve, monitor=monitor, max_iterations=6)
            assert result.quality.folded_cells == 0
            pairs.append((result.grid, result.values))
            if (nodes, monitor) == (33, "recovery_error"):
                axes = figure.add_subplot(2, 3, k + 1)
                low, high = result.values.min(), result.values.max()
                pale = {"vmin": low - (high - low) / 2, "vmax": high + (high - low) / 2}
                axes.pcolormesh(*result.grid.planes, result.values, shading="gouraud", cmap="coolwarm", **pale)
                gg.plot_grid(result.grid, ax=axes)
                axes.set_title(name, fontsize=9)
        errors.append([gg.interpolation_error(grid, exact, values) for grid, values in pairs])
        row = " ".join(f"{error:>14.2e}" for error in errors[-1])
        print(f"{name:<24} {nodes:>3}^2   {row}")
        assert max(errors[-1][2:]) < min(errors[-1][:2]) / (3 if nodes >= 33 else 1)
    axes = figure.add_subplot(2, 3, k + 4)
    for way, line in zip(WAYS, zip(*errors, strict=True), strict=True):
        axes.loglog(SIZES, line, "--" if way == "smooth" else "-", marker="o", label=way)
    axes.set(xlabel="nodes along a side", ylabel="L2 error of the solution")
    axes.set_xticks(SIZES, [str(nodes) for nodes in SIZES])
    axes.minorticks_off()
    axes.legend(fontsize=7)
figure.savefig("equations.png", dpi=120)
