"""An estuary
==========

A funnel from the sea to a river, with shallow sides and a deep channel. Tidal flats need narrow cells along both banks,
of a hundredth of the local width. The nodes of the banks slide first, so that lines cross them at right angles, as
ocean models ask for.
Writes `estuary.png`.
"""

import numpy as np
from matplotlib.figure import Figure

import gridgen_sym as gg

t = np.linspace(0, 1, 121)
axis = np.stack([40 * t, 4 * np.sin(2.2 * np.pi * t) * t], -1)  # In km, from the sea to the tidal limit.
slope = np.gradient(axis, t, axis=0)
normal = np.stack([-slope[:, 1], slope[:, 0]], -1) / np.hypot(*slope.T)[:, None]
width = 1 + 5 * np.exp(-3 * t)
right, left = axis - normal * width[:, None] / 2, axis + normal * width[:, None] / 2

outline = gg.Outline(np.concatenate([right, left[::-1]]), corners=(0, 120, 121, 241), name="estuary")
banks = {side: "geometric:last=0.3" for side in ("bottom", "top")}
ends = {side: f"tanh:first={w / 100},last={w / 100}" for side, w in (("left", width[0]), ("right", width[-1]))}
start = outline.grid(129, 33, spacing=banks | ends)
smooth = gg.optimize(start, "near_orthogonal", slide=("bottom", "top"))
assert smooth.converged

nodes = smooth.grid.xy
local = np.hypot(*(nodes[:, -1] - nodes[:, 0]).T)
result = gg.optimize(smooth.grid, "winslow", walls={side: gg.Wall(local / 100) for side in ("bottom", "top")})
assert result.converged
assert result.quality.valid
assert result.quality.non_orthogonality.mean < 2
print(f"mean degrees off 90: {result.quality.non_orthogonality.mean:.2f}")

across = np.cumsum(np.concatenate((np.zeros((129, 1)), np.hypot(*np.diff(result.grid.planes, axis=2))), axis=1), axis=1)
depth = 18 * (1 - (2 * across / across[:, -1:] - 1) ** 2) ** 2 + 1

figure = Figure(figsize=(9, 6.5), layout="constrained")
whole, near = figure.subplots(2, 1, height_ratios=(1, 1.8))
for axes, title in ((whole, "the estuary, and its depth in m"), (near, "its upper end")):
    gg.plot_grid(result.grid, ax=axes, title=title, under=depth)
near.set(xlim=(38.2, 41), ylim=(1.4, 2.8))
figure.savefig("estuary.png", dpi=150)
