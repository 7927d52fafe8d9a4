"""Untangling
==========

The length functional pulls grid lines over the headlands of a border and folds cells. A functional with a barrier
repairs that grid: the barrier is regularized, so that folded cells have a finite energy, and the regularization tends
to zero until no folded cell is left.
"""

from pathlib import Path

import gridgen_sym as gg

# Beside this script; in a notebook, which has no file, beside that.
folder = Path(globals().get("__file__", "")).parent / "outlines"
start = gg.Outline.read(folder / "texas.csv").grid(49, 49)

folded = gg.optimize(start, "length", keep_valid=False).grid
untangled = gg.untangle(folded)
smooth = gg.optimize(untangled.grid, "winslow")
print(f"{gg.quality(folded).folded_cells} folded cells; {untangled}")

assert gg.quality(folded).folded_cells > 20
assert untangled.converged
assert smooth.quality.folded_cells == 0

gg.plot_grids([("length: folded", folded), ("untangled and smoothed: winslow", smooth.grid)], "untangling.png")
