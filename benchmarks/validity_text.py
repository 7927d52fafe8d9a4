"""The words of docs/validity.md."""

HEAD = """# Never folded: the hard list

Written by `python benchmarks/validity.py{flags}`.

![Transfinite grids, finite-difference Winslow grids and the grids of gg.optimize](images/validity.png)

*From the left: transfinite interpolation; the Winslow equations by finite differences; `gg.optimize(start,
"winslow")`. Folded cells are red.*

{facts}

## Why the finite-difference Winslow solver folds

The Winslow equations state that the logical coordinates are harmonic functions of x and y. Where the logical domain is
a square, the resulting map has a positive Jacobian everywhere (Radó, Kneser, Choquet): the *continuous* solution
never folds. The finite-difference equations are another problem. They contain central differences at the inner nodes
only, which average over the four cells around a node. They do not depend on the corners of single cells, and they have
solutions with J < 0 at some corners, to which the iteration converges. The horseshoe with R = 4.5 at 20 x 20 cells
is an example: its transfinite grid is valid, and the iteration converges from it to a solution of the difference
equations with more than half of its cells folded, with all residuals zero. A better start does not help: from the
valid minimum of the energy, Newton's method on the same equations reaches a point where every step toward a solution
would fold a cell. The cause is the truncation error: near the tip of the outer boundary the lines of the solution are
so far apart that a difference across two cells does not approximate a derivative.

The discrete functional of this project is a sum over *all* corners of all cells, with an infinite barrier where a
corner's J is 0. A minimum with J > 0 is therefore a valid grid by construction, on every grid, and not only in the
limit. It remains to reach the valid side of the barrier from a folded start: `gg.untangle` minimizes a regularized
energy, on coarse grids first, and lets the regularization tend to zero, until every corner is positive or a
certificate proves that the boundary nodes admit no valid grid.

Where no valid grid exists, a certificate proves it from the boundary nodes alone. Some proofs are immediate: a
boundary that winds backward around a point, a corner that turns the wrong way, a node with an empty feasible region.
For others a search follows where untangling ends with folds. In a valid grid every inner node lies in the convex hull
of the boundary: this is its first feasible region. Constraint propagation shrinks it. At every corner of a cell J must
be positive for some position of the other two nodes, and where the boundary does not touch itself the nodes of a cell
must see each other past the exterior. Feasible regions are clipped to a convex decomposition of the interior, so that
they follow the boundary. Where propagation stalls, a region is bisected and both branches are followed. An empty
feasible region is the proof: all signs are those of integers. The certificate names cells that cannot all be valid.

The same search gives more where J must exceed a fraction of the area predicted from the boundary spacing. The larger
this fraction, the smaller the feasible regions, until they are empty. So the search brackets the quality that a grid
can have. From the centers of the last feasible regions valid grids are found that no energy led to. Where none is
found, a certificate of kind `sliver` proves that every valid grid has a cell that is nearly folded, or small.
"""

LIST_TEXT = (
    "All starts are transfinite grids (TFI). Each cell gives the number of folded cells (J <= 0 at a corner) and "
    "processor seconds, one thread. `nc`: not converged, or stopped by the time limit of the relaxation. Laplace: the "
    "equations of `length`. Winslow, finite differences: relaxation with frozen coefficients, from the transfinite "
    "grid as it is. `winslow` and `modified_liao`: `gg.optimize` with its defaults. The last columns show the grid "
    "of `winslow`: smallest scaled Jacobian, smallest and largest angle in degrees, energy per corner (2 is a square), "
    "and the certificates of the boundary. In the regions, the energy of `winslow` is compared with that of "
    "the reference grid of the literature; `above the reference` would say that it is larger."
)

SPEED_TEXT = (
    "`gg.untangle(start)` from the transfinite grid, the smallest of three runs, against the plain method: epsilon "
    "lowered by the rule of the paper (`plain_untangle.py`), the same kernels, no nested grids. `plain` solves its "
    "linear systems with SciPy's sparse LU, without coarse grids; `plain, multigrid` borrows the "
    "linear solver of this project. Every folded start of 64 x 64 cells (regions: 80 x 80) that no certificate "
    "excludes. A plain run is stopped after some 4 seconds; the last column shows what was folded then."
)
