"""Functionals whose kernels are constants, and runs that are stopped."""

import pytest

import gridgen_sym as gg


@pytest.fixture
def constant_kernels(clean_registry):
    """Two functionals whose equations hold constants where others have arrays: J, and one of x alone."""
    gg.define("null_lagrangian", "J")
    gg.define("of_x_alone", "x_xi**2 + x_eta**2")


@pytest.mark.slow
@pytest.mark.parametrize("name", ["null_lagrangian", "of_x_alone"])
def test_backends_agree_where_kernels_are_constant(constant_kernels, name):
    start = gg.domain("swan", 9, 9)
    for method in ("newton", "relaxation"):
        results = [gg.solve_euler_lagrange(start, name, method, backend=b, max_iterations=20) for b in ("c", "numpy")]
        assert results[0].converged == results[1].converged
        assert abs(results[0].grid.xy - results[1].grid.xy).max() < 1e-9


@pytest.mark.parametrize("backend", ["c", "numpy"])
@pytest.mark.parametrize("method", ["newton", "local"])
def test_every_grid_is_a_solution_of_a_null_lagrangian(constant_kernels, backend, method):
    start = gg.domain("swan", 17, 17)
    result = gg.optimize(start, "null_lagrangian", method, backend=backend)
    assert result.converged, result.message
    assert result.grid == start
    assert result.message.endswith(
        "are folded. The energy of null_lagrangian is the same for every grid with this boundary: "
        "there is nothing to minimize."
    )
    assert gg.energy(gg.optimize(start, "winslow").grid, "null_lagrangian") == pytest.approx(result.energy, rel=1e-12)


@pytest.mark.slow
def test_what_is_no_null_lagrangian_on_the_grid_is_not_called_one(constant_kernels):
    """With a weight, or without some of the corners, the energy differs from grid to grid."""
    start = gg.domain("swan", 9, 9)
    for options in ({"weight": "1 + x"}, {"weight": gg.Weight("1 + x", "differentiated")}, {"interior_only": True}):
        assert "same for every grid" not in gg.optimize(start, "null_lagrangian", max_iterations=1, **options).message
    assert "same for every grid" not in gg.optimize(start, "of_x_alone", max_iterations=1).message


def test_sweeps_that_change_nothing_end(constant_kernels):
    result = gg.solve_euler_lagrange(gg.domain("swan", 9, 9), "of_x_alone", "relaxation")
    assert not result.converged
    assert result.iterations < 10
    assert "singular" in result.message


@pytest.mark.parametrize(
    "solve",
    [
        lambda start, stop: gg.untangle(start, callback=stop),
        lambda start, stop: gg.optimize(start, "winslow", callback=stop),
        lambda start, stop: gg.optimize(start, "winslow", "local", callback=stop),
        lambda start, stop: gg.solve_euler_lagrange(start, "winslow", callback=stop),
        lambda start, stop: gg.solve_euler_lagrange(start, "winslow", "relaxation", callback=stop),
    ],
    ids=["untangle", "newton", "local", "euler-lagrange", "relaxation"],
)
def test_an_interrupt_returns_the_best_grid_that_there_was(solve):
    start = gg.domain("swan", 17, 17)

    def stop(step):
        if step.iteration == 2:
            raise KeyboardInterrupt

    result = solve(start, stop)
    assert result.interrupted
    assert not result.converged
    assert "interrupted" in result.message
    assert result.quality.folded_cells <= gg.quality(start).folded_cells
