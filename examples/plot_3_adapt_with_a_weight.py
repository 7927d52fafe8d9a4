"""Adapt a grid with a weight
==========================

The area functional with a weight s makes cells small where the weight is large.

A frozen weight makes s·J constant; a differentiated one, sqrt(s)·J. Areas alone do not determine the grid lines: many
grids have these areas, and the computed one swirls. A little of winslow selects a smooth grid. J is that of the map of
the unit square, 1 on average here, so the factor k must be small compared with s. Writes `adapted.png`.
"""

import numpy as np

import gridgen_sym as gg

start = gg.domain("square", 41, 41)
formula = "1 + 4*exp(-20*((x - 0.5)**2 + (y - 0.5)**2))"
results = {mode: gg.optimize(start, "area", weight=gg.Weight(formula, mode)) for mode in ("frozen", "differentiated")}
results["frozen, with a little of winslow"] = gg.optimize(start, "area_winslow", weight=formula, parameters={"k": 2e-3})


def spread(grid: gg.Grid, power: float) -> float:
    """Return by how much s**power times a cell's area varies: its standard deviation over its mean."""
    xy = grid.xy
    x, y = np.moveaxis(xy[1:, 1:] + xy[:-1, 1:] + xy[1:, :-1] + xy[:-1, :-1], -1, 0) / 4
    (a, b), (c, d) = np.moveaxis(xy[1:, 1:] - xy[:-1, :-1], -1, 0), np.moveaxis(xy[:-1, 1:] - xy[1:, :-1], -1, 0)
    product = (1 + 4 * np.exp(-20 * ((x - 0.5) ** 2 + (y - 0.5) ** 2))) ** power * (a * d - b * c) / 2
    return float(product.std() / product.mean())


for mode, result in results.items():
    grid, power = result.grid, 0.5 if mode == "differentiated" else 1.0
    print(
        f"{mode}: s**{power:g} J varies by {spread(start, power):.1%} at the start, then by {spread(grid, power):.1%}"
    )
    assert result.converged
    assert result.quality.valid
    assert spread(grid, power) < 0.01 < 0.25 < spread(start, power)

# The square and the weight are symmetric: so is the smooth grid.
swirl = {mode: float(np.abs(result.grid.x + result.grid.x[::-1] - 1).max()) for mode, result in results.items()}
print("from symmetry: " + ", ".join(f"{mode} {distance:.1e}" for mode, distance in swirl.items()))
assert swirl["frozen"] > 0.05
assert swirl["frozen, with a little of winslow"] < 1e-6

gg.plot_grids([(mode, result.grid) for mode, result in results.items()], "adapted.png")
