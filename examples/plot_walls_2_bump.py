"""A bump on a wall
================

A circular arc of a tenth of its chord on a flat wall. Nodes of the wall are close together at both ends of the bump,
where the flow changes; those of the far side slide. Cells grow by a factor of 1.2 from the wall. At the ends
of the bump, where the wall turns by 23 degrees, heights and angles are compromises. Writes `bump.png`.
"""

import numpy as np
from matplotlib.figure import Figure

import gridgen_sym as gg

FIRST, GROWTH = 1e-3, 1.2
radius = (0.5**2 + 0.1**2) / (2 * 0.1)
arc = np.linspace(-1, 1, 101) * np.arcsin(0.5 / radius)
bump = np.stack([1.5 + radius * np.sin(arc), 0.1 - radius + radius * np.cos(arc)], -1)
points = np.concatenate([[[0, 0]], bump, [[3, 0], [3, 1.5], [0, 1.5]]])
outline = gg.Outline(points, corners=(0, 102, 103, 104), name="bump")

u = np.linspace(0, 1, 33)
along = 2 * radius * np.arcsin(0.5 / radius)
at = np.concatenate([1 - (1 - u) ** 1.7, 1 + along * (1 - np.cos(np.pi * u[1:])) / 2, 1 + along + u[1:] ** 1.7])
law = f"geometric:first={FIRST}"
start = outline.grid(97, 49, spacing={"bottom": at / at[-1], "left": law, "right": law})
result = gg.optimize(start, "winslow", walls={"bottom": gg.Wall(FIRST, growth=GROWTH)}, slide="top")
assert result.converged
assert result.quality.valid

found = result.quality.sides["bottom"]
off = np.abs(np.hypot(*(result.grid.xy[:, 1] - result.grid.xy[:, 0]).T) / FIRST - 1)
print(f"first cells off by {off.max():.1%} at most, three of four by less than {np.percentile(off, 75):.2%}")
print(f"degrees off normal: {found.non_orthogonality.mean:.2f}, 95 %: {found.non_orthogonality.percentile_95:.2f}")
assert off.max() < 0.1
assert np.percentile(off, 75) < 0.003

figure = Figure(figsize=(11, 4.5), layout="constrained")
whole, near = figure.subplots(1, 2)
gg.plot_grid(result.grid, ax=whole, title="the bump")
gg.plot_grid(result.grid, ax=near, title="where it begins")
near.set(xlim=(0.98, 1.04), ylim=(-0.003, 0.057))
figure.savefig("bump.png", dpi=150)
