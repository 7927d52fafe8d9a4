"""A channel with two walls
========================

Water between two wavy walls: the first cells at both are as high as asked for, at right angles, and the heights between
them follow Vinokur's law. The ends of the channel are spaced by the same law. Writes `channel.png`.
"""

import numpy as np
from matplotlib.figure import Figure

import gridgen_sym as gg

FIRST = 2e-3
x = np.linspace(0, 4, 201)
half = 0.5 + 0.06 * np.sin(np.pi * x) ** 2
points = np.concatenate([np.stack([x, -half], -1), np.stack([x, half], -1)[::-1]])
outline = gg.Outline(points, corners=(0, 200, 201, 401), name="channel")

law = f"tanh:first={FIRST},last={FIRST}"
start = outline.grid(97, 49, spacing={"left": law, "right": law, "bottom": "equal", "top": "equal"})
result = gg.optimize(start, "winslow", walls={"bottom": gg.Wall(FIRST), "top": gg.Wall(FIRST)})
assert result.converged
assert result.quality.valid

for side in ("bottom", "top"):
    found = result.quality.sides[side]
    least, _, greatest = found.first_heights
    print(f"{side}: first cells {least:.4e} to {greatest:.4e}, {found.non_orthogonality.mean:.2f} degrees off normal")
    assert max(greatest / FIRST, FIRST / least) < 1.01

figure = Figure(figsize=(11, 4), layout="constrained")
whole, near = figure.subplots(1, 2, width_ratios=(2, 1))
gg.plot_grid(result.grid, ax=whole, title="the channel")
gg.plot_grid(result.grid, ax=near, title="its lower wall")
near.set(xlim=(0.75, 0.85), ylim=(-0.54, -0.44))
figure.savefig("channel.png", dpi=150)
