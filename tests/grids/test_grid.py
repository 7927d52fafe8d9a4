"""The grid itself and the Jacobians at its corners."""

from __future__ import annotations

import pickle
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from gridgen_sym.errors import GridgenError
from gridgen_sym.grids import Grid, corner_jacobians


def lattice(ni=4, nj=3):
    """A rectangle of ni x nj nodes with cells of 2 by 3."""
    return np.stack(np.meshgrid(2.0 * np.arange(ni), 3.0 * np.arange(nj), indexing="ij"), axis=-1)


def test_planes_are_contiguous_and_closed_to_writing():
    grid = Grid(lattice())
    assert grid.shape == (4, 3)
    assert grid.planes.shape == (2, 4, 3)
    assert grid.planes.flags.c_contiguous
    assert grid.x.flags.c_contiguous
    assert grid.x[3, 2] == 6.0
    assert grid.y[3, 2] == 6.0
    with pytest.raises(ValueError, match="read-only"):
        grid.x[0, 0] = 1.0
    with pytest.raises(AttributeError):
        grid.planes = None


def test_the_grid_is_a_copy_both_ways():
    xy = lattice()
    grid = Grid(xy)
    xy[0, 0] = 99.0
    assert grid.x[0, 0] == 0.0
    out = grid.xy
    out[0, 0] = 99.0
    assert grid.x[0, 0] == 0.0
    assert out.shape == (4, 3, 2)


def test_equality_hash_and_pickle():
    grid, other = Grid(lattice()), Grid.from_planes(lattice()[..., 0], lattice()[..., 1])
    assert grid == other
    assert hash(grid) == hash(other)
    changed = lattice()
    changed[1, 1] += 1e-15
    assert grid != Grid(changed)
    assert grid != Grid(lattice(5, 3))
    assert grid != "grid"
    back = pickle.loads(pickle.dumps(grid))
    assert back == grid
    assert not back.x.flags.writeable
    negative = lattice()
    negative[0, 0] = -0.0
    assert Grid(negative) == grid
    assert hash(Grid(negative)) == hash(grid)


def test_repr_is_short():
    assert repr(Grid(lattice())) == "Grid(4 x 3 nodes, x in [0, 6], y in [0, 6])"


@pytest.mark.parametrize("dtype", ["float32", "int16", "uint8", "object", "longdouble"])
def test_real_types_are_taken(dtype):
    assert Grid(lattice().astype(dtype)) == Grid(lattice())


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (np.zeros((3, 3)), r"shape \(ni, nj, 2\), but came with \(3, 3\)"),
        (np.zeros((3, 3, 3)), r"came with \(3, 3, 3\)"),
        (lattice(2, 5), "came with 2 x 5"),
        (lattice(5, 2), "came with 5 x 2"),
        (lattice().astype(complex), "complex128"),
        (lattice().astype(str), "real numbers"),
        (np.ma.masked_equal(lattice(), 0), "masked"),
        ([[1.0], [1.0, 2.0]], "real numbers"),
        (None, "came with"),
        ("grid", "real numbers"),
        (np.full((3, 3, 2), "2020-01-01", dtype="datetime64[D]"), "datetime64"),
        (np.full((3, 3, 2), None), "came with|finite|real numbers"),
    ],
)
def test_bad_input_is_named(value, message):
    with pytest.raises(GridgenError, match=message):
        Grid(value)


def test_planes_of_two_shapes():
    with pytest.raises(GridgenError, match=r"\(3, 4\) and \(4, 3\)"):
        Grid.from_planes(np.zeros((3, 4)), np.zeros((4, 3)))


@given(st.integers(0, 3), st.integers(0, 2), st.integers(0, 1), st.sampled_from([np.nan, np.inf, -np.inf]))
def test_the_first_bad_node_is_named(i, j, axis, value):
    xy = lattice()
    xy[i, j, axis] = value
    xy[3, 2, 0] = np.nan
    count = 1 if (i, j) == (3, 2) else 2
    with pytest.raises(GridgenError, match=rf"node \({i}, {j}\).* first of {count} such"):
        Grid(xy)


@given(
    hnp.arrays(
        st.sampled_from([np.float64, np.int32, np.complex128, np.bool_]),
        hnp.array_shapes(min_dims=0, max_dims=4, min_side=0, max_side=4),
    )
)
def test_any_array_is_a_grid_or_an_error(array):
    good = array.ndim == 3 and array.shape[2] == 2 and min(array.shape[:2]) >= 3
    if good and array.dtype.kind != "c" and np.isfinite(array).all():
        assert np.array_equal(Grid(array).xy, array)
    else:
        with pytest.raises(GridgenError):
            Grid(array)


def test_jacobians_of_a_rectangle():
    jacobians = corner_jacobians(Grid(lattice()).x, Grid(lattice()).y)
    assert jacobians.shape == (4, 3, 2)
    assert (jacobians == 6.0).all()


def test_the_order_of_the_corners():
    # One node of the cell (0, 0) after the other is pushed over the diagonal: J changes its sign only there.
    for corner, (i, j) in enumerate(((0, 0), (1, 0), (1, 1), (0, 1))):
        xy = np.stack(np.meshgrid(np.arange(3.0), np.arange(3.0), indexing="ij"), axis=-1)
        xy[i, j] += 0.6 * (np.array([0.5, 0.5]) - xy[i, j]) / 0.5
        jacobians = corner_jacobians(xy[..., 0], xy[..., 1])[:, 0, 0]
        assert [k for k in range(4) if jacobians[k] <= 0] == [corner]
        assert jacobians[corner] == pytest.approx(-0.2)


def test_a_turned_over_grid_is_negative():
    jacobians = corner_jacobians(*np.moveaxis(lattice()[::-1], -1, 0))
    assert (jacobians == -6.0).all()


def test_importing_is_light():
    heavy = ["sympy", "jinja2", "matplotlib", "scipy"]
    code = f"import sys, gridgen_sym.grids; print([m for m in {heavy} if m in sys.modules])"
    command = [sys.executable, "-W", "error", "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
