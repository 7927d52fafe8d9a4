"""Compiled and NumPy kernels give the same numbers to round-off, for every functional, size and number of threads."""

from __future__ import annotations

import numpy as np
import pytest
from support import CASES, case_name, kernel_set, random_grid, random_weight, relative_difference, tiered

from gridgen_sym.runtime import find_compiler, thread_count

pytestmark = pytest.mark.skipif(find_compiler() is None, reason="needs a C compiler")

#: Around the 64 columns that the C kernels work on at once, and the smallest grids.
SIZES = [(2, 2), (3, 3), (4, 64), (5, 65), (3, 66), (9, 140)]
ROUND_OFF = 1e-12
SPACING = (0.5, 0.3)
#: A smallest Jacobian that holds no node back.
FOLDING = -1e30


@pytest.fixture(params=["1", "2"], ids=["one thread", "two threads"])
def threads(request, monkeypatch):
    """Use this number of threads, on grids however small."""
    monkeypatch.setenv("OMP_NUM_THREADS", request.param)
    monkeypatch.setattr("gridgen_sym.runtime.threads._NODES_PER_THREAD", 1)
    assert thread_count() == int(request.param)


def noise_of(variant):
    return 0.4 if "regularized" in variant else 0.1


def fixed_nodes(ni, nj):
    fixed = np.zeros((ni, nj), dtype=np.uint8)
    fixed[ni // 2, nj // 2] = 1
    return fixed


def results(kernel_set, xy, weight, fixed):
    """Yield (name, array) of everything that the kernels compute."""
    for inner in (False, True):
        yield f"energy {inner}", kernel_set.energy(xy, weight, SPACING, interior_only=inner)
        energy, smallest, gradient = kernel_set.energy_gradient(xy, weight, SPACING, interior_only=inner)
        yield f"energy with gradient {inner}", (energy, smallest)
        yield f"gradient {inner}", gradient
        for semidefinite in (False, True):
            planes = kernel_set.hessian(xy, weight, SPACING, semidefinite=semidefinite, interior_only=inner)
            yield f"hessian {semidefinite} {inner}", planes
            if kernel_set.polyconvex or not semidefinite:
                yield (
                    f"hessian times vector {semidefinite} {inner}",
                    kernel_set.hessian_vector(
                        xy, np.sin(7 * xy), weight, SPACING, semidefinite=semidefinite, interior_only=inner
                    ),
                )
        for color in range(4):
            for floor in (FOLDING, 0.0):
                swept = xy.copy()
                kernel_set.sweep(swept, weight, fixed, color, SPACING, floor=floor, interior_only=inner)
                yield f"sweep {color} {floor} {inner}", swept
    if "regularized" in kernel_set.variant:
        return
    yield "residual", kernel_set.euler_lagrange_residual(xy, weight, SPACING)
    for frozen in (False, True):
        yield f"jacobian {frozen}", kernel_set.euler_lagrange_jacobian(xy, weight, SPACING, frozen=frozen)
    for color in range(4):
        relaxed = xy.copy()
        kernel_set.euler_lagrange_relaxation(relaxed, weight, fixed, color, 0.9, SPACING)
        yield f"relaxation {color}", relaxed


def objections(compiled, plain, xy, weight, fixed):
    pairs = zip(results(compiled, xy, weight, fixed), results(plain, xy, weight, fixed), strict=True)
    return [
        (name, relative_difference(value, expected))
        for (name, value), (_, expected) in pairs
        if not same(value, expected)
    ]


def same(value, expected):
    """Compare arrays to round-off; infinities (a smallest Jacobian of no corners) must be the same ones."""
    value, expected = np.asarray(value), np.asarray(expected)
    finite = np.isfinite(expected)
    if not np.array_equal(value[~finite], expected[~finite], equal_nan=True):
        return False
    return relative_difference(value[finite], expected[finite]) < ROUND_OFF


@pytest.mark.usefixtures("threads")
@pytest.mark.parametrize("case", tiered(CASES), ids=case_name)
def test_c_equals_numpy(case):
    compiled, plain = kernel_set(*case, "c"), kernel_set(*case, "numpy")
    assert (compiled.backend, plain.backend) == ("c", "numpy")
    for size in SIZES:
        xy = random_grid(*size, noise=noise_of(case[1]))
        weight = random_weight(len(plain.planes), *size)
        assert not objections(compiled, plain, xy, weight, fixed_nodes(*size)), size


@pytest.mark.usefixtures("threads")
@pytest.mark.parametrize("backend", ["c", "numpy"])
@pytest.mark.parametrize("case", [("winslow", "plain"), ("area", "differentiated"), ("length", "plain")], ids=case_name)
def test_sweeps_move_free_nodes_of_their_color_and_no_others(case, backend):
    kernels = kernel_set(*case, backend)
    xy, weight = random_grid(7, 8), random_weight(len(kernels.planes), 7, 8)
    fixed = np.zeros((7, 8), dtype=np.uint8)
    fixed[3, 4] = fixed[2, 2] = 1
    i, j = np.meshgrid(np.arange(7), np.arange(8), indexing="ij")
    inside = (i > 0) & (i < 6) & (j > 0) & (j < 7) & (fixed == 0)
    for color in range(4):
        swept, relaxed = xy.copy(), xy.copy()
        kernels.sweep(swept, weight, fixed, color, floor=0.0)
        kernels.euler_lagrange_relaxation(relaxed, weight, fixed, color, 0.9)
        own = inside & (i % 2 + 2 * (j % 2) == color)
        for moved in (swept, relaxed):
            assert np.array_equal((moved != xy).any(axis=0), own)


# A differentiated weight is that of where the nodes were: after a move the energy is that of another weight.
@pytest.mark.parametrize("case", tiered(case for case in CASES if case[1] != "differentiated"), ids=case_name)
def test_a_sweep_lowers_the_energy(case):
    kernels = kernel_set(*case, "c")
    xy, weight = random_grid(9, 9, noise=noise_of(case[1])), random_weight(len(kernels.planes), 9, 9)
    before = kernels.energy(xy, weight, SPACING)[0]
    for color in range(4):
        kernels.sweep(xy, weight, np.zeros((9, 9), dtype=np.uint8), color, SPACING, floor=FOLDING)
        after = kernels.energy(xy, weight, SPACING)[0]
        assert after < before
        before = after


@pytest.mark.usefixtures("threads")
@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_a_sweep_tells_its_largest_step_and_takes_none_beyond_its_reach(backend):
    kernels, xy, free = kernel_set("winslow", "plain", backend), random_grid(9, 140), np.zeros((9, 140), dtype=np.uint8)
    far, near = xy.copy(), xy.copy()
    largest = kernels.sweep(far, None, free, 3, floor=0.0)
    steps = np.abs(far - xy).max(axis=0)
    assert largest == steps.max() > 0
    assert kernels.sweep(near, None, free, 3, floor=0.0, reach=0.5 * largest) == largest
    assert np.array_equal(near, np.where(steps < 0.5 * largest, far, xy))


def test_sweeps_keep_positive_jacobians():
    """Liao's functional folds cells if it may; a small step on the way must not."""
    kernels = kernel_set("liao", "plain", "c")
    xy = random_grid(12, 12, seed=3, noise=0.12)
    # A re-entrant corner, over which this functional folds.
    xy[0] += 0.08 * (xy[1] - 5) ** 2
    assert kernels.energy(xy)[1] > 0
    free = np.zeros((12, 12), dtype=np.uint8)
    for _ in range(30):
        for color in range(4):
            kernels.sweep(xy, None, free, color, floor=0.0)
            assert kernels.energy(xy)[1] > 0


def test_one_and_two_threads_give_the_same_bytes(monkeypatch):
    monkeypatch.setattr("gridgen_sym.runtime.threads._NODES_PER_THREAD", 1)
    kernels, xy = kernel_set("modified_liao", "plain", "c"), random_grid(33, 70)
    told = []
    for count in ("1", "2", "3"):
        monkeypatch.setenv("OMP_NUM_THREADS", count)
        told.append([np.asarray(value).tobytes() for _, value in results(kernels, xy, None, fixed_nodes(33, 70))])
    assert told[0] == told[1] == told[2]


def test_a_wrong_number_is_objected_to():
    """The comparison above can fail: kernels of two functionals differ, and one changed entry is seen."""
    xy, fixed = random_grid(5, 65), fixed_nodes(5, 65)
    assert objections(kernel_set("liao", "plain", "c"), kernel_set("length"), xy, None, fixed)
    gradient = kernel_set("liao").energy_gradient(xy)[2]
    changed = gradient.copy()
    changed[1, 2, 64] *= 1 + 1e-9
    assert same(gradient, gradient)
    assert not same(changed, gradient)


# ---- results in memory that is given ----


def written_kernels(kernels, xy):
    """Return every kernel that takes `out`, with the number of planes that it writes."""
    return {
        2: [
            lambda out: kernels.energy_gradient(xy, out=out)[2],
            lambda out: kernels.hessian_vector(xy, np.sin(xy), out=out),
            lambda out: kernels.euler_lagrange_residual(xy, None, SPACING, out=out),
        ],
        19: [lambda out: kernels.hessian(xy, out=out), lambda out: kernels.hessian(xy, semidefinite=True, out=out)],
        36: [
            lambda out: kernels.euler_lagrange_jacobian(xy, None, SPACING, out=out),
            lambda out: kernels.euler_lagrange_jacobian(xy, None, SPACING, frozen=True, out=out),
        ],
    }


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_a_result_in_given_memory_is_the_same(backend):
    """Whatever stood there before."""
    kernels, xy = kernel_set("winslow", "plain", backend), random_grid(5, 67)
    for count, functions in written_kernels(kernels, xy).items():
        for function in functions:
            given = np.full((count, 5, 67), 7.0)
            assert function(given) is given
            assert given.tobytes() == function(None).tobytes()


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_given_memory_of_the_wrong_shape_is_refused(backend):
    kernels, xy = kernel_set("winslow", "plain", backend), random_grid(5, 67)
    for count, functions in written_kernels(kernels, xy).items():
        for function in functions:
            with pytest.raises(ValueError, match=rf"out must have the shape \({count}, 5, 67\); came"):
                function(np.empty((count, 5, 66)))


# ---- clear errors ----


@pytest.mark.parametrize("backend", ["c", "numpy"])
@pytest.mark.parametrize("shape", [(2, 5, 6), (1, 6, 5), (5, 6), (0,)])
def test_a_weight_of_the_wrong_shape_is_refused(backend, shape):
    with pytest.raises(ValueError, match=r"values of area \(s\) must have the shape \(1, 5, 6\); came"):
        kernel_set("area", "frozen", backend).energy(random_grid(5, 6), np.ones(shape))


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_a_missing_weight_is_refused(backend):
    with pytest.raises(ValueError, match=r"values of area \(s\) must have the shape"):
        kernel_set("area", "frozen", backend).energy(random_grid(5, 6))


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_a_vector_that_does_not_fit_is_refused(backend):
    with pytest.raises(ValueError, match=r"the vector must have the shape \(2, 5, 6\); came \(2, 6, 5\)"):
        kernel_set("area", "plain", backend).hessian_vector(random_grid(5, 6), random_grid(6, 5))
    with pytest.raises(ValueError, match="kernel hessian_vector needs C-contiguous arrays"):
        kernel_set("area", "plain", backend).hessian_vector(random_grid(5, 6), random_grid(6, 5).transpose(0, 2, 1))
    with pytest.raises(ValueError, match="knupp is not polyconvex: its semidefinite Hessian must be stored"):
        kernel_set("knupp", "plain", backend).hessian_vector(random_grid(5, 6), random_grid(5, 6), semidefinite=True)


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_arrays_that_are_not_contiguous_are_refused(backend):
    transposed = random_grid(6, 5).transpose(0, 2, 1)
    with pytest.raises(ValueError, match="kernel energy needs C-contiguous arrays"):
        kernel_set("area", "plain", backend).energy(transposed)
    fixed = np.zeros((6, 5), dtype=np.uint8).T
    with pytest.raises(ValueError, match="kernel sweep needs C-contiguous arrays"):
        kernel_set("area", "plain", backend).sweep(random_grid(5, 6), None, fixed, 0, floor=0.0)
