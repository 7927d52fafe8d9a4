"""No proof is ever wrong: of random grids that are known exactly, only the boundary is given.

Some cells of a known grid are doubted: those that do not exceed what is asked for. Then no more may be proved than what
the known grid allows: a node lies in its feasible region, unless a doubted cell is among the reasons; and of cells that
conflict one is doubted. Without doubted cells nothing may conflict at all.
"""

from __future__ import annotations

import contextlib
from fractions import Fraction

import numpy as np
import pytest
from support_polygons import inside
from support_valid_grids import random_valid_grid, scrambled

import gridgen_sym as gg
from gridgen_sym.certificates.branching import search_conflict
from gridgen_sym.certificates.constraint_network import BudgetExceeded, ConstraintNetwork
from gridgen_sym.certificates.expected_jacobians import expected_jacobians
from gridgen_sym.certificates.feasible_region import Constraint
from gridgen_sym.certificates.integer_polygons import convex_hull

#: Of each seed one grid: valid ones, those with a folded cell, and valid ones of which large Jacobians are asked for.
KINDS = ("valid", "folded", "sliver")


class Witness:
    """A grid that is known, and its doubted cells: not all their Jacobians exceed a fraction of the expected ones."""

    def __init__(self, exact, fraction):
        self.exact, self.fraction = exact, fraction
        half, expected = Fraction(exact.doubled_area, 2), expected_jacobians(exact.grid())
        self.doubted = {
            cell
            for cell in exact.corners
            for value, part in zip(exact.jacobians(cell), expected[:, *cell], strict=True)
            if value <= Fraction(fraction * part) * half
        }

    def follow(self, network, unit):
        """Take the network's integers for coordinates in a unit, and its bits for cells."""
        self.doubt = sum(1 << number for number, cell in enumerate(network.cells) if cell in self.doubted)
        scale, (x0, y0) = network.coordinates.scale, network.coordinates.origin
        self.at = {
            node: ((x * unit - x0) * scale, (y * unit - y0) * scale) for node, (x, y) in self.exact.nodes.items()
        }

    def allows(self, node, parts, reasons):
        """Whether the known grid has its node in one of the parts, or a doubted cell is among the reasons."""
        at = self.at[node]
        return bool(reasons & self.doubt) or any(inside(part, at) if len(part) > 2 else part == (at,) for part in parts)

    def allows_all(self, regions):
        return all(self.allows(node, region.parts, region.reasons) for node, region in regions.items())

    def allows_conflict(self, why):
        return why is None or bool(why & self.doubt)


def watch(patch, witness):
    """Check each constraint, and each propagation, that begins with regions which the known grid allows."""
    clip, propagate = Constraint.clip, ConstraintNetwork.propagate

    def checked_clip(constraint, regions, check):
        parts, cost = clip(constraint, regions, check)
        involved = {node: regions[node] for node in (constraint.node, *constraint.others)}
        if parts is not None and witness.allows_all(involved):
            assert witness.allows(constraint.node, parts, constraint.reasons(regions)), constraint
        return parts, cost

    def checked_propagate(network, regions, changed=None):
        allowed = witness.allows_all(regions)
        why = propagate(network, regions, changed)
        if allowed:
            assert witness.allows_conflict(why)
            assert why is not None or witness.allows_all(regions)
        return why

    patch.setattr(Constraint, "clip", checked_clip)
    patch.setattr(ConstraintNetwork, "propagate", checked_propagate)


def fractions_of(exact):
    """The smallest of the four Jacobians of each cell as fractions of the expected ones, sorted."""
    half, expected = exact.doubled_area / 2, expected_jacobians(exact.grid())
    return sorted(
        min(value / (part * half) for value, part in zip(exact.jacobians(cell), expected[:, *cell], strict=True))
        for cell in exact.corners
    )


def fold_a_cell(exact, random):
    """Move a boundary node toward another, so that cells fold; return whether all nodes stay in the convex hull."""
    ni, nj = exact.shape
    ring = [node for node in exact.nodes if node[0] in (0, ni - 1) or node[1] in (0, nj - 1)]
    node, to = (ring[k] for k in random.integers(len(ring), size=2))
    (x, y), (u, v) = exact.nodes[node], exact.nodes[to]
    exact.nodes[node] = x + 3 * (u - x) // 4, y + 3 * (v - y) // 4
    hull = convex_hull([exact.nodes[node] for node in ring])
    return all(inside(hull, point) for point in exact.nodes.values())


def assert_sound(seed, kind, budget=300):
    """Check all that is proved of one random grid; return whether there was a conflict, and a doubted cell."""
    exact, random = random_valid_grid(seed), np.random.default_rng(seed)
    fraction = 0.0
    if kind == "folded" and not fold_a_cell(exact, random):
        return None
    if kind == "sliver":
        known = fractions_of(exact)
        fraction = known[min(int(random.exponential(len(known) / 3)), len(known) - 1)]
    witness = Witness(exact, fraction)
    power = int(random.integers(-40, 40))
    grid = scrambled(exact.grid(2.0**power), seed)
    # Of folded cells it is not known that they are inside the boundary: no visibility.
    whole = kind != "folded"
    if whole:
        assert gg.certificates(grid) == ()
    network = ConstraintNetwork(grid, exact.corners, budget, jacobian_fraction=fraction, visibility=whole)
    witness.follow(network, Fraction(2) ** power)
    regions, why = network.start.copy(), None
    with pytest.MonkeyPatch.context() as patch, contextlib.suppress(BudgetExceeded):
        watch(patch, witness)
        why = search_conflict(network, regions, whole)
        if why is None and not whole:
            why = search_conflict(network, regions, True)
    assert witness.allows_conflict(why)
    assert why is not None or witness.allows_all(regions)
    return why is not None, bool(witness.doubted)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_nothing_is_proved_that_a_known_grid_refutes(kind):
    outcomes = [assert_sound(seed, kind) for seed in range(25)]
    conflicts, doubts = zip(*(outcome for outcome in outcomes if outcome), strict=True)
    # The test is of use: there are conflicts, and only with doubted cells.
    assert any(conflicts) == any(doubts) == (kind != "valid")


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_nothing_is_proved_that_many_known_grids_refute(kind):
    for seed in range(40, 80):
        assert_sound(seed, kind, budget=1500)
