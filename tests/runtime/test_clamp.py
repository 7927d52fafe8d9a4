"""The C clamp of eigenvalues, which works on 3x3 matrices of quaternions, against NumPy's eigenvectors of 4x4 ones."""

from __future__ import annotations

import ctypes
from functools import cache

import numpy as np
import pytest

from gridgen_sym.backends.c.loader import headers
from gridgen_sym.codegen.render import environment
from gridgen_sym.runtime import compile_library, find_compiler

pytestmark = pytest.mark.skipif(find_compiler() is None, reason="needs a C compiler")

COUNT = 640
ROWS, COLUMNS = np.triu_indices(4)
_EXPORT = """
EXPORT void clamp_all(int64_t groups, double (*h)[10][CHUNK]) {
  for (int64_t group = 0; group < groups; ++group) clamp(CHUNK, h[group]);
}
"""


@cache
def compiled(change=("", "")):
    """Compile the clamp alone, with a piece of its text changed."""
    text = environment().get_template("c/clamp.h.jinja").render()
    assert change[0] in text
    source = '#include "common.h"\n' + text.replace(*change) + _EXPORT
    return ctypes.CDLL(str(compile_library("clamp_alone", source, headers=headers()))).clamp_all


def clamped(matrices, change=("", "")):
    """Return the matrices (n, 4, 4) without their negative eigenvalues, as C computes them, 64 at a time."""
    groups = np.ascontiguousarray(matrices[:, ROWS, COLUMNS].reshape(-1, 64, 10).swapaxes(1, 2))
    compiled(change)(ctypes.c_int64(len(groups)), groups.ctypes.data_as(ctypes.c_void_p))
    result = np.empty_like(matrices)
    result[:, ROWS, COLUMNS] = result[:, COLUMNS, ROWS] = groups.swapaxes(1, 2).reshape(-1, 10)
    return result


def expected(matrices):
    eigenvalues, vectors = np.linalg.eigh(matrices)
    return (vectors * np.maximum(eigenvalues, 0.0)[:, None]) @ np.swapaxes(vectors, 1, 2)


def with_eigenvalues(*eigenvalues):
    vectors = np.linalg.qr(np.random.default_rng(1).normal(size=(COUNT, 4, 4)))[0]
    return (vectors * np.array(eigenvalues)) @ np.swapaxes(vectors, 1, 2)


def symmetric(entries):
    return 0.5 * (entries + np.swapaxes(entries, 1, 2))


RANDOM = np.random.default_rng(0)
VECTORS = RANDOM.normal(size=(2, COUNT, 4))
SQUARES = VECTORS[:, :, :, None] * VECTORS[:, :, None]
MATRICES = {
    "random": symmetric(RANDOM.normal(size=(COUNT, 4, 4))),
    "large": symmetric(1e70 * RANDOM.normal(size=(COUNT, 4, 4))),
    "small": symmetric(1e-70 * RANDOM.normal(size=(COUNT, 4, 4))),
    "entries of all sizes": symmetric(
        RANDOM.normal(size=(COUNT, 4, 4)) * np.exp(8 * RANDOM.normal(size=(COUNT, 4, 4)))
    ),
    "sparse": symmetric(RANDOM.integers(-1, 2, size=(COUNT, 4, 4)) * (RANDOM.random((COUNT, 4, 4)) < 0.4)),
    "diagonal": np.eye(4) * RANDOM.normal(size=(COUNT, 1, 4)),
    "zero": np.zeros((64, 4, 4)),
    "one": np.broadcast_to(np.eye(4), (64, 4, 4)).copy(),
    "minus one": np.broadcast_to(-np.eye(4), (64, 4, 4)).copy(),
    "rank 1": SQUARES[0],
    "rank -1": -SQUARES[0],
    "rank 2": SQUARES[0] - SQUARES[1],
    "two pairs": with_eigenvalues(1, 1, -1, -1),
    "close pairs": with_eigenvalues(1, 1 + 1e-9, -1, -1 - 1e-9),
    "triple": with_eigenvalues(-1, 2, 2, 2),
    "nearly singular": with_eigenvalues(1, 1e-9, -1e-9, 1e-3),
    "positive": with_eigenvalues(1, 2, 3, 4),
    "negative": with_eigenvalues(-1, -2, -3, -4),
}


def error(name, change=("", "")):
    """Return the largest difference from NumPy, each matrix over its own size."""
    wanted = expected(MATRICES[name])
    size = np.abs(MATRICES[name]).max(axis=(1, 2)) + np.finfo(float).tiny
    return (np.abs(clamped(MATRICES[name], change) - wanted).max(axis=(1, 2)) / size).max()


@pytest.mark.parametrize("name", MATRICES)
def test_the_clamped_matrix_is_the_nearest_semidefinite_one(name):
    assert error(name) < 1e-13
    found = clamped(MATRICES[name])
    size = np.abs(MATRICES[name]).max(axis=(1, 2))
    assert (np.linalg.eigvalsh(found)[:, 0] >= -1e-14 * size).all()


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("entry", range(10))
def test_what_is_not_finite_stays_visible_and_touches_no_other_matrix(value, entry):
    matrices = MATRICES["random"].copy()
    row, column = ROWS[entry], COLUMNS[entry]
    matrices[70, row, column] = matrices[70, column, row] = value
    found = clamped(matrices)
    assert np.isnan(found[70]).all()
    others = np.arange(COUNT) != 70
    assert np.abs(found - expected(MATRICES["random"]))[others].max() < 1e-13 * np.abs(matrices[others]).max()


@pytest.mark.parametrize(
    "change",
    [("m22 = -0.5", "m22 = 0.5"), ("round < 20", "round < 3"), ("s2 = u20", "s2 = -u20"), ("n20 = y0", "n20 = -y0")],
)
def test_a_changed_clamp_is_objected_to(change):
    assert not error("random", change) < 1e-13
