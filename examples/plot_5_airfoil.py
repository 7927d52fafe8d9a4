"""A C-grid with y+ = 1
====================

A C-grid around NACA 2412 whose first cells are as high as a turbulent boundary layer asks for, at right angles to the
wall, with the outer boundary at 20 chords. The whole grid, the airfoil, and its trailing edge. Writes `airfoil.png`.
"""

import numpy as np
from matplotlib.figure import Figure

import gridgen_sym as gg

WAKE = 32
first = gg.first_height(reynolds=6e6, yplus=1)
result = gg.airfoil_grid("naca2412", "C", first=first, far=20, cells=(96, 64), wake=WAKE)
assert result.converged
assert result.quality.valid

grid = result.grid
height = np.hypot(*(grid.xy[:, 1] - grid.xy[:, 0]).T)[WAKE + 2 : -WAKE - 2]  # But two nodes beside the trailing edge.
print(f"asked for: {first:.3e}; first cells: {height.min():.3e} to {height.max():.3e}")
assert np.abs(height / first - 1).max() < 0.01
print(f"degrees off normal, 95 %: {result.quality.sides['bottom'].non_orthogonality.percentile_95:.2f}")
assert result.quality.sides["bottom"].non_orthogonality.percentile_95 < 2

figure = Figure(figsize=(12, 4), layout="constrained")
windows = (None, (-0.3, 1.5, -0.9, 0.9), (0.97, 1.03, -0.03, 0.03))
for k, window in enumerate(windows):
    axes = figure.add_subplot(1, 3, k + 1)
    gg.plot_grid(grid, ax=axes, title=("20 chords", "the airfoil", "the trailing edge")[k])
    if window:
        axes.set(xlim=window[:2], ylim=window[2:])
figure.savefig("airfoil.png", dpi=150)
