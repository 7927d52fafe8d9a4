"""The paper's adaptive weights
============================

Section 3.1 of the paper: the area functional with s = 5 + 200 abs(sin(2 pi x) sin(2 pi y)) on the unit square. A frozen
weight is to make s J constant: how much it varies over the cells (standard deviation over mean) is measured before and
after. The paper's few sweeps of one node at a time stop while the grid is still smooth; `gg.adapt` settles, with a
little of Winslow's functional beside the area.

The paper's second weight drops the absolute value and is negative on half of the square. Larger cells have less energy
there: the program refuses it, and where the user insists, it reports that the energy has no lower bound where cells may
fold.
"""

import numpy as np

import gridgen_sym as gg

FIRST, SECOND = "5 + 200*abs(sin(2*pi*x)*sin(2*pi*y))", "5 + 200*sin(2*pi*x)*sin(2*pi*y)"
start = gg.domain("square", 30, 30)  # An odd number of cells: no node on the lines x = 1/2 and y = 1/2.


def share_of_positive(grid):
    """Return the share of cells in which the second weight is positive."""
    xy = grid.xy
    x, y = np.moveaxis(xy[1:, 1:] + xy[:-1, 1:] + xy[1:, :-1] + xy[:-1, :-1], -1, 0) / 4
    return float((5 + 200 * np.sin(2 * np.pi * x) * np.sin(2 * np.pi * y) > 0).mean())


before = gg.equidistribution(start, FIRST).weight
swept = gg.optimize(start, "area", "local", weight=FIRST, max_iterations=6, keep_valid=True).grid
settled = gg.adapt(start, FIRST, monitor="values", boundary="fixed")
print(f"first weight, start:           s J {before}")
for name, grid in (("6 sweeps of area", swept), ("settled by gg.adapt", settled.grid)):
    after = gg.equidistribution(grid, FIRST).weight
    print(f"first weight, {name + ':':<21}s J {after}, {gg.quality(grid).folded_cells} folded cells")
    assert gg.quality(grid).valid
    assert after.variation < 0.6 * before.variation

try:
    gg.optimize(start, "area", weight=SECOND)
except gg.GridgenError as error:
    print(f"second weight: {error}")
insisted = gg.optimize(
    start, "area", "local", weight=gg.Weight(SECOND, allow_negative=True), max_iterations=2, keep_valid=True
)
print(f"insisted on: {insisted}")
shares = share_of_positive(start), share_of_positive(insisted.grid)
print(f"second weight: {shares[0]:.0%} of the cells are where it is positive at the start, then {shares[1]:.0%}")
assert "no lower bound" in insisted.message
assert insisted.quality.valid
assert shares[1] > shares[0]

panels = [
    ("first weight: 6 sweeps of area", swept),
    ("first weight: settled by gg.adapt", settled.grid),
    ("second weight: 2 sweeps of area", insisted.grid),
]
gg.plot_grids(panels, "weights.png")
