"""A functional of a user, and parameters: every solver takes them at once, on both backends alike."""

from __future__ import annotations

import numpy as np
import pytest
from support_solvers import (
    METHODS,
    assert_consistent,
    energy_differences,
    farthest,
    gradient_differences,
    mild_grid,
    relative,
)

import gridgen_sym as gg


@pytest.fixture
def walled():
    """Return a functional with a barrier and a parameter: smoothness, and equal cells as far as `k` wants."""

    def walled(m, k=0.5):
        return (m.g11 + m.g22) / m.J + k * (m.J + 1 / m.J)

    return gg.define("walled", walled, constraints=("k >= 0",))


@pytest.fixture
def springy():
    """Return a functional without a barrier, as text."""
    return gg.define("springy", "(g11 + g22)/2 + k*g12**2 + J**2", parameters={"k": 0.3}, corner_factor=2)


@pytest.mark.slow
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("which", ["walled", "springy"])
def test_it_is_minimized_on_both_backends(method, which, backend, request):
    definition = request.getfixturevalue(which)
    start = mild_grid(8, 7)
    result = gg.optimize(start, which, method, backend=backend, tolerance=1e-8)
    assert result.converged, result.message
    assert result.quality.valid
    assert_consistent(result, which, backend=backend)
    expected = gg.optimize(start, definition, backend="numpy", tolerance=1e-8)
    assert farthest(result.grid, expected.grid) < 1e-6
    assert result.energy == pytest.approx(expected.energy, rel=1e-11)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["newton", "relaxation"])
@pytest.mark.parametrize("which", ["walled", "springy"])
def test_its_equations_are_solved_on_both_backends(method, which, backend, request):
    request.getfixturevalue(which)
    start = mild_grid(8, 7)
    result = gg.solve_euler_lagrange(start, which, method, backend=backend)
    assert result.converged, result.message
    expected = gg.solve_euler_lagrange(start, which, backend="numpy")
    assert farthest(result.grid, expected.grid) < 1e-6
    # The minimum solves the same equations, up to the error of the differences.
    assert farthest(result.grid, gg.optimize(start, which).grid) < 0.03 < farthest(result.grid, start)


def test_its_barrier_untangles(walled):
    result = gg.untangle(gg.domain("swan", 13, 13), "walled", backend="numpy")
    assert result.converged, result.message
    assert result.quality.valid


def test_its_parameter_is_there_while_it_untangles(walled):
    start = gg.domain("swan", 13, 13)
    one, other = (gg.untangle(start, "walled", parameters={"k": k}, backend="numpy").grid for k in (0.0, 50.0))
    assert farthest(one, other) > 1e-4


@pytest.mark.slow
def test_its_derivatives_are_differences(walled):
    grid = mild_grid(5, 6)
    options = {"parameters": {"k": 2.0}}
    assert relative(gg.gradient(grid, "walled", **options), energy_differences(grid, "walled", 1e-5, **options)) < 1e-5
    hessian = gg.hessian(grid, "walled", **options).toarray()
    assert relative(hessian, gradient_differences(grid, "walled", 1e-6, **options)) < 1e-5


def test_its_parameter_is_its_own(walled):
    grid, none = mild_grid(), {"k": 0.0}
    assert gg.energy(grid, "walled", parameters=none) == pytest.approx(gg.energy(grid, "winslow"), rel=1e-13)
    by_hand = gg.energy(grid, "winslow") + 0.5 * (
        gg.energy(grid, "walled", parameters={"k": 1.0}) - gg.energy(grid, "winslow")
    )
    assert gg.energy(grid, "walled") == pytest.approx(by_hand, rel=1e-12)
    plain, equal = (gg.optimize(grid, "walled", parameters={"k": k}).grid for k in (0.0, 50.0))
    assert farthest(plain, gg.optimize(grid, "winslow").grid) < 1e-6
    # More of the second term makes the cells more equal.
    assert gg.quality(equal).max_area_ratio < gg.quality(plain).max_area_ratio


def test_a_functional_that_was_never_registered_is_solved_too():
    own = gg.Functional("own_length", "(g11 + g22)/2", corner_factor=2)
    assert "own_length" not in gg.functionals()
    found = gg.optimize(mild_grid(), own, backend="numpy")
    assert farthest(found.grid, gg.optimize(mild_grid(), "length").grid) < 1e-6


def test_a_new_definition_takes_the_place_of_the_old_one():
    grid = mild_grid()
    gg.define("changing", "g11 + g22")
    first = gg.energy(grid, "changing", backend="numpy")
    gg.define("changing", "2*(g11 + g22)", replace=True)
    assert gg.energy(grid, "changing", backend="numpy") == pytest.approx(2 * first, rel=1e-14)


# ---- parameters of the combined functional ----

SHARES = {"area": "k_A", "length": "k_L", "orthogonality": "k_O"}


@pytest.mark.parametrize("name", SHARES)
def test_one_share_alone_is_its_functional(name):
    grid = mild_grid()
    parameters = {share: float(SHARES[name] == share) for share in SHARES.values()}
    assert gg.energy(grid, "combined", parameters=parameters) == pytest.approx(gg.energy(grid, name), rel=1e-13)
    assert relative(gg.gradient(grid, "combined", parameters=parameters), gg.gradient(grid, name)) < 1e-13
    assert (
        relative(gg.hessian(grid, "combined", parameters=parameters).toarray(), gg.hessian(grid, name).toarray())
        < 1e-13
    )


@pytest.mark.parametrize("method", METHODS)
def test_shares_change_the_grid(method):
    start = mild_grid()
    default = gg.optimize(start, "combined", method)
    given = gg.optimize(start, "combined", method, parameters={"k_A": 0.1, "k_L": 0.8, "k_O": 0.1})
    assert given.converged
    assert farthest(default.grid, given.grid) > 1e-4
    assert_consistent(given, "combined", parameters={"k_A": 0.1, "k_L": 0.8, "k_O": 0.1})
    only_length = gg.optimize(start, "combined", method, parameters={"k_A": 0, "k_L": 1, "k_O": 0})
    assert farthest(only_length.grid, gg.optimize(start, "length", method).grid) < 1e-6


@pytest.mark.parametrize(
    ("parameters", "said"),
    [
        ({"k_A": 0.5}, "needs k_A \\+ k_L \\+ k_O == 1; came k_A = 0.5, k_L = 0.2, k_O = 0.4"),
        ({"k_A": -1, "k_L": 1, "k_O": 1}, "needs k_A >= 0"),
        ({"k_a": 0.4}, "no parameter 'k_a'; it has k_A, k_L, k_O"),
        ({"k_A": float("nan")}, "parameter 'k_A' .* is nan: give a finite number"),
        ({"k_A": float("inf")}, "parameter 'k_A' .* is inf: give a finite number"),
    ],
)
@pytest.mark.parametrize("solve", [gg.optimize, gg.solve_euler_lagrange, gg.energy, gg.gradient, gg.hessian])
def test_bad_parameters_are_refused(solve, parameters, said):
    with pytest.raises(gg.GridgenError, match=said):
        solve(mild_grid(), "combined", parameters=parameters)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["newton", "local"])
def test_an_energy_without_a_lower_bound_is_told(method):
    gg.define("runaway", lambda m: -m.g11 - m.g22)
    start = gg.domain("wavy", 9, 9)
    guarded = gg.optimize(start, "runaway", method)
    assert not guarded.converged
    assert guarded.quality.valid
    free = gg.optimize(start, "runaway", method, keep_valid=False)
    assert not free.converged
    assert "diverge, which happens where the energy has no lower bound" in free.message
    assert np.abs(free.grid.planes).max() < 1e5
