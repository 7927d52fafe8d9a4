"""What untangling says of random boundaries: a valid grid, a proof of none or only ones with slivers, or neither.

The boundaries are those of the property-based tests, `tests/support_boundaries.py`.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter

import numpy as np
from measure import FOLDER, Table

import gridgen_sym as gg

sys.path.insert(0, str(FOLDER.parent / "tests"))
from support_boundaries import flat_polygon, grid_of_ring, smooth_curve, star_polygon

#: Kinds of boundaries, each as how to make one and its shape.
KINDS = {
    "smooth, wiggle 0.1": (smooth_curve, 0.1),
    "smooth, wiggle 0.3": (smooth_curve, 0.3),
    "star, radii from 0.3": (star_polygon, 0.3),
    "star, radii from 1e-6": (star_polygon, 1e-6),
    "band, 1:100": (flat_polygon, 1e-2),
}
_OUTCOMES = ("quick proof", "searched proof", "valid", "longer search", "sliver", "undecided")


def outcome(start: gg.Grid, budget: int | None) -> str:
    """Return the outcome of one boundary; what is not proved is searched again with a larger budget, if given."""
    if gg.certificates(start):
        return "quick proof"
    result = gg.untangle(start, progress=False)
    if result.quality.valid:
        return "valid"
    if any(proof.impossible for proof in result.certificates):
        return "searched proof"
    if budget and gg.certificates(result.grid, search=True, budget=budget):
        return "longer search"
    return "sliver" if result.certificates else "undecided"


def main() -> None:
    """Print a table of what becomes of so many boundaries of each kind, with 3 to 9 nodes a side."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=300, help="boundaries of each kind")
    parser.add_argument("--first", type=int, default=0, help="seed of the first")
    parser.add_argument("--budget", type=int, help="budget of a longer search for a proof where there is none yet")
    parser.add_argument("--kind", action="append", choices=KINDS, help="of this kind only")
    options = parser.parse_args()
    table = Table(
        "Random boundaries",
        "Processor seconds, one boundary after the other.",
        ("kind", "boundaries", *_OUTCOMES, "seconds"),
    )
    for kind in options.kind or KINDS:
        make, shape = KINDS[kind]
        found: Counter[str] = Counter()
        begin = time.process_time()
        for seed in range(options.first, options.first + options.count):
            ni, nj = np.random.default_rng(seed).integers(3, 10, 2).tolist()
            found[outcome(grid_of_ring(make(seed, 2 * (ni + nj) - 4, shape), ni, nj), options.budget)] += 1
        table.add(kind, options.count, *(found[name] for name in _OUTCOMES), time.process_time() - begin)
    print(table.markdown())


if __name__ == "__main__":
    main()
