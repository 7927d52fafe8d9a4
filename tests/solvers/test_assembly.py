"""Sparse matrices of stencils: the same as SciPy makes of rows, columns and values, to the last bit."""

import itertools

import numpy as np
import pytest
from scipy import sparse

from gridgen_sym.runtime import find_compiler
from gridgen_sym.solvers.linear import sparse as matrices
from gridgen_sym.solvers.linear.assembly import assemble

HALF = {(1, 0): 3, (0, 1): 7, (1, 1): 11, (1, -1): 15}


def couplings(stored_half):
    """Yield (shift to the other node, component here, component there, plane, whether the transpose counts, too)."""
    for a, b in itertools.product(range(2), range(2)):
        if stored_half:
            yield (0, 0), a, b, a + b, False
            yield from ((shift, a, b, first + 2 * a + b, True) for shift, first in HALF.items())
        else:
            shifts = itertools.product((-1, 0, 1), (-1, 0, 1))
            yield from ((shift, a, b, 4 * place + 2 * a + b, False) for place, shift in enumerate(shifts))


def expected(planes, fixed, stored_half):
    """Put the matrix together node by node."""
    numbers = np.where(fixed == 0, np.cumsum(fixed == 0).reshape(fixed.shape) - 1, -1)
    entries = []
    for i, j in np.argwhere(fixed == 0):
        for (di, dj), a, b, plane, both in couplings(stored_half):
            inside = 0 <= i + di < fixed.shape[0] and 0 <= j + dj < fixed.shape[1]
            if inside and fixed[i + di, j + dj] == 0:
                row, column = 2 * numbers[i, j] + a, 2 * numbers[i + di, j + dj] + b
                entries += [(row, column, planes[plane, i, j]), (column, row, planes[plane, i, j])][: 1 + both]
    rows, columns, values = zip(*entries, strict=True) if entries else ((), (), ())
    size = 2 * int((fixed == 0).sum())
    return sparse.csc_matrix((np.array(values, dtype=float), (rows, columns)), shape=(size, size))


@pytest.mark.parametrize("compiled", [False, True] if find_compiler() else [False])
@pytest.mark.parametrize("wide", [None, True], ids=["32 bits", "64 bits"])
@pytest.mark.parametrize("mask", ["boundary", "random", "nothing", "everything"])
@pytest.mark.parametrize("stored_half", [True, False], ids=["hessian", "jacobian"])
def test_a_matrix_is_that_of_its_rows_columns_and_values(compiled, wide, mask, stored_half):
    random, shape = np.random.default_rng(5), (6, 9)
    fixed = np.full(shape, mask in ("everything", "boundary"), dtype=np.uint8)
    if mask == "boundary":
        fixed[1:-1, 1:-1] = 0
    elif mask == "random":  # Nodes of the boundary are free, too.
        fixed = (random.random(shape) < 0.4).astype(np.uint8)
    planes = random.normal(size=(19 if stored_half else 36, *shape))
    sources = matrices._HESSIAN if stored_half else matrices._JACOBIAN
    found, right = assemble(planes, fixed, sources, compiled=compiled, wide=wide), expected(planes, fixed, stored_half)
    assert found.shape == right.shape
    assert found.has_canonical_format
    for name in ("indptr", "indices", "data"):
        assert np.array_equal(getattr(found, name), getattr(right, name))
    if wide is None and found.nnz:
        assert found.indices.dtype == right.indices.dtype == found.indptr.dtype
