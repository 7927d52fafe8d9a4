"""Functionals of users take the whole way: functions, fractional powers, and parameters with awkward names."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from support import (
    close,
    derived_kernel,
    evaluate,
    metric_values,
    parameter_values,
    random_grid,
    random_values,
    relative_difference,
    run,
)

from gridgen_sym.functionals import define
from gridgen_sym.runtime import find_compiler, kernels
from gridgen_sym.symbolic.derive.discrete import corner_model

pytestmark = pytest.mark.usefixtures("clean_registry")

DENSITIES = {
    "waves": ("sin(J)*cos(g12) + tanh(x_eta)**2 + pi*g11", {}),
    "roots": ("sqrt(g11*g22)/J", {}),
    "powers": ("(g11 + g22)**1.5 + J**12", {}),
    "awkward": ("t0*g11 + energy*g22/J + b0*g12**2 + d0*J**2", {"t0": 2, "energy": 0.5, "b0": 0.1, "d0": 3}),
    "exponent": ("(g11 + g22)**p", {"p": 1.5}),
    "templates": ("corner*g11 + parameters*g22 + w*J**2", {"corner": 1.5, "parameters": 0.5, "w": 2}),
    "own_weight": ("s*J**2 + (1 + s)**2*g11", {}),
}  # fmt: skip


@pytest.fixture(params=DENSITIES)
def defined(request):
    density, parameters = DENSITIES[request.param]
    return define(request.param, density, parameters=parameters, corner_factor=2)


@pytest.mark.slow
@pytest.mark.parametrize("variant", ["plain", "differentiated"])
def test_programs_equal_the_derived_expressions(defined, variant):
    programs, model = derived_kernel(defined, variant).programs, corner_model(defined, variant)
    with mpmath.workdps(40):
        program = programs["corner_hessian"]
        values = random_values(program.inputs, parameter_values(defined, variant), 5)
        found, known = run(program, values), metric_values(values)
        assert close(found["energy"], evaluate(model.energy, known), mpmath.mpf(10) ** -30)
        for row in range(4):
            assert close(found[f"d{row}"], evaluate(model.gradient[row], known), mpmath.mpf(10) ** -30)
            for column in range(row, 4):
                expected = evaluate(model.hessian[row, column], known)
                assert close(found[f"h{row}{column}"], expected, mpmath.mpf(10) ** -28)


@pytest.mark.slow
@pytest.mark.skipif(find_compiler() is None, reason="needs a C compiler")
@pytest.mark.parametrize("defined", ["waves", "powers", "awkward"], indirect=True)
def test_kernels_equal_on_both_backends(defined):
    xy = random_grid(5, 66)
    compiled, plain = (kernels(defined, backend=backend) for backend in ("c", "numpy"))
    for value, expected in zip(compiled.energy_gradient(xy), plain.energy_gradient(xy), strict=True):
        assert relative_difference(value, expected) < 1e-12
    for semidefinite in (False, True):
        planes = [k.hessian(xy, semidefinite=semidefinite) for k in (compiled, plain)]
        assert relative_difference(*planes) < 1e-11
    assert relative_difference(*(k.euler_lagrange_jacobian(xy) for k in (compiled, plain))) < 1e-12


def test_kernels_read_their_parameters_in_order():
    defined = define("ordered", "zz*g11 + aa*g22 + mm*J**2", parameters={"zz": 1, "aa": 10, "mm": 100})
    xy = np.stack(np.meshgrid(2.0 * np.arange(2), 3.0 * np.arange(2), indexing="ij"))
    # One cell of 2 x 3: g11 = 4, g22 = 9, J = 6 at each of its four corners.
    for backend in ("numpy", "c") if find_compiler() else ("numpy",):
        assert kernels(defined, backend=backend).energy(xy) == (4 * (4 + 90 + 3600), 6)
        assert kernels(defined, parameters={"aa": 0}, backend=backend).energy(xy)[0] == 4 * (4 + 3600)
        assert kernels(defined, parameters={"mm": 1, "zz": 2}, backend=backend).energy(xy)[0] == 4 * (8 + 90 + 36)


def test_unknown_parameters_are_refused():
    defined = define("ordered", "zz*g11 + g22", parameters={"zz": 1})
    with pytest.raises(ValueError, match="'ordered' has no parameter 'zy'; it has zz"):
        kernels(defined, parameters={"zy": 1}, backend="numpy")


@pytest.mark.slow
def test_what_stands_for_a_barrier_is_found():
    with_barrier = define("walled", "g11/J + g22")
    without = define("open", "g11*J + g22")
    assert derived_kernel(with_barrier, "plain").facts.barrier
    assert not derived_kernel(without, "plain").facts.barrier
    xy = random_grid(4, 4)
    expected = kernels(with_barrier, backend="numpy").energy(xy)[0]
    near = kernels(with_barrier, "regularized", {"epsilon": 1e-7}, "numpy").energy(xy)[0]
    assert near == pytest.approx(expected, rel=1e-10)
    with pytest.raises(ValueError, match="'open' has no barrier at J = 0"):
        derived_kernel(without, "regularized")


def test_kernels_do_not_depend_on_the_whole_classification():
    assert derived_kernel(define("hard", "(g11 + g22)**1.25/J**1.5 + J**12"), "plain").facts.barrier
