"""Real outlines
=============

Coast lines, borders and an airfoil, from CSV files that mark their four corners: boundaries that were not made for a
grid generator.
"""

from pathlib import Path

import gridgen_sym as gg

# Beside this script; in a notebook, which has no file, beside that.
folder = Path(globals().get("__file__", "")).parent / "outlines"
panels = []
for name in ("texas", "ohio", "france", "nlf416_half_o"):
    start = gg.Outline.read(folder / f"{name}.csv").grid(65, 65)
    result = gg.optimize(start, "winslow")
    print(f"{name}: {gg.quality(start).folded_cells} folded cells at the start; {result}")
    assert result.converged
    assert result.quality.folded_cells == 0
    panels.append((name, result.grid))

gg.plot_grids(panels, "outlines.png", columns=2)
