"""The paper's comparisons
=======================

Sections 3.3 to 3.5 of the paper: functionals side by side on one domain. The Liao functional folds the indented square,
the modified one does not; length folds the horseshoe, area-orthogonality (Knupp) does not. The paper does not give its
domains, so classical ones stand in; `gridgen-sym paper` runs all of them by the paper's own method, with a table.
"""

import gridgen_sym as gg

cases = {
    ("indented_square", "liao"): True,
    ("indented_square", "modified_liao"): False,
    ("quarter_annulus", "area"): False,
    ("quarter_annulus", "knupp"): False,
    ("horseshoe", "length"): True,
    ("horseshoe", "knupp"): False,
}
panels = []
for (domain, name), folds in cases.items():
    result = gg.optimize(gg.domain(domain, 21, 21), name, keep_valid=False)
    print(f"{domain:<16} {name:<14} {result.quality.folded_cells:>3} folded cells")
    assert (result.quality.folded_cells > 0) == folds
    panels.append((f"{domain}: {name}", result.grid))

gg.plot_grids(panels, "comparisons.png", columns=2)
