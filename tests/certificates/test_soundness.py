"""No proof is ever wrong: of random valid grids, whose numbers are exact, only the boundary is given.

Some cells of the known grid are doubted: those with a corner Jacobian that is not larger than what is asked for. Then
no more may be said than what the known grid meets: a node lies in its feasible region, unless a doubted cell is among
the reasons; and of cells that conflict one is doubted. Without doubted cells nothing may conflict at all.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from support_polygons import inside
from support_valid_grids import random_valid_grid, scrambled

import gridgen_sym as gg
from gridgen_sym.certificates.conflict import _contradiction
from gridgen_sym.certificates.expected_jacobians import expected_jacobians
from gridgen_sym.certificates.lattice import convex_hull
from gridgen_sym.certificates.network import Network, OutOfWork
from gridgen_sym.certificates.places import Rule


class Witness:
    """A valid grid, and which of its cells have a corner Jacobian of at most a part of what is expected."""

    def __init__(self, exact, share):
        self.exact, self.share = exact, share
        expected = expected_jacobians(exact.grid())
        half = Fraction(exact.doubled_area, 2)
        self.doubted = {
            cell
            for cell in exact.corners
            for value, part in zip(exact.jacobians(cell), expected[:, *cell], strict=True)
            if value <= Fraction(share * part) * half
        }

    def follow(self, network, unit):
        """Take the network's units, and which bits stand for doubted cells."""
        self.doubt = sum(1 << number for number, cell in enumerate(network.cells) if cell in self.doubted)
        scale, (x0, y0) = network.lattice.scale, network.lattice.origin
        self.at = {node: ((x * unit - x0) * scale, (y * unit - y0) * scale) for node, (x, y) in self.exact.nodes.items()}

    def agrees(self, node, region):
        """Say whether the node is in its region, or a doubted cell is among the reasons."""
        return bool(region.cells & self.doubt) or any(inside_or_at(part, self.at[node]) for part in region.parts)

    def agrees_with_all(self, regions):
        return all(self.agrees(node, region) for node, region in regions.items())

    def assert_reasons(self, why):
        assert why is None or why & self.doubt


def inside_or_at(part, point):
    return inside(part, point) if len(part) > 2 else part == (point,)


def watch(monkeypatch, witness):
    """Check each step of propagation that begins with what the witness agrees with."""
    left, contract = Rule.left, Network.contract

    def checked_left(rule, places):
        parts, work = left(rule, places)
        if parts is not None and all(witness.agrees(node, places[node]) for node in (rule.node, *rule.others)):
            if not rule.reasons(places) & witness.doubt:
                assert any(inside_or_at(part, witness.at[rule.node]) for part in parts)
        return parts, work

    def checked_contract(network, places, changed=None):
        agreed = witness.agrees_with_all(places)
        why = contract(network, places, changed)
        if agreed:
            witness.assert_reasons(why)
            assert why is not None or witness.agrees_with_all(places)
        return why

    monkeypatch.setattr(Rule, "left", checked_left)
    monkeypatch.setattr(Network, "contract", checked_contract)


def own_shares(exact):
    """What each cell's corner Jacobians do not all exceed, as parts of what is expected of them; sorted."""
    expected = expected_jacobians(exact.grid())
    half = exact.doubled_area / 2
    return sorted(
        min(value / (part * half) for value, part in zip(exact.jacobians(cell), expected[:, *cell], strict=True))
        for cell in exact.corners
    )


def fold_a_cell(exact, random):
    """Move a boundary node so far that a cell folds; say whether all inner nodes are in the hull of the boundary."""
    ni, nj = exact.shape
    ring = [node for node in exact.nodes if node[0] in (0, ni - 1) or node[1] in (0, nj - 1)]
    node = ring[random.integers(len(ring))]
    (x, y), (u, v) = exact.nodes[node], exact.nodes[ring[random.integers(len(ring))]]
    exact.nodes[node] = (x + 3 * (u - x) // 4, y + 3 * (v - y) // 4)
    hull = convex_hull([exact.nodes[node] for node in ring])
    return all(inside(hull, point) for point in exact.nodes.values())


def search(network, regions, sight):
    """What `contracted_places` does, without a conversion of its answer."""
    why = network.contract(regions)
    if why is None and sight:
        why = network.divide(regions)
    return _contradiction(network, regions) if why is None else why


def assert_sound(seed, monkeypatch, work=300):
    """Return whether there was a conflict, and whether there was a doubted cell."""
    exact, random = random_valid_grid(seed), np.random.default_rng(seed)
    share, sight = 0.0, True
    if seed % 3 == 1:
        sight = not fold_a_cell(exact, random) and None
        if sight is None:
            return None
    elif seed % 3 == 2:
        own = own_shares(exact)
        share = own[min(int(random.exponential(len(own) / 4)), len(own) - 1)]
    witness = Witness(exact, share)
    power = int(random.integers(-40, 40))
    grid = scrambled(exact.grid(2.0**power), seed)
    if sight:
        assert gg.certificates(grid) == ()
    network = Network(grid, exact.corners, work, share=share, sight=sight)
    witness.follow(network, Fraction(2) ** power)
    regions, why = network.start.copy(), None
    with monkeypatch.context() as patch:
        watch(patch, witness)
        try:
            why = search(network, regions, sight)
        except OutOfWork:
            pass
    witness.assert_reasons(why)
    assert why is not None or witness.agrees_with_all(regions)
    return why is not None, bool(witness.doubted)
