"""The words of docs/validity.md."""

HEAD = """# Never folded: the hard list

Written by `python benchmarks/validity.py{flags}`.

![Transfinite grids, finite-difference Winslow grids and the grids of gg.optimize](images/validity.png)

*From the left: transfinite interpolation; the Winslow equations by finite differences; `gg.optimize(start,
"winslow")`. Folded cells are red.*

{facts}

## Why the finite-difference Winslow solver folds

The Winslow equations say that the logical coordinates are harmonic functions of x and y. Where the logical domain is
a square, the map that they give has a positive Jacobian everywhere (Radó, Kneser, Choquet): the *continuous* solution
never folds. The finite-difference equations are another problem. They know the grid by central differences at its
inner nodes only, where the four cells round a node are averaged: they do not see the corners of single cells, and
they have solutions with J < 0 at them, to which the iteration converges. The horseshoe with R = 4.5 at 20 x 20 cells
is such a case: its transfinite grid is valid, and the iteration goes from it to a solution of the difference
equations with more than half of its cells folded: all residuals are zero, and nothing says so. Nor does a better
start help: from the valid minimum of the energy, Newton's method on the same equations comes to a point where every
step towards a solution would fold a cell. The truncation error is to blame: near the tip of the outer boundary, lines
of the solution are so far apart that a difference across two cells is no derivative.

The discrete functional of this project is a sum over *all* corners of all cells, with an infinite barrier where a
corner's J is 0. A minimum with J > 0 is therefore a valid grid by construction, on every grid, and not only in the
limit. What remains is to get to the right side of the barrier from a folded start: `gg.untangle` minimises a
regularised energy on coarse grids first and sharpens its barrier, until every corner is positive, or a certificate
says that the boundary nodes admit no valid grid.

Where no valid grid exists, a certificate proves it from the boundary nodes alone. Some proofs are read off at once: a
boundary that crosses itself, a corner that turns the wrong way, a node without a place. For others there is a search,
made where untangling ends with folds. In a valid grid every inner node lies in the convex hull of the boundary. From
there its place is contracted: at every corner of a cell J must be positive for some place of the other two nodes, and
where the boundary does not meet itself the nodes of a cell must see each other past what lies outside. There a place
is cut along convex pieces of the boundary's inside, so that it bends as the boundary does. Where that ends, places
are halved, and both cases are followed up. A node that is left without a place is the proof, for all signs are those
of whole numbers; the certificate names cells that cannot all be valid.

The same search tells more where J shall not only be positive but exceed a part of the area that the lengths of the
boundary's edges let expect there. The larger that part, the smaller are the places, until there are none. So it is
found about how good a grid can be: from the middle of these last places valid grids are found that no energy led to,
and where none is, a certificate of kind `sliver` proves that every valid grid has a cell that is nearly folded, or
small.
"""

LIST_TEXT = (
    "All starts are transfinite grids (TFI). Each cell gives the number of folded cells (J <= 0 at a corner) and "
    "processor seconds, one thread. `nc`: not converged, or stopped by the time limit of the relaxation. Laplace: the "
    "equations of `length`. Winslow, finite differences: relaxation with frozen coefficients, from the transfinite "
    "grid as it is. `winslow` and `modified_liao`: `gg.optimize` as it comes. The last columns are of the grid of "
    "`winslow`: smallest scaled Jacobian, smallest and largest angle in degrees, energy per corner (2 is a square), "
    "and what the certificates say of the boundary. In the regions, the energy of `winslow` is compared with that of "
    "the reference grid of the literature; `above the reference` would say that it is larger."
)

SPEED_TEXT = (
    "`gg.untangle(start)` from the transfinite grid, the smallest of three runs, against the plain method: epsilon "
    "lowered by the rule of the paper (`plain_untangle.py`), the same kernels, no nested grids. `plain` solves its "
    "linear systems with SciPy's sparse LU, so that it knows no coarse grids at all; `plain, multigrid` borrows the "
    "linear solver of this project. Every folded start of 64 x 64 cells (regions: 80 x 80) that no certificate "
    "excludes. A plain run is stopped after some 4 seconds; the last column shows what was folded then."
)
