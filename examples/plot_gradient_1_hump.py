"""The gradient of a grid: a better hump in a channel
====================================================

A hump of a given area stands on the floor of a channel, and is to hold the flow back as little as it can. Its shape has
eight parameters; the grid has a wall at the floor and sides that slide; scikit-fem solves for the potential. The flow
depends on the nodes of the grid, and these on the parameters: `Result.vjp` gives the gradient in all of them for one
linear system, and ten steps of SciPy's L-BFGS find the better hump. Writes `hump.png`.
"""

import numpy as np
import skfem
from matplotlib.figure import Figure
from scipy.optimize import minimize
from skfem.helpers import ddot, div, dot, grad, prod

import gridgen_sym as gg

NI, NJ = 49, 17
X = np.linspace(0, 2, NI)
#: The modes of which the hump is made, zero with their slopes at its ends, and their areas.
MODES = np.stack([np.sin(np.pi * X / 2) * np.sin((k + 1) * np.pi * X / 2) for k in range(8)])
AREAS = MODES @ np.gradient(X)
AREA = 0.4


def heights(parameters):
    """Return the heights of the hump, whose area is what it should be whatever the parameters."""
    return AREA * parameters @ MODES / (parameters @ AREAS)


def grid_of(parameters):
    """Solve for the grid of a hump, with first cells of one height at the floor."""
    t = np.linspace(0, 1, NJ)[:, None]
    floor = np.stack([X, heights(parameters)], axis=-1)
    roof = np.stack([X, np.ones(NI)], axis=-1)
    left, right = floor[0] * (1 - t) + roof[0] * t, floor[-1] * (1 - t) + roof[-1] * t
    start = gg.transfinite(floor, roof, left, right)
    walls = {"bottom": gg.Wall(0.02)}
    return gg.optimize(start, "winslow", walls=walls, slide=("left", "right"), tolerance=1e-10)


@skfem.BilinearForm
def laplace(u, v, _):
    """The integral of |grad u|², as a bilinear form."""
    return dot(grad(u), grad(v))


@skfem.LinearForm
def moved(v, w):
    """The derivative of the integral of |grad phi|² as the nodes move by v, with phi held at them."""
    slope = w.phi.grad
    return dot(slope, slope) * div(v) - 2 * ddot(grad(v), prod(slope, slope))


def flow(grid):
    """Return the flow for a drop of 1 in the potential, and its derivatives in the nodes."""
    number = np.arange(NI * NJ).reshape(NI, NJ)
    cells = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]]).reshape(4, -1)
    mesh = skfem.MeshQuad(grid.xy.reshape(-1, 2).T.copy(), cells)
    basis = skfem.Basis(mesh, skfem.ElementQuad1())
    potential = np.zeros(NI * NJ)
    potential[number[0]] = 1.0
    given = np.concatenate([number[0], number[-1]])
    phi = skfem.solve(*skfem.condense(laplace.assemble(basis), x=potential, D=given))
    vectors = basis.with_element(skfem.ElementVector(skfem.ElementQuad1()))
    # phi minimizes the integral, so that its own change with the nodes has no part in the derivative.
    slopes = moved.assemble(vectors, phi=basis.interpolate(phi))
    return phi @ laplace.assemble(basis) @ phi, slopes[vectors.nodal_dofs].T.reshape(NI, NJ, 2)


def loss(parameters):
    """Return what is minimized, and its gradient in the parameters."""
    result = grid_of(parameters)
    through, cotangent = flow(result.grid)
    boundary = result.vjp(cotangent).boundary  # (ni, nj, 2); one linear system, whatever the number of parameters
    floor, area = boundary[:, 0, 1], parameters @ AREAS
    gradient = (AREA * MODES @ floor - floor @ heights(parameters) * AREAS) / area
    return -through, -gradient


first = np.zeros(8)
first[:4] = 10.0, 6.0, 6.0, -4.0
value, gradient = loss(first)
direction = np.cos(np.arange(8.0))
h = 1e-3
ahead, back = (loss(first + step * direction)[0] for step in (h, -h))
print(f"derivative along a direction: {gradient @ direction:.6e}, by a difference {(ahead - back) / (2 * h):.6e}")
assert abs(gradient @ direction - (ahead - back) / (2 * h)) < 1e-5 * np.abs(gradient).max()

found = minimize(loss, first, jac=True, method="L-BFGS-B", options={"maxiter": 10})
print(f"flow {-value:.5f}, after {found.nit} steps of L-BFGS {-found.fun:.5f}, without the hump 0.50000")
assert -found.fun > -value + 0.005

figure = Figure(figsize=(10, 5), layout="constrained")
for ax, parameters, title in zip(figure.subplots(2, 1), (first, found.x), ("at first", "after ten steps"), strict=True):
    gg.plot_grid(grid_of(parameters).grid, ax=ax, title=title)
figure.savefig("hump.png", dpi=150)
