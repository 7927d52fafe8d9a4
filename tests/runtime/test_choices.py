"""Kernels of choices: both backends agree, also at ties, and the branch that does not hold does no harm."""

from __future__ import annotations

import numpy as np
import pytest
from support import random_grid, relative_difference

from gridgen_sym.functionals import Functional
from gridgen_sym.runtime import find_compiler, kernels

pytestmark = pytest.mark.slow

#: Branches that have no value, or no derivative, where they do not hold.
UNDEFINED = "g11 + where(J > 1, log(J - 1)*(J - 1)**3, 0) + where(g12 < 0, 1, g12**2.5)"
MORE = (
    " + max(0, J - 1)**2*where(J <= 1, 3, 1/sqrt(J - 1)) + where(g11 > 1, acos(1/g11), asin(g11))*J"
    " + min(g11, J, 1.1)**2 + max(g22, 1)*atan2(J, g12) + sign(g11 - g22)*(g11 - g22)**2"
)
#: Every choice of two, and their arguments turned, one for each parameter.
TIES = {
    "a": ("max(g11, J*g22)", "g11"), "b": ("max(J*g22, g11)", "J*g22"), "c": ("min(g11, J*g22)", "g11"),
    "d": ("min(J*g22, g11)", "J*g22"), "e": ("where(J < 1, g11, g22)", "g22"), "f": ("where(J <= 1, g11, g22)", "g11"),
    "g": ("where(J > 1, g11, g22)", "g22"), "h": ("where(J >= 1, g11, g22)", "g11"),
    "i": ("max(g12, J - 1, 2*g12)", "g12"), "j": ("max(0, 1 - J)", "0*J"),
}  # fmt: skip


def combined(part):
    terms = " + ".join(f"{name}*({texts[part]})" for name, texts in TIES.items())
    return Functional("ties" if part == 0 else "branches", terms, parameters=dict.fromkeys(TIES, 1.0))


def results(functional, backend, grid, second, parameters=None):
    """Return energy, smallest Jacobian and gradient; with `second` the Hessian, and its product with whole numbers."""
    kernel = kernels(functional, backend=backend, parameters=parameters)
    if second:
        return [kernel.hessian(grid), kernel.hessian_vector(grid, np.round(9 * np.sin(7 * grid)))]
    energy, smallest, gradient = kernel.energy_gradient(grid)
    return [np.array([energy, smallest]), gradient]


derivatives = pytest.mark.parametrize("second", [False, pytest.param(True, marks=pytest.mark.slow)])


@derivatives
@pytest.mark.skipif(find_compiler() is None, reason="needs a C compiler")
def test_backends_agree_where_branches_are_undefined(second):
    grid = random_grid(9, 70)
    functional = Functional("undefined", UNDEFINED + MORE * second)
    for compiled, plain in zip(*(results(functional, name, grid, second) for name in ("c", "numpy")), strict=True):
        assert np.isfinite(plain).all()
        assert relative_difference(compiled, plain) <= 1e-12


@derivatives
def test_the_derivative_at_a_tie_is_that_of_one_branch(backend, second):
    """On unit squares everything is equal: each choice must have the derivatives of the branch that is documented."""
    squares = np.stack(np.meshgrid(np.arange(5.0), np.arange(70.0), indexing="ij"))
    chosen, branch = combined(0), combined(1)
    for name in TIES:
        parameters = dict.fromkeys(TIES, 0.0) | {name: 1.0}
        found = results(chosen, backend, squares, second, parameters)
        expected = results(branch, "numpy", squares, second, parameters)
        for one, other in zip(found, expected, strict=True):
            np.testing.assert_array_equal(one, other, err_msg=TIES[name][0])
