"""The paper's adaptive weights
============================

Section 4.1 of the paper: the area functional with s = 5 + 200 abs(sin(2 pi x) sin(2 pi y)) on the unit square. Areas
alone do not keep cells from folding: the program stops at the last valid grid, and says so. The paper's second weight
drops the absolute value and is negative on half of the square, where larger cells have less energy, without end: the
program refuses it.
"""

import gridgen_sym as gg

start = gg.domain("square", 41, 41)
product = "sin(2*pi*x)*sin(2*pi*y)"
result = gg.optimize(start, "area", weight=f"5 + 200*abs({product})", max_iterations=60)
print(result)
assert result.quality.folded_cells == 0

try:
    gg.optimize(start, "area", weight=f"5 + 200*({product})")
except gg.GridgenError as error:
    print(error)
    refused = True
assert refused

gg.plot_grid(result.grid, "weights.png", title="s = 5 + 200 |sin(2πx) sin(2πy)|")
