"""Grids that have no derivatives, and what is no direction: errors that say so."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import gridgen_sym as gg

from . import cases

GRID = gg.Grid(cases.start())
COTANGENT = np.ones(GRID.xy.shape)


@pytest.fixture(scope="module")
def result():
    return gg.optimize(GRID, "winslow")


def test_a_grid_that_has_not_converged_has_no_derivatives():
    with pytest.raises(gg.GridgenError, match="has not converged has no derivatives: 0 Newton steps"):
        gg.optimize(GRID, "winslow", max_iterations=0).vjp(COTANGENT)


@pytest.mark.parametrize("backend", ["c", "numpy"])
@pytest.mark.parametrize("density", ["J", "g12 - g11 - g22"])
def test_a_singular_hessian_is_reported(density, backend):
    """Of a null Lagrangian every grid is stationary; of a concave density a uniform grid is the maximum."""
    square = gg.Grid(np.stack(np.meshgrid(*2 * [np.linspace(0, 1, 6)], indexing="ij"), axis=-1))
    result = gg.optimize(square, gg.Functional(f"stationary_{len(density)}", density), backend=backend)
    assert result.converged
    with pytest.raises(gg.GridgenError, match="Hessian of the energy at it is singular, or not positive"):
        result.vjp(np.random.default_rng(0).standard_normal(square.xy.shape))


def test_only_minima_are_differentiated(result):
    with pytest.raises(gg.GridgenError, match="only what optimize returns can be differentiated"):
        gg.untangle(GRID).vjp(COTANGENT)
    copy = pickle.loads(pickle.dumps(result))
    assert copy == result
    with pytest.raises(gg.GridgenError, match="from a pickle"):
        copy.jvp(parameters={})


def test_walls_of_several_blocks_are_refused():
    layout = gg.MultiBlock({"a": GRID}, ())
    result = gg.optimize(layout, "winslow", walls={"bottom": gg.Wall(0.1)}, max_iterations=1)
    with pytest.raises(gg.GridgenError, match="grids of several blocks with walls cannot be differentiated"):
        result.vjp({"a": COTANGENT})


@pytest.mark.parametrize(
    ("tangents", "message"),
    [
        ({}, "give what the grid should change with"),
        ({"shape": 1}, "unknown data 'shape'"),
        ({"boundary": np.ones((2, 2))}, r"change of the boundary must have the shape \(9, 8, 2\), x and y last"),
        ({"parameters": {"k": 1.0}}, "unknown parameter 'k'; the functional has none"),
        ({"weight": 1.0}, "there is no weight, field or target"),
        ({"walls": {"bottom": {"first": 1.0}}}, "there are no walls along which"),
        ({"slide": {"bottom": np.ones((9, 2))}}, "no curve was given of a sliding side 'bottom'"),
    ],
)
def test_what_is_no_direction_is_named(result, tangents, message):
    with pytest.raises(gg.GridgenError, match=message):
        result.jvp(**tangents)


@pytest.mark.parametrize("shape", [(9, 8), (8, 9, 2), (2, 2, 9, 8, 2)])
def test_a_cotangent_has_the_shape_of_the_nodes(result, shape):
    with pytest.raises(gg.GridgenError, match=r"a cotangent has the shape of the nodes, \(9, 8, 2\)"):
        result.vjp(np.ones(shape))


@pytest.mark.parametrize("cotangent", [None, 5])
def test_cotangents_of_several_blocks_are_given_for_each(cotangent):
    result = gg.optimize(gg.layout("pipe", across=4), "winslow")
    with pytest.raises(gg.GridgenError, match="by name or in the order core, south, east, north, west; came"):
        result.vjp(cotangent)
