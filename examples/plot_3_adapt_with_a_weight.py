"""Adapt a grid with a weight
==========================

The area functional with a weight s makes cells small where the weight is large.

A frozen weight makes s·J constant; one that is differentiated through, sqrt(s)·J. Areas alone do not say how the lines
run: many grids have these areas, and the one that is found swirls. Writes `adapted.png`.
"""

import numpy as np

import gridgen_sym as gg

start = gg.domain("square", 41, 41)
formula = "1 + 4*exp(-20*((x - 0.5)**2 + (y - 0.5)**2))"
results = {mode: gg.optimize(start, "area", weight=gg.Weight(formula, mode)) for mode in ("frozen", "differentiated")}


def spread(grid: gg.Grid, power: float) -> float:
    """Return by how much s**power times a cell's area varies: its standard deviation over its mean."""
    xy = grid.xy
    x, y = np.moveaxis(xy[1:, 1:] + xy[:-1, 1:] + xy[1:, :-1] + xy[:-1, :-1], -1, 0) / 4
    (a, b), (c, d) = np.moveaxis(xy[1:, 1:] - xy[:-1, :-1], -1, 0), np.moveaxis(xy[:-1, 1:] - xy[1:, :-1], -1, 0)
    product = (1 + 4 * np.exp(-20 * ((x - 0.5) ** 2 + (y - 0.5) ** 2))) ** power * (a * d - b * c) / 2
    return float(product.std() / product.mean())


for mode, power in (("frozen", 1.0), ("differentiated", 0.5)):
    grid = results[mode].grid
    print(
        f"{mode}: s**{power:g} J varies by {spread(start, power):.1%} at the start, then by {spread(grid, power):.1%}"
    )
    assert results[mode].converged
    assert results[mode].quality.valid
    assert spread(grid, power) < 0.01 < 0.25 < spread(start, power)

gg.plot_grids([(f"weight {mode}", result.grid) for mode, result in results.items()], "adapted.png")
