"""Places outside the samples of a field: a grid with nodes there is refused, unless the nearest sample is to count."""

from functools import partial

import numpy as np
import pytest
from support_fields import CONTROLLED

import gridgen_sym as gg
from gridgen_sym.fields.sampled import SampledField, grid_field

AXIS = np.linspace(0.2, 0.8, 9)
SQUARE = np.stack(np.meshgrid(AXIS, AXIS, indexing="ij"))
VALUES = 1 + SQUARE[0]
SAMPLES = {
    "raster": (partial(gg.Weight.on_raster, AXIS, AXIS, VALUES), "on a raster of 9 x 9 points"),
    "points": (partial(gg.Weight.on_points, SQUARE.reshape(2, -1).T, VALUES.ravel()), "at 81 points"),
    "grid": (partial(gg.Weight.on_grid, gg.Grid.from_planes(*SQUARE), VALUES), "on a grid of 9 x 9 nodes"),
}
SOLVERS = {
    "energy": gg.energy,
    "gradient": gg.gradient,
    "hessian": gg.hessian,
    "newton": partial(gg.optimize, max_iterations=1),
    "local": partial(gg.optimize, method="local", max_iterations=1),
    "equations": partial(gg.solve_euler_lagrange, max_iterations=1),
    "adapt": lambda grid, functional, fields: gg.adapt(
        grid, "x", functional=functional, weight_exponent=1, fields=fields
    ),
}


@pytest.mark.parametrize("mode", ["frozen", "differentiated"])
@pytest.mark.parametrize("samples", SAMPLES)
def test_a_node_outside_the_samples_is_refused_by_name_and_place(samples, mode):
    make, kind = SAMPLES[samples]
    with pytest.raises(gg.GridgenError) as caught:
        gg.energy(gg.domain("square", 9, 9), "winslow", weight=make(mode))
    message = str(caught.value)
    assert message.startswith(f"the weight is known by samples {kind}, and node (0, 0), x = 0, y = 0, lies outside")
    assert "56 of 81 nodes" in message
    assert "outside='nearest'" in message
    weight = make(mode, outside="nearest")
    assert np.isfinite(gg.energy(gg.domain("square", 9, 9), "winslow", weight=weight))


@pytest.mark.slow
@pytest.mark.parametrize("solver", SOLVERS)
def test_everything_that_takes_fields_refuses_such_a_node(solver):
    with pytest.raises(gg.GridgenError, match=r"the field p is known by samples .*node \(0, 0\)"):
        SOLVERS[solver](
            gg.domain("square", 7, 7), CONTROLLED, fields={"p": gg.Field.on_raster(AXIS, AXIS, VALUES), "q": 1}
        )


def test_weights_targets_and_what_a_grid_is_adapted_to_are_refused_too():
    square = gg.domain("square", 7, 7)
    with pytest.raises(gg.GridgenError, match="the weight is known by samples"):
        gg.optimize(square, "combined", weight=gg.Weight.on_raster(AXIS, AXIS, VALUES))
    with pytest.raises(gg.GridgenError, match=r"w2 of the target is known by samples .* xi = 0, eta = 0, lies"):
        gg.optimize(square, "winslow", target=gg.Target(0.1, gg.raster_field(AXIS, AXIS, VALUES)))
    with pytest.raises(gg.GridgenError, match="the solution is known by samples"):
        gg.adapt(square, gg.raster_field(AXIS, AXIS, VALUES))
    with pytest.raises(gg.GridgenError, match=r"the weight is known by samples .* cell \(0, 0\)"):
        gg.equidistribution(square, gg.Weight.on_raster(AXIS, AXIS, VALUES))


@pytest.mark.parametrize("samples", SAMPLES)
def test_nodes_on_the_edge_of_the_samples_are_inside_up_to_rounding(samples):
    turn = np.array([[np.cos(0.3), -np.sin(0.3)], [np.sin(0.3), np.cos(0.3)]])
    inside = gg.Grid(np.moveaxis(SQUARE * (1 + 1e-14), 0, -1))
    gg.energy(inside, "winslow", weight=SAMPLES[samples][0]())
    # A rotated edge is hit by rounding only, at other nodes than those of the samples.
    turned = gg.Weight.on_points(SQUARE.reshape(2, -1).T @ turn, VALUES.ravel())
    other = gg.Grid.from_planes(*np.meshgrid(*[np.linspace(0.2, 0.8, 14)] * 2, indexing="ij")).xy @ turn
    exact = gg.energy(gg.Grid(other), "winslow", weight=lambda x, y: 1 + x * turn[0, 0] + y * turn[0, 1])
    assert gg.energy(gg.Grid(other), "winslow", weight=turned) == pytest.approx(exact, rel=1e-6)


def test_a_little_outside_is_outside():
    grid = gg.Grid(np.moveaxis(0.5 + (SQUARE - 0.5) * 1.001, 0, -1))
    for samples in ("raster", "points"):
        with pytest.raises(gg.GridgenError, match="lies outside of them"):
            gg.energy(grid, "winslow", weight=SAMPLES[samples][0]())


def test_two_grids_of_one_domain_cut_its_curves_differently():
    fine, coarse = gg.domain("swan", 30, 30), gg.domain("swan", 17, 17)
    field = grid_field(gg.optimize(fine, "winslow").grid, np.ones((30, 30)))
    assert field.covers(*gg.optimize(coarse, "winslow").grid.planes).all()
    assert not field.covers(np.array([0.5]), np.array([-1.0])).any()


def test_a_solver_may_leave_the_samples_on_its_way():
    """Inner nodes of a folded start lie anywhere; only its boundary, and the grid that comes out, must be sampled."""
    nodes = gg.domain("square", 9, 9).xy.copy()
    nodes[3, 4] += (1.5, 0)
    axis = np.linspace(0, 1, 9)
    weight = gg.Weight.on_raster(axis, axis, np.ones((9, 9)))
    result = gg.optimize(gg.Grid(nodes), "winslow", weight=weight)
    assert result.converged
    assert result.quality.valid
    with pytest.raises(gg.GridgenError, match=r"node \(3, 4\), x = 1\.\d+, .*1 of 81"):
        gg.energy(gg.Grid(nodes), "winslow", weight=weight)


def test_a_result_whose_nodes_have_left_the_samples_is_refused_and_kept():
    """The samples lack a disk that no node of the start lies in."""
    nodes = gg.domain("square", 9, 9).xy.copy()
    nodes[4, 4] = (0.56, 0.56)

    def covers(x, y):
        return np.hypot(x - 0.5, y - 0.5) > 0.03

    weight = SampledField("around a hole", "error", None, lambda x, y: np.ones_like(x), covers)
    with pytest.raises(gg.GridgenError, match=r"the weight is .* around a hole, and node \(4, 4\)") as caught:
        gg.optimize(gg.Grid(nodes), "winslow", weight=weight)
    assert caught.value.result.quality.valid
    np.testing.assert_allclose(caught.value.result.grid.xy[4, 4], 0.5, atol=1e-6)


def test_only_two_choices():
    with pytest.raises(gg.GridgenError, match="outside must be 'error' or 'nearest'; came 'mirror'"):
        gg.raster_field(AXIS, AXIS, VALUES, outside="mirror")
