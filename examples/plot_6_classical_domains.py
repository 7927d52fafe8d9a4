"""The classical domains
=====================

The test domains of the literature, each with its Winslow grid. Transfinite interpolation, where each one starts, folds
cells of the swan and half of those of the zee; no cell of the results is folded.
"""

import gridgen_sym as gg

names = ("annulus", "chevron", "horseshoe", "indented_square", "naca", "quarter_annulus", "swan", "wavy", "zee")
starts = {name: gg.domain(name, 25, 25) for name in names}
results = {name: gg.optimize(start, "winslow") for name, start in starts.items()}

for name, result in results.items():
    print(f"{name:<16} folded {gg.quality(starts[name]).folded_cells:>3} -> {result.quality.folded_cells}")

assert gg.quality(starts["swan"]).folded_cells == 23
assert gg.quality(starts["zee"]).folded_cells == 288
assert all(result.converged and result.quality.valid for result in results.values())

gg.plot_grids([(name, result.grid) for name, result in results.items()], "classical_domains.png")
