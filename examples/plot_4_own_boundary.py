"""Your own boundary
=================

Four arrays of points, a grid between them, and a PLOT3D file.

Bottom and top have the same number of points, and so have left and right; sides that meet share their corner.
Writes `nozzle.xyz`.
"""

import numpy as np

import gridgen_sym as gg

x = np.linspace(-1.0, 1.0, 61)
height = 0.5 - 0.25 * np.exp(-8 * x**2)  # A nozzle with its throat at x = 0.
bottom, top = np.stack([x, -height], axis=1), np.stack([x, height], axis=1)
left = np.linspace(bottom[0], top[0], 21)
right = np.linspace(bottom[-1], top[-1], 21)

result = gg.optimize(gg.transfinite(bottom, top, left, right), "winslow")
result.grid.write("nozzle.xyz")

again = gg.read("nozzle.xyz")
assert again == result.grid
assert again.shape == (61, 21)
assert result.quality.valid
print(result.quality)
gg.plot_grid(result.grid, "nozzle.png", title="a nozzle")
