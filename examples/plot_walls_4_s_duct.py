"""An S-duct
=========

An intake whose axis moves aside while it widens by a third. The first cells at both walls, for y+ = 30 of wall
functions, grow with the duct: `first` is an array along the wall. Writes `s_duct.png`.
"""

import numpy as np
from matplotlib.figure import Figure

import gridgen_sym as gg

t = np.linspace(0, 1, 121)
step = t**3 * (10 - 15 * t + 6 * t**2)  # From 0 to 1, with curvature 0 at both ends.
axis = np.stack([4 * t, 1.2 * step], -1)
slope = np.gradient(axis, t, axis=0)
normal = np.stack([-slope[:, 1], slope[:, 0]], -1) / np.hypot(*slope.T)[:, None]
width = 1 + step / 3
lower, upper = axis - normal * width[:, None] / 2, axis + normal * width[:, None] / 2

outline = gg.Outline(np.concatenate([lower, upper[::-1]]), corners=(0, 120, 121, 241), name="S-duct")
first = gg.first_height(reynolds=2e5, yplus=30)
ends = {side: f"tanh:first={h},last={h}" for side, h in (("left", first), ("right", first * width[-1]))}
start = outline.grid(121, 33, spacing={**ends, "bottom": "equal", "top": "equal"})
walls = {side: gg.Wall(first * width) for side in ("bottom", "top")}
result = gg.optimize(start, "winslow", walls=walls)
assert result.converged
assert result.quality.valid

height = np.hypot(*(result.grid.xy[:, 1] - result.grid.xy[:, 0]).T)
print(f"first cells at the lower wall: {height[0]:.4f} at the inlet, {height[-1]:.4f} at the outlet")
assert np.abs(height / (first * width) - 1).max() < 0.02

figure = Figure(figsize=(12, 4.5), layout="constrained")
whole, near = figure.subplots(1, 2, width_ratios=(2, 1))
gg.plot_grid(result.grid, ax=whole, title="the S-duct")
gg.plot_grid(result.grid, ax=near, title="the lower wall, where it turns up")
near.set(xlim=(1.2, 2.0), ylim=(-0.42, 0.38))
figure.savefig("s_duct.png", dpi=150)
