"""Which nodes hold sharp turns of sliding sides: the assignment, and grids that become what symmetry asks for."""

from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

import gridgen_sym as gg
from gridgen_sym.solvers.sliding.turns import nearest_in_order

OUTLINES = Path(__file__).parents[2] / "examples" / "outlines"


@pytest.mark.parametrize("seed", range(20))
def test_the_nearest_nodes_in_order_are_those_of_all_choices(seed):
    random = np.random.default_rng(seed)
    place, inner = np.sort(random.uniform(0, 9, 8)), np.sort(random.uniform(0, 9, 3))
    turns = np.array([place[0], *inner, place[-1]])
    chosen = nearest_in_order(place, turns)
    assert chosen[0] == 0
    assert chosen[-1] == 7
    costs = [np.abs(place[list(choice)] - inner).sum() for choice in combinations(range(1, 7), 3)]
    assert np.abs(place[chosen[1:-1]] - inner).sum() == pytest.approx(min(costs))


def roof(at):
    """A start between two chevrons whose turns are held by node `at` of 17."""
    t = np.interp(np.arange(17), [0, at, 16], [0, 0.5, 1])
    bottom, top = (np.stack([t, height + 0.25 - 0.5 * np.abs(t - 0.5)], -1) for height in (0, 1))
    ends = [side + np.linspace(0, 1, 9)[:, None] * [0, 1] for side in (bottom[0], bottom[-1])]
    return gg.transfinite(bottom=bottom, top=top, left=ends[0], right=ends[1])


@pytest.mark.parametrize("at", [5, 12])
def test_turns_are_held_by_the_nodes_that_symmetry_asks_for(at):
    result = gg.optimize(roof(at), "winslow", slide="all")
    assert result.converged
    assert "Sharp turns of sliding sides are held by other nodes" in result.message
    np.testing.assert_allclose(result.grid.xy[8, [0, -1]], [[0.5, 0.25], [0.5, 1.25]], atol=1e-12)
    np.testing.assert_allclose(result.grid.x, 1 - result.grid.x[::-1], atol=1e-5)
    assert result.energy < gg.optimize(roof(8), "winslow", slide="all").energy * (1 + 1e-9)


@pytest.mark.slow
def test_nodes_stay_at_turns_where_that_is_best_or_was_asked():
    result = gg.optimize(roof(8), "winslow", slide="all")
    np.testing.assert_allclose(result.grid.xy[8, 0], [0.5, 0.25], atol=1e-12)
    assert "Sharp turns" not in result.message
    wall = gg.optimize(roof(6), "winslow", slide=("bottom", "top"), walls={"left": gg.Wall(0.05)})
    np.testing.assert_allclose(wall.grid.xy[6, 0], [0.5, 0.25], atol=1e-12)
    # A weight per node belongs to the nodes: others would bring theirs to the turn.
    weighted = gg.optimize(roof(6), "winslow", slide="all", weight=gg.Weight(1 + roof(6).x))
    np.testing.assert_allclose(weighted.grid.xy[6, 0], [0.5, 0.25], atol=1e-12)


@pytest.mark.slow
def test_an_outline_with_many_turns_keeps_them_and_gets_right_angles():
    start = gg.Outline.read(OUTLINES / "texas.csv").grid(61, 41)
    result = gg.optimize(start, "near_orthogonal", slide="all")
    assert result.converged
    assert gg.quality(gg.Grid(result.grid.xy[1:-1, 1:-1])).non_orthogonality.mean < 2.0
    bottom, found = start.xy[:, 0], result.grid.xy[:, 0]
    step = np.diff(bottom, axis=0)
    turn = np.abs(np.angle(np.exp(1j * np.diff(np.arctan2(step[:, 1], step[:, 0])))))
    for vertex in bottom[1:-1][turn > np.radians(21)]:
        assert np.abs(found - vertex).max(axis=1).min() < 1e-9
