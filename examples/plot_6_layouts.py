"""Layouts of several blocks
=========================

The shapes that `gg.layout` makes, each with its Winslow grid: straight interfaces become smooth, since their nodes move
like inner ones. Then walls, and the layouts that the descriptions in `examples/layouts` draw: points, curves, blocks
and numbers of cells. Writes `layouts.png`, `layouts_walls.png` and `descriptions.png`.
"""

from pathlib import Path

import numpy as np

import gridgen_sym as gg

shapes = {
    name: gg.layout(name)
    for name in ("pipe", "square_with_hole", "annulus", "sector", "tee", "wye", "channel_with_hole", "step", "cascade")
}
results = {name: gg.optimize(start, "winslow") for name, start in shapes.items()}
for name, result in results.items():
    print(f"{name:<18} {len(result.grid):>2} blocks, scaled Jacobian >= {result.quality.min_scaled_jacobian:.3f}")
assert all(result.converged and result.quality.valid for result in results.values())
gg.plot_grids([(name, result.grid) for name, result in results.items()], "layouts.png")

# %%
# Walls
# -----
# A wall is the name of a boundary: first heights and right angles are asked for on all its sides.

HEIGHTS = {"pipe": 0.01, "airfoil_c": 1e-3}
walled = []
for name, first in HEIGHTS.items():
    start = gg.layout(name)
    result = gg.optimize(start, "winslow", walls={"wall": gg.Wall(first)})
    assert result.converged
    assert result.quality.valid
    for part in start.boundaries["wall"]:
        xy = result.grid.blocks[part.block].xy[part.first : part.last + 1]
        heights = np.hypot(*(xy[:, 1] - xy[:, 0]).T)
        assert np.abs(heights / first - 1).max() < 0.05
    walled.append((f"{name}: first cells {first}", result.grid))
gg.plot_grids(walled, "layouts_walls.png", columns=2)

# %%
# Layouts that a text file describes
# ----------------------------------
# In `river.toml` nobody drew the interfaces before and behind the island, and in `airfoil_c.toml` the wake is a
# connection of the block with itself.

folder = Path(globals().get("__file__", "")).parent / "layouts"  # In a notebook, which has no file, beside that.
drawn = {path.stem: gg.optimize(gg.read_layout(path), "winslow") for path in sorted(folder.glob("*.toml"))}
assert len(drawn) == 5
assert all(result.converged and result.quality.valid for result in drawn.values())
gg.plot_grids([(name, result.grid) for name, result in drawn.items()], "descriptions.png")
