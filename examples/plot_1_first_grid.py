"""A first grid
============

The swan: its transfinite grid is folded, the Winslow grid is not.

Writes `swan.vts` and `swan.png`.
"""

import gridgen_sym as gg

start = gg.domain("swan", 41, 41)
result = gg.optimize(start, "winslow")

assert gg.quality(start).folded_cells == 57
assert result.converged
assert result.quality.folded_cells == 0

result.grid.write("swan.vts")
gg.plot_grids([("transfinite interpolation", start), ("winslow", result.grid)], "swan.png")
print(result.quality)
