"""A bend
======

A duct that turns by 90 degrees, with straight legs. Both walls have boundary layers; in- and outflow are normal to
them. Writes `bend.png`.
"""

import numpy as np
from matplotlib.figure import Figure

import gridgen_sym as gg

FIRST = 1e-3


def wall(radius: float) -> np.ndarray:
    """Return a wall around the center (0, 0): straight, a quarter of a circle, straight."""
    angle = np.linspace(-np.pi / 2, 0, 61)
    turn = radius * np.stack([np.cos(angle), np.sin(angle)], -1)
    leg = np.linspace(1.5, 0, 40, endpoint=False)
    return np.concatenate([np.stack([-leg, 0 * leg - radius], -1), turn, np.stack([0 * leg + radius, leg[::-1]], -1)])


outer, inner = wall(2.0), wall(1.0)
outline = gg.Outline(np.concatenate([outer, inner[::-1]]), corners=(0, 140, 141, 281), name="bend")
law = f"tanh:first={FIRST},last={FIRST}"
start = outline.grid(81, 49, spacing={"left": law, "right": law, "bottom": "equal", "top": "equal"})
result = gg.optimize(start, "winslow", walls={"bottom": gg.Wall(FIRST), "top": gg.Wall(FIRST)})
assert result.converged
assert result.quality.valid

for side in ("bottom", "top"):
    found = result.quality.sides[side]
    print(f"{side}: first cells {found.first_heights[0]:.3e} to {found.first_heights[2]:.3e}")
    assert found.non_orthogonality.percentile_95 < 1

figure = Figure(figsize=(11, 5), layout="constrained")
whole, near = figure.subplots(1, 2)
gg.plot_grid(result.grid, ax=whole, title="the bend")
gg.plot_grid(result.grid, ax=near, title="the inner wall, where it becomes straight")
near.set(xlim=(0.98, 1.04), ylim=(-0.03, 0.03))
figure.savefig("bend.png", dpi=150)
