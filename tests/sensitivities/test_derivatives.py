"""Derivatives of grids against differences of whole solves, of every kind of data, on three kinds of grids."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
import pytest

import gridgen_sym as gg

from . import cases
from .cases import Case

ONE_BLOCK: dict[str, Callable[[], Case]] = {
    "boundary": cases.odd_boundary,
    "parameter": cases.odd_parameter,
    "weight_node": partial(cases.odd_weight, "node"),
    "weight_corner": partial(cases.odd_weight, "corner"),
    "fields": cases.odd_field,
    "lengths": cases.odd_lengths,
    "held_values": partial(cases.held_values, "numpy"),
    "held_samples": cases.held_samples,
    "reference_grid": cases.reference_grid,
}
SLIDING: dict[str, Callable[[], Case]] = {
    "own_curves": cases.sliding_boundary,
    "moved_turn": cases.moved_turn,
    "points": partial(cases.sliding_curve, points=True),
    "function_backwards": partial(cases.sliding_curve, points=False, backwards=True),
    "wall_data": partial(cases.walled, "data"),
    "wall_boundary": partial(cases.walled, "boundary"),
}
BLOCKS: dict[str, Callable[[], Case]] = {
    "blocks_boundary": partial(cases.blocks, "boundary"),
    "blocks_weight": partial(cases.blocks, "weight"),
    "blocks_sliding": cases.sliding_blocks,
    "blocks_curve": cases.sliding_blocks_curve,
}
CASES = {**ONE_BLOCK, **SLIDING, **BLOCKS}
QUICK = ("own_curves", "points", "reference_grid", "wall_boundary")


def nodes(found: object) -> np.ndarray:
    """Return all nodes of a grid, of blocks, or what a mapping has of them, as one row."""
    if isinstance(found, dict):
        return np.concatenate([part.ravel() for part in found.values()])
    if isinstance(found, gg.MultiBlock):
        return np.concatenate([block.xy.ravel() for block in found.blocks])
    return (found.xy if isinstance(found, gg.Grid) else np.asarray(found)).ravel()


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[] if name in QUICK else pytest.mark.slow) for name in CASES]
)
def test_derivatives_are_those_of_whole_solves(name):
    """By fourth-order differences; and both products are of one matrix."""
    case = CASES[name]()
    result = case.solve(0.0)
    assert result.converged, result.message
    h = case.step
    weights = ((1, 8), (-1, -8), (2, -1), (-2, 1))
    expected = sum(w * nodes(case.solve(k * h).grid) for k, w in weights) / (12 * h)
    found = nodes(result.jvp(**case.tangents))
    wrong = float(np.abs(found - expected).max() / np.abs(expected).max())
    assert wrong <= 1e-7
    random = np.random.default_rng(0)
    blocks = result.grid.blocks if isinstance(result.grid, gg.MultiBlock) else [result.grid]
    cotangents = [random.standard_normal(block.xy.shape) for block in blocks]
    gradients = result.vjp(cotangents if isinstance(result.grid, gg.MultiBlock) else cotangents[0])
    product = float(np.concatenate([one.ravel() for one in cotangents]) @ found)
    assert float(case.product(gradients)) == pytest.approx(product, rel=1e-8)


def test_several_numbers_are_differentiated_at_once():
    """Each of the numbers has what it has alone, along the first axis."""
    grid = gg.Grid(cases.start())
    result = gg.optimize(grid, "winslow", slide="all", target=gg.Target(0.2, 0.15), **cases.TIGHT)
    cotangents = np.random.default_rng(1).standard_normal((3, *grid.xy.shape))
    every = result.vjp(cotangents)
    for number, one in enumerate(cotangents):
        alone = result.vjp(one)
        assert np.allclose(every.boundary[number], alone.boundary, rtol=1e-9, atol=1e-12)
        assert np.allclose(every.target[number], alone.target, rtol=1e-9)


def test_nodes_that_stay_in_the_grid_are_data_too():
    """A fixed inner node is moved by hand, as the boundary is."""
    grid, fixed = gg.optimize(gg.Grid(cases.start()), "winslow").grid, np.zeros(cases.SHAPE, dtype=bool)
    fixed[4, 3] = True
    moved = np.zeros(grid.xy.shape)
    moved[4, 3] = 1.0, -0.5

    def solve(t: float) -> gg.Result:
        return gg.optimize(gg.Grid(grid.xy + t * moved), "winslow", fixed=fixed, **cases.TIGHT)

    found, h = solve(0.0).jvp(boundary=moved), 1e-4
    expected = (solve(h).grid.xy - solve(-h).grid.xy) / (2 * h)
    assert np.abs(found - expected).max() <= 1e-6
    assert (found[4, 3] == moved[4, 3]).all()
