"""Kernels on grids: gradients and Hessians are slopes, energies are sums, and both have the symmetries of the plane."""

from __future__ import annotations

import numpy as np
import pytest
from support import (
    BUILTIN,
    CASES,
    EQUATION_CASES,
    case_name,
    dense_hessian,
    kernel_set,
    random_grid,
    random_weight,
    relative_difference,
    tiered,
)

from gridgen_sym.functionals import functional
from gridgen_sym.runtime import Values, find_compiler
from gridgen_sym.runtime.block import Block

BACKEND = "c" if find_compiler() else "numpy"
SIZE = (4, 5)
STEP = 1e-5
#: Steps of the logical coordinates.
SPACING = (0.7, 0.4)


def moving_weight(case, xy):
    """Return the planes of s(x, y) = 2 + sin(0.3 x + 0.5 y) at the nodes, or what stands for it where it is held."""
    planes = kernel_set(*case, BACKEND).planes
    if case[1] != "differentiated":
        return random_weight(len(planes), *xy.shape[1:])
    phase, a, b = 0.3 * xy[0] + 0.5 * xy[1], 0.3, 0.5
    sine, cosine = np.sin(phase), np.cos(phase)
    return np.array([2 + sine, a * cosine, b * cosine, -a * a * sine, -a * b * sine, -b * b * sine])


def grid_of(case, size=SIZE):
    return random_grid(*size, noise=0.4 if "regularized" in case[1] else 0.1)


def differences(function, xy):
    """Return fourth-order central differences of an array function in every coordinate, (..., 2, ni, nj)."""
    columns = []
    for entry in range(xy.size):
        unit = np.zeros(xy.size)
        unit[entry] = 1.0
        unit = unit.reshape(xy.shape)

        def at(steps, unit=unit):
            return np.asarray(function(xy + steps * STEP * unit))

        columns.append((8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * STEP))
    columns = np.stack(columns, axis=-1)
    return columns.reshape(*columns.shape[:-1], *xy.shape)


@pytest.mark.parametrize("inner", [False, True], ids=["all corners", "inner corners"])
@pytest.mark.parametrize("case", tiered(CASES), ids=case_name)
def test_the_gradient_is_the_slope_of_the_energy(case, inner):
    kernels, xy = kernel_set(*case, BACKEND), grid_of(case)
    gradient = kernels.energy_gradient(xy, moving_weight(case, xy), SPACING, interior_only=inner)[2]
    expected = differences(lambda at: kernels.energy(at, moving_weight(case, at), SPACING, interior_only=inner)[0], xy)
    assert relative_difference(gradient, expected) < 1e-7


@pytest.mark.parametrize("inner", [False, True], ids=["all corners", "inner corners"])
@pytest.mark.parametrize("case", tiered(CASES), ids=case_name)
def test_the_hessian_is_the_slope_of_the_gradient(case, inner):
    kernels, xy = kernel_set(*case, BACKEND), grid_of(case)

    def gradient(at):
        return kernels.energy_gradient(at, moving_weight(case, at), SPACING, interior_only=inner)[2]

    hessian = dense_hessian(kernels.hessian(xy, moving_weight(case, xy), SPACING, interior_only=inner))
    expected = differences(gradient, xy).reshape(hessian.shape)
    assert relative_difference(hessian, expected) < 1e-7
    broken = hessian.copy()
    broken[7, 7] *= -1
    assert relative_difference(broken, expected) > 1e-7


@pytest.mark.slow
@pytest.mark.parametrize("inner", [False, True], ids=["all corners", "inner corners"])
@pytest.mark.parametrize("case", CASES, ids=case_name)
def test_the_hessian_times_a_vector(case, inner):
    """It is the stored Hessian times the vector, and how the gradient changes along the vector."""
    kernels, xy = kernel_set(*case, BACKEND), grid_of(case, (5, 67))
    weight, vector = moving_weight(case, xy), np.random.default_rng(3).normal(size=xy.shape)
    for semidefinite in (False, True) if kernels.polyconvex else (False,):
        planes = kernels.hessian(xy, weight, semidefinite=semidefinite, interior_only=inner)
        expected = (dense_hessian(planes) @ vector.ravel()).reshape(xy.shape)
        product = kernels.hessian_vector(xy, vector, weight, semidefinite=semidefinite, interior_only=inner)
        assert relative_difference(product, expected) < 1e-13
        assert relative_difference(product, -expected) > 1

    def gradient(steps):
        at = xy + steps * STEP * vector
        return kernels.energy_gradient(at, moving_weight(case, at), SPACING, interior_only=inner)[2]

    product = kernels.hessian_vector(xy, vector, weight, SPACING, interior_only=inner)
    change = (8 * (gradient(1) - gradient(-1)) - (gradient(2) - gradient(-2))) / (12 * STEP)
    assert relative_difference(product, change) < 1e-7


# ---- a block of a larger grid: its own rows, strides that are not its width, and a halo of one node ----


@pytest.mark.slow
@pytest.mark.parametrize("case", EQUATION_CASES, ids=case_name)
def test_a_block_with_a_halo_gives_the_rows_of_the_whole(case):
    """What the ranks of a distributed engine will ask for; C only, for NumPy has no strides of its own."""
    if BACKEND != "c":
        pytest.skip("needs a C compiler")
    kernels, xy = kernel_set(*case, "c"), grid_of(case, (9, 70))
    ni, nj, plane = 5, 66, 9 * 70
    weight, vector = moving_weight(case, xy), np.random.default_rng(3).normal(size=xy.shape)
    offset = 8 * (2 * 70 + 3)
    values = Values.of(() if weight is None else weight, xy.shape[1:]).pointers + np.uintp(offset)
    block = Block(ni, nj, 1, ni - 1, 70, plane, 0, 1, 1.0, 1.0)
    whole = {
        "energy_gradient": (2, kernels.energy_gradient(xy, weight)[2]),
        "hessian": (19, kernels.hessian(xy, weight)),
        "semidefinite_hessian": (19, kernels.hessian(xy, weight, semidefinite=True)),
        "hessian_vector": (2, kernels.hessian_vector(xy, vector, weight)),
    }
    inside = np.s_[:, 3:6, 4:68]
    for name, (count, expected) in whole.items():
        result, rows = np.full((count, 9, 70), np.nan), np.empty((2, ni))
        between = {
            "energy_gradient": [rows[0].ctypes.data, rows[1].ctypes.data],
            "hessian_vector": [at(vector, offset)],
        }
        kernels._functions[name](block, at(xy, offset), values, kernels._parameters,
                                 *between.get(name, []), at(result, offset))  # fmt: skip
        assert relative_difference(result[inside], expected[inside]) < 1e-13
        assert np.isnan(result[:, :3]).all()
        assert np.isnan(result[:, 6:]).all()


def at(array, offset):
    """Return the address of a block's first node."""
    return array.ctypes.data + offset


@pytest.mark.slow
@pytest.mark.parametrize("inner", [False, True], ids=["all corners", "inner corners"])
@pytest.mark.parametrize("case", tiered(CASES), ids=case_name)
def test_the_semidefinite_hessian_has_no_negative_eigenvalue(case, inner):
    kernels, xy = kernel_set(*case, BACKEND), grid_of(case)
    planes = kernels.hessian(xy, moving_weight(case, xy), SPACING, semidefinite=True, interior_only=inner)
    eigenvalues = np.linalg.eigvalsh(dense_hessian(planes))
    assert eigenvalues[0] > -1e-12 * eigenvalues[-1]
    assert eigenvalues[-1] > 0


def test_some_full_hessian_has_a_negative_eigenvalue():
    """Else the test above would show nothing."""
    xy = random_grid(6, 6, noise=0.15)
    indefinite = [
        name
        for name in BUILTIN
        if np.linalg.eigvalsh(dense_hessian(kernel_set(name, "plain", BACKEND).hessian(xy)))[0] < -1e-3
    ]
    assert {"area", "orthogonality", "winslow"} <= set(indefinite)


@pytest.mark.slow
@pytest.mark.parametrize("case", tiered(EQUATION_CASES), ids=case_name)
def test_the_jacobian_is_the_slope_of_the_residual(case):
    kernels = kernel_set(*case, BACKEND)
    xy = grid_of(case, (5, 4))
    weight = jacobian_weight(case, xy)
    jacobian = dense_jacobian(kernels.euler_lagrange_jacobian(xy, weight(xy), SPACING))
    expected = differences(lambda at: kernels.euler_lagrange_residual(at, weight(at), SPACING), xy)
    assert relative_difference(jacobian, expected.reshape(jacobian.shape)) < 1e-7


def jacobian_weight(case, xy):
    """Return the weight as a function of the grid; its third derivatives, which the Jacobian leaves out, are zero."""
    if case[1] != "differentiated":
        return lambda at: random_weight(len(kernel_set(*case, BACKEND).planes), *xy.shape[1:])

    def planes(at):
        x, y = at
        s = 3 + 0.2 * x - 0.1 * y + 0.04 * x * x + 0.02 * x * y - 0.03 * y * y
        second = [np.full_like(x, value) for value in (0.08, 0.02, -0.06)]
        return np.array([s, 0.2 + 0.08 * x + 0.02 * y, -0.1 + 0.02 * x - 0.06 * y, *second])

    return planes


def dense_jacobian(planes):
    """Assemble nine blocks of four planes to a matrix over (component, i, j)."""
    _, ni, nj = planes.shape
    matrix = np.zeros((2, ni, nj, 2, ni, nj))
    blocks = planes.reshape(3, 3, 2, 2, ni, nj)
    for i in range(1, ni - 1):
        for j in range(1, nj - 1):
            for p in range(3):
                for q in range(3):
                    matrix[:, i, j, :, i + p - 1, j + q - 1] = blocks[p, q, :, :, i, j]
    return matrix.reshape(2 * ni * nj, 2 * ni * nj)


@pytest.mark.parametrize("case", tiered(EQUATION_CASES), ids=case_name)
def test_the_frozen_jacobian_has_the_coefficients_of_the_second_derivatives_alone(case):
    """What is frozen is the operator: a linear function has no second differences, so the Jacobian sends it to zero."""
    kernels = kernel_set(*case, BACKEND)
    xy = grid_of(case, (5, 6))
    weight = jacobian_weight(case, xy)(xy)
    frozen = kernels.euler_lagrange_jacobian(xy, weight, SPACING, frozen=True)
    full = kernels.euler_lagrange_jacobian(xy, weight, SPACING)
    i, j = np.meshgrid(np.arange(5.0), np.arange(6.0), indexing="ij")
    for linear in (np.stack([i, j]), np.stack([np.ones_like(i), 2 * i - j])):
        assert np.abs(dense_jacobian(frozen) @ linear.ravel()).max() < 1e-11 * np.abs(frozen).max()
    # The same second differences are in the full one: what a node and its opposite share is symmetric.
    blocks, whole = (planes.reshape(3, 3, 4, 5, 6)[..., 1:-1, 1:-1] for planes in (frozen, full))
    for p, q in ((0, 0), (0, 1), (0, 2), (1, 0)):
        opposite = 2 - p, 2 - q
        assert relative_difference(whole[p, q] + whole[opposite], 2 * blocks[p, q]) < 1e-12
        assert relative_difference(blocks[p, q], blocks[opposite]) < 1e-12


# ---- energies written out by hand ----


def written_out(xy, density, spacing):
    """Sum a density of (g1, g2) over the corners of every cell, in plain Python, and find the smallest Jacobian."""
    _, ni, nj = xy.shape
    total, smallest = 0.0, float("inf")
    for i in range(ni - 1):
        for j in range(nj - 1):
            p = {(a, b): (xy[0, i + a, j + b], xy[1, i + a, j + b]) for a in (0, 1) for b in (0, 1)}
            for a in (0, 1):
                for b in (0, 1):
                    g1 = p[1, b][0] - p[0, b][0], p[1, b][1] - p[0, b][1]
                    g2 = p[a, 1][0] - p[a, 0][0], p[a, 1][1] - p[a, 0][1]
                    smallest = min(smallest, g1[0] * g2[1] - g1[1] * g2[0])
                    g1, g2 = [g / spacing[0] for g in g1], [g / spacing[1] for g in g2]
                    total += spacing[0] * spacing[1] * density(g1, g2, g1[0] * g2[1] - g1[1] * g2[0])
    return total, smallest


BY_HAND = {
    "winslow": lambda g1, g2, jacobian: (g1[0] ** 2 + g1[1] ** 2 + g2[0] ** 2 + g2[1] ** 2) / jacobian,
    "area": lambda g1, g2, jacobian: jacobian**2,
    "length": lambda g1, g2, jacobian: g1[0] ** 2 + g1[1] ** 2 + g2[0] ** 2 + g2[1] ** 2,
    "orthogonality": lambda g1, g2, jacobian: (g1[0] * g2[0] + g1[1] * g2[1]) ** 2,
    "combined": lambda *corner: sum(
        part * BY_HAND[name](*corner) for name, part in (("area", 0.4), ("length", 0.2), ("orthogonality", 0.4))
    ),
    "knupp": lambda g1, g2, jacobian: (g1[0] ** 2 + g1[1] ** 2) * (g2[0] ** 2 + g2[1] ** 2) / 2,
}


@pytest.mark.parametrize("spacing", [(1.0, 1.0), SPACING], ids=["index", "steps"])
@pytest.mark.parametrize("backend", ["numpy", BACKEND])
@pytest.mark.parametrize("name", BY_HAND)
def test_the_energy_is_the_sum_over_corners(name, backend, spacing):
    xy = random_grid(5, 67)
    expected, smallest = written_out(xy, BY_HAND[name], spacing)
    energy, least = kernel_set(name, "plain", backend).energy(xy, None, spacing)
    assert energy == pytest.approx(expected, rel=1e-12)
    assert least == pytest.approx(smallest, rel=1e-12)


@pytest.mark.parametrize("backend", ["numpy", BACKEND])
@pytest.mark.parametrize("name", ["length", "winslow", "area_winslow"])
def test_steps_do_not_decide_about_the_sign_of_a_jacobian(name, backend):
    """At a straight angle J is zero, and stays so for steps whose reciprocals round the edges."""
    xy = np.array([[[0.0, 0.0], [0.25, 0.0], [1.0, 1.0]], [[0.0, 0.75], [0.25, 1.0], [0.0, 1.0]]])
    for count in (4, 48, 49, 106):
        kernels, spacing = kernel_set(name, "plain", backend), (1 / 3, 1 / count)
        assert kernels.energy(xy, None, spacing)[1] == kernels.energy(xy)[1]
        assert kernels.energy_gradient(xy, None, spacing)[1] == kernels.energy(xy)[1]


def test_a_barrier_stays_visible():
    """A folded cell and a NaN show in what the kernels return: nothing is clipped."""
    for backend in ("numpy", BACKEND):
        xy = random_grid(5, 70)
        xy[0, 2, 66] += 3.0
        energy, smallest, _ = kernel_set("winslow", "plain", backend).energy_gradient(xy)
        assert smallest < 0
        assert np.isfinite(energy)
        xy[1, 3, 1] = np.nan
        assert np.isnan(kernel_set("winslow", "plain", backend).energy(xy)[0])


def test_the_regularized_energy_tends_to_the_plain_one():
    from gridgen_sym.runtime import kernels

    xy = random_grid(6, 6)
    plain = kernel_set("winslow").energy(xy)[0]
    errors = [
        abs(kernels(functional("winslow"), "regularized", {"epsilon": epsilon}, "numpy").energy(xy)[0] - plain)
        for epsilon in (0.1, 0.05)
    ]
    assert errors[1] < errors[0] / 3.5


# ---- symmetries of the plane ----


@pytest.mark.parametrize("case", tiered(case for case in CASES if case[1] != "differentiated"), ids=case_name)
def test_a_translation_changes_nothing(case):
    kernels, xy = kernel_set(*case, BACKEND), grid_of(case)
    weight = moving_weight(case, xy)
    gradient = kernels.energy_gradient(xy, weight)[2]
    assert np.abs(gradient.sum(axis=(1, 2))).max() < 1e-11 * np.abs(gradient).max()
    hessian = dense_hessian(kernels.hessian(xy, weight)).reshape(2, xy[0].size, 2, -1)
    assert np.abs(hessian.sum(axis=3)).max() < 1e-11 * np.abs(hessian).max()


@pytest.mark.parametrize("case", tiered(CASES), ids=case_name)
def test_a_rotation_turns_the_gradient_and_keeps_the_energy(case):
    kernels, xy = kernel_set(*case, BACKEND), grid_of(case)
    weight = random_weight(len(kernels.planes), *SIZE)
    angle = 0.7
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    rotated = np.ascontiguousarray(np.tensordot(turn, xy, 1))
    energy, smallest, gradient = kernels.energy_gradient(xy, weight)
    if case[1] == "differentiated":
        # The slope of the weight is a vector, and turns too.
        weight[1:3] = np.tensordot(turn, weight[1:3], 1)
    turned = kernels.energy_gradient(rotated, weight)
    assert turned[:2] == pytest.approx((energy, smallest), rel=1e-12)
    assert relative_difference(turned[2], np.tensordot(turn, gradient, 1)) < 1e-12


DEGREES = {"area": 4, "length": 2, "orthogonality": 4, "knupp": 4, "winslow": 0, "liao": 4, "modified_liao": 0}


@pytest.mark.parametrize("name", BUILTIN)
def test_scaling_multiplies_the_energy_by_a_power(name):
    kernels, xy = kernel_set(name, "plain", BACKEND), random_grid(*SIZE)
    energy, _, gradient = kernels.energy_gradient(xy)
    if name not in DEGREES:
        # Mixed degrees: Euler's theorem bounds gradient . position by the smallest and the largest.
        least = 0 if name == "area_winslow" else 2
        assert least * energy < (gradient * xy).sum() < 4 * energy
        return
    degree = DEGREES[name]
    assert kernels.energy(3 * xy)[0] == pytest.approx(3.0**degree * energy, rel=1e-12)
    assert (gradient * xy).sum() == pytest.approx(degree * energy, rel=1e-11, abs=1e-10 * energy)
