"""Walls both ways
===============

A channel with a bump whose first cells are 0.004 high: the walls as a target of Winslow's functional, and as control
functions of Winslow's equations. Both have the heights and right angles at the wall; away from it the equations even
lines out, and the target keeps angles and lengths. Writes `walls_equations.png`.
"""

import numpy as np
from matplotlib.figure import Figure

import gridgen_sym as gg

FIRST = 4e-3
s = np.linspace(0, 1, 49)
bottom = np.stack([3 * s, 0.35 * np.exp(-30 * (s - 0.5) ** 2)], axis=-1)
outline = gg.Outline(np.concatenate([bottom, [[3, 1], [0, 1]]]), corners=(0, 48, 49, 50))
law = f"geometric:first={FIRST}"
start = outline.grid(49, 25, spacing={"left": law, "right": law})
walls = {"bottom": gg.Wall(FIRST)}

target = gg.optimize(start, "winslow", walls=walls)
equations = gg.solve_euler_lagrange(start, "winslow", control="hilgenstock-white", walls=walls)
assert target.converged
assert equations.converged

figure = Figure(figsize=(12, 3), layout="constrained")
for k, (result, title) in enumerate(((target, "as a target"), (equations, "as control functions"))):
    side = result.quality.sides["bottom"]
    print(
        f"{title}: first heights {side.first_heights[0]:.2e} to {side.first_heights[-1]:.2e}, degrees off "
        f"normal {side.non_orthogonality.largest:.2f}, off 90 in the mean {result.quality.non_orthogonality.mean:.1f}"
    )
    gg.plot_grid(result.grid, ax=figure.add_subplot(1, 2, k + 1), title=title)
height = np.hypot(*(equations.grid.xy[1:-1, 1] - equations.grid.xy[1:-1, 0]).T)
assert np.abs(height / FIRST - 1).max() < 1e-3
figure.savefig("walls_equations.png", dpi=150)
