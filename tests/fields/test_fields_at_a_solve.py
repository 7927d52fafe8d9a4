"""Fields at a solve: every form gives one grid, solvers take them, known answers come out, bad values are refused."""

from __future__ import annotations

import numpy as np
import pytest
import sympy
from support_fields import (
    CONTROLLED,
    DVINSKY,
    PLACED,
    at_corners,
    logical,
    map_matrices,
    metric,
    sum_over_corners,
)
from support_solvers import (
    BACKENDS,
    disordered,
    energy_differences,
    farthest,
    gradient_differences,
    mild_grid,
    relative,
)

import gridgen_sym as gg

pytestmark = pytest.mark.slow

SMOOTH = ("1 + x**2", "0.3*sin(y)", "1 + exp(-x)")


def tensor(x, y):
    return np.stack([1 + x**2, 0.3 * np.sin(y), 1 + np.exp(-x)])


def tensor_of_three(x, y):
    """The same as a tuple of arrays."""
    return 1 + x**2, 0.3 * np.sin(y), 1 + np.exp(-x)


AXIS = np.linspace(-0.3, 1.3, 41)
FINE = np.stack(np.meshgrid(AXIS, AXIS, indexing="ij"))
#: Sampled forms: how they are made, and how near their grid is to that of the formula.
SAMPLED = {
    "on_grid": lambda mode: gg.Field.on_grid(gg.Grid.from_planes(*FINE), tensor(*FINE), mode),
    "on_raster": lambda mode: gg.Field.on_raster(AXIS, AXIS, tensor(*FINE), mode),
    "on_points": lambda mode: gg.Field.on_points(FINE.reshape(2, -1).T, tensor(*FINE).reshape(3, -1), mode),
}
EXACT = {
    "SymPy": lambda mode: gg.Field(tuple(map(sympy.sympify, SMOOTH)), mode=mode),
    "function": lambda mode: gg.Field(tensor, mode=mode),
    "function of a tuple": lambda mode: gg.Field(tensor_of_three, mode=mode),
    "functions": lambda mode: gg.Field(tuple(lambda x, y, k=k: tensor(x, y)[k] for k in range(3)), mode=mode),
}
MODES = ("frozen", "differentiated")


def solved(field, start=None, functional=DVINSKY, **options):
    result = gg.optimize(start or mild_grid(), functional, fields={"M": field}, backend="numpy", **options)
    assert result.converged, result.message
    return result.grid


@pytest.fixture(scope="module")
def expected():
    return {mode: solved(gg.Field(SMOOTH, mode=mode)) for mode in MODES}


# ---- forms ----


@pytest.mark.parametrize("mode", ["frozen", pytest.param("differentiated", marks=pytest.mark.slow)])
@pytest.mark.parametrize("form", [*EXACT, *SAMPLED])
def test_every_form_of_a_tensor_gives_one_grid(form, mode, expected):
    field = (EXACT | SAMPLED)[form](mode)
    accuracy = 2e-3 if form in SAMPLED else 1e-7
    assert farthest(solved(field), expected[mode]) < accuracy
    assert farthest(solved((1, 0, 1)), expected[mode]) > 5e-3


@pytest.mark.parametrize("location", ["nodes", "lists", "tuple", "corners", "mixed"])
def test_arrays_are_the_values_of_the_present_grid(location):
    grid = mild_grid()
    nodal = tensor(*grid.planes)
    corners = np.stack([at_corners(plane) for plane in nodal])
    field = {
        "nodes": nodal,
        "lists": nodal.tolist(),
        "tuple": tuple(nodal),
        "corners": corners,
        "mixed": (nodal[0], corners[1], SMOOTH[2]),
    }[location]
    for backend in BACKENDS:
        of_array, of_formula = (
            gg.gradient(grid, DVINSKY, fields={"M": one}, backend=backend) for one in (field, SMOOTH)
        )
        np.testing.assert_allclose(of_array, of_formula, rtol=1e-12, atol=1e-12)


def test_an_array_per_cell_is_that_of_its_four_corners():
    grid = mild_grid()
    cells = np.random.default_rng(2).uniform(1, 2, (8, 7))
    one, four = (gg.energy(grid, CONTROLLED, fields={"p": p, "q": 2}) for p in (cells, np.stack([cells] * 4)))
    assert one == pytest.approx(four, rel=1e-14)


def test_values_per_corner_are_in_the_order_of_corner_jacobians():
    """The paper's s(k_i): a weight of one at a single corner leaves the energy of that corner."""
    grid = mild_grid(5, 4)
    jacobians = gg.corner_jacobians(grid.x, grid.y)
    unit = gg.energy(grid, "area")
    for place in np.ndindex(jacobians.shape):
        values = np.zeros(jacobians.shape)
        values[place] = 1
        share = jacobians[place] ** 2 / (jacobians**2).sum()
        assert gg.energy(grid, "area", weight=values) / unit == pytest.approx(share, rel=1e-12)


@pytest.mark.parametrize(
    "source",
    ["1 + xi*eta", 1 + sympy.Symbol("xi") * sympy.Symbol("eta"), lambda xi, eta: 1 + xi * eta],
    ids=["text", "SymPy", "function"],
)
def test_every_form_of_a_logical_field_is_one(source):
    grid = mild_grid()
    xi, eta = logical(grid.shape)
    given, array = (
        gg.gradient(grid, CONTROLLED, fields={"p": p, "q": 1.0})
        for p in (gg.Field(source, domain="logical"), 1 + xi * eta)
    )
    np.testing.assert_allclose(given, array, rtol=1e-13, atol=1e-13)


def test_every_place_may_be_named():
    grid = mild_grid()
    (x, y), (xi, eta) = ([at_corners(plane) for plane in planes] for planes in (grid.planes, logical(grid.shape)))
    own = metric(map_matrices(grid))
    terms = ((2 + x**2) * own["g11"] + (1 + xi * eta + y) * own["g22"]) / own["J"]
    assert sum_over_corners(grid, PLACED, backend="numpy") == pytest.approx(terms.sum(), rel=1e-12)
    gradient = gg.gradient(grid, PLACED, backend="numpy")
    assert relative(gradient, energy_differences(grid, PLACED, 1e-6, backend="numpy")) < 1e-6


# ---- derivatives ----


@pytest.mark.parametrize("backend", ["numpy", pytest.param("c", marks=pytest.mark.slow)])
@pytest.mark.parametrize("source", [SMOOTH, pytest.param(tensor, marks=pytest.mark.slow)], ids=["formula", "function"])
def test_a_differentiated_field_belongs_to_the_energy(source, backend):
    grid = mild_grid(5, 6)
    options = {"fields": {"M": gg.Field(source, mode="differentiated")}, "backend": backend}
    gradient = gg.gradient(grid, DVINSKY, **options)
    assert relative(gradient, energy_differences(grid, DVINSKY, 1e-6, **options)) < 1e-6
    hessian = gg.hessian(grid, DVINSKY, **options).toarray()
    assert relative(hessian, gradient_differences(grid, DVINSKY, 1e-6, **options)) < 1e-5


@pytest.mark.parametrize("backend", ["numpy", pytest.param("c", marks=pytest.mark.slow)])
def test_a_frozen_field_is_held(backend):
    grid = mild_grid(5, 6)
    held = {"fields": {"M": tensor(*grid.planes)}, "backend": backend}
    given = {"fields": {"M": SMOOTH}, "backend": backend}
    gradient = gg.gradient(grid, DVINSKY, **given)
    assert relative(gradient, energy_differences(grid, DVINSKY, 1e-6, **held)) < 1e-6
    assert relative(gradient, energy_differences(grid, DVINSKY, 1e-6, **given)) > 0.01
    hessian = gg.hessian(grid, DVINSKY, **given).toarray()
    assert relative(hessian, gradient_differences(grid, DVINSKY, 1e-6, **held)) < 1e-5


@pytest.mark.slow
def test_a_field_a_weight_and_a_target_go_together():
    grid, wanted = mild_grid(5, 6), mild_grid(5, 6, disorder=0.1)
    options = {
        "fields": {"M": gg.Field(SMOOTH, mode="differentiated")},
        "weight": gg.Weight("1 + x*y", "differentiated"),
        "target": gg.Target.of(wanted),
        "backend": "numpy",
    }
    gradient = gg.gradient(grid, DVINSKY, **options)
    assert relative(gradient, energy_differences(grid, DVINSKY, 1e-6, **options)) < 1e-6
    hessian = gg.hessian(grid, DVINSKY, **options).toarray()
    assert relative(hessian, gradient_differences(grid, DVINSKY, 1e-6, **options)) < 1e-5


# ---- known answers ----


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("method", ["newton", pytest.param("local", marks=pytest.mark.slow)])
def test_a_scalar_monitor_drops_out_of_harmonic_maps(mode, method):
    start = mild_grid()
    scalar = gg.Field(("2 + sin(3*x)*y", 0, "2 + sin(3*x)*y"), mode=mode)
    options = {"method": method, "tolerance": 1e-9}
    expected = gg.optimize(start, "winslow", **options).grid
    assert farthest(solved(scalar, start, **options), expected) < 1e-7


@pytest.mark.slow
@pytest.mark.parametrize("name", ["swan", "quarter_annulus"])
def test_a_scalar_monitor_drops_out_on_the_domains(name):
    start = gg.domain(name, 33, 33)
    expected = gg.optimize(start, "winslow").grid
    for mode in MODES:
        field = gg.Field(("1 + x**2 + y**2", 0, "1 + x**2 + y**2"), mode=mode)
        result = gg.optimize(start, DVINSKY, fields={"M": field})
        assert result.converged, result.message
        assert farthest(result.grid, expected) < 1e-5


def controlled_grid(nodes):
    """The grid of a rectangle with p = X', q = Y', and x = X(xi), y = Y(eta)."""
    xi, eta = (np.linspace(0, 1, nodes),) * 2
    x, y = (xi + xi**2) / 2 * 3, eta + 0.25 * np.sin(np.pi * eta) ** 2 * 0.5
    wanted = gg.Grid.from_planes(*np.meshgrid(x, y, indexing="ij"))
    slopes = {"p": gg.Field("(1 + 2*xi)/2*3", domain="logical")}
    slopes["q"] = gg.Field("1 + 0.25*pi*sin(pi*eta)*cos(pi*eta)", domain="logical")
    result = gg.optimize(disordered(wanted, 0.1), CONTROLLED, fields=slopes)
    assert result.converged, result.message
    return farthest(result.grid, wanted)


def test_control_functions_give_the_tensor_grid_of_a_rectangle():
    """At second order."""
    coarse, fine = controlled_grid(9), controlled_grid(17)
    assert fine < 3e-3
    assert 3 < coarse / fine < 5


# ---- solves ----


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "density", "fields"),
    [
        ("swan", "(1 + 0.5*sin(3*x))*(g11 + g22)/J", {}),
        ("quarter_annulus", "(g11*(1 + xi) + g22)/J", {}),
        ("quarter_annulus", "(p*g11 + q*g22)/J", {"p": "scalar", "q": "scalar"}),
        ("swan", "(g11 + g22)/J + 5*max(0, g12/J)**2", {}),
        ("swan", DVINSKY.density, {"M": "symmetric"}),
    ],
    ids=["x", "xi", "two scalars", "max", "tensor"],
)
def test_densities_of_everything_are_minimized_without_a_fold(name, density, fields):
    functional = gg.define("one_of_all", density, fields=fields)
    values = {"p": "1 + x**2", "q": gg.Field("1 + eta", domain="logical"), "M": ("2 + sin(x)", "0.5", "2 - sin(y)")}
    start = gg.domain(name, 15, 15)
    result = gg.optimize(start, functional, fields={key: values[key] for key in fields}, backend="numpy")
    assert result.quality.valid, result.message
    assert result.converged, result.message


def test_a_folded_start_is_untangled_before_fields_count():
    start = gg.domain("swan", 13, 13)
    assert not gg.quality(start).valid
    field = ("2 + sin(x)", 0.2, "1 + y**2")
    result = gg.optimize(start, DVINSKY, fields={"M": field}, backend="numpy")
    assert result.converged, result.message
    assert result.untangled_by
    assert result.quality.valid


@pytest.mark.slow
def test_nested_grids_find_the_same_grid():
    """On coarse grids formulas are evaluated, and arrays are restricted; the finest grid decides."""
    start = gg.domain("quarter_annulus", 65, 65)
    xi, eta = logical(start.shape)
    law = gg.Field("1 + xi*eta", domain="logical")
    arrays = {"p": 1 + xi * eta, "q": at_corners(1 + xi)}
    formulas = {"p": law, "q": gg.Field("1 + xi", domain="logical")}
    phases = []
    nested = gg.optimize(start, CONTROLLED, fields=formulas, callback=lambda step: phases.append(step.shape))
    assert len(set(phases)) > 2, "coarse grids were used"
    restricted = gg.optimize(start, CONTROLLED, fields=arrays)
    directly = gg.optimize(disordered(start, 0.05), CONTROLLED, fields=formulas)
    assert nested.converged
    assert farthest(nested.grid, directly.grid) < 1e-6
    assert farthest(restricted.grid, directly.grid) < 1e-6
    assert nested.iterations < directly.iterations


@pytest.mark.slow
@pytest.mark.parametrize("method", ["newton", "relaxation"])
def test_the_equations_take_fields(method):
    """Their solution is near the minimum, up to the error of the differences."""
    start, fields = mild_grid(17, 17), {"M": SMOOTH}
    solution = gg.solve_euler_lagrange(start, DVINSKY, method, fields=fields, backend="numpy")
    assert solution.converged, solution.message
    minimum = gg.optimize(start, DVINSKY, fields=fields, backend="numpy").grid
    plain = gg.optimize(start, "winslow").grid
    assert farthest(solution.grid, minimum) < 0.003 < 0.006 < farthest(minimum, plain)


@pytest.mark.parametrize("method", ["newton", pytest.param("local", marks=pytest.mark.slow)])
def test_converged_means_with_the_values_of_the_last_positions(method):
    """A frozen field lags behind the nodes; the gradient that is reported is that of the field where they are."""
    start = mild_grid()
    result = gg.optimize(start, DVINSKY, method, fields={"M": SMOOTH}, backend="numpy")
    last = gg.gradient(result.grid, DVINSKY, fields={"M": SMOOTH}, backend="numpy")
    assert result.converged
    assert np.linalg.norm(last) == pytest.approx(result.history[-1].gradient_norm, rel=1e-6, abs=1e-12)
    first = np.linalg.norm(gg.gradient(start, DVINSKY, fields={"M": SMOOTH}, backend="numpy"))
    assert np.linalg.norm(last) <= 1.01e-6 * first


def test_a_field_that_is_another_at_every_call_is_no_convergence():
    random = np.random.default_rng(3)
    fields = {"p": lambda x, y: random.uniform(1, 2) * np.ones_like(x), "q": 1}
    result = gg.optimize(mild_grid(), CONTROLLED, fields=fields)
    assert not result.converged
    assert result.status in (gg.Status.UNSETTLED, gg.Status.STALLED), result.message


def test_a_callback_and_a_time_limit_end_a_run():
    seen = []

    def stop(step):
        seen.append(step)
        if len(seen) == 2:
            raise StopIteration

    fields = {"p": "1 + x", "q": "1 + y"}
    stopped = gg.optimize(mild_grid(), CONTROLLED, fields=fields, callback=stop)
    assert stopped.interrupted
    assert len(seen) == 2
    late = gg.optimize(mild_grid(33, 33), CONTROLLED, fields=fields, time_limit=1e-9)
    assert late.interrupted
    assert late.quality.valid


def test_nodes_outside_the_samples_are_reported_where_the_nearest_counts():
    axis = np.linspace(0.3, 0.7, 9)
    field = gg.Field.on_raster(axis, axis, np.ones((9, 9)), outside="nearest")
    result = gg.optimize(mild_grid(), CONTROLLED, fields={"p": field, "q": 1})
    assert "nodes lie outside the samples of the field p: the nearest sample counts there." in result.message


def test_validity_alone_needs_no_fields():
    start = gg.domain("swan", 13, 13)
    assert gg.untangle(start, DVINSKY).quality.valid


@pytest.mark.slow
def test_adaptation_takes_fields_and_a_target():
    """The density of nodes is a weight; the metric is that of the field, or relative to a target."""
    start, front = gg.domain("square", 17, 17), "tanh(10*(x + y - 1))"
    functional = gg.define("adapted", "s*J**2/2 + 0.02*(p*g11 + g22)/J", fields={"p": "scalar"})
    options = {"weight_exponent": 2.0, "max_iterations": 4, "boundary": "fixed", "backend": "numpy"}
    one, four = (gg.adapt(start, front, functional=functional, fields={"p": p}, **options) for p in ("1", "4"))
    assert one.quality.valid
    assert four.quality.valid
    assert farthest(one.grid, four.grid) > 1e-3
    with pytest.raises(gg.GridgenError, match="needs values of the field p"):
        gg.adapt(start, front, functional=functional, **options)
    aimed = gg.adapt(start, front, target=gg.Target(1 / 16, 1 / 32, angle=70), boundary="fixed", max_iterations=4)
    assert aimed.quality.valid
    assert farthest(aimed.grid, gg.adapt(start, front, boundary="fixed", max_iterations=4).grid) > 1e-3


# ---- refusals ----

NAN = np.ones((9, 8))
NAN[3, 5] = np.nan
INDEFINITE = np.stack([np.ones((9, 8)), np.zeros((9, 8)), np.ones((9, 8))])
INDEFINITE[1, 2, 3] = -1.5


@pytest.mark.parametrize(
    ("field", "match"),
    [
        (INDEFINITE, r"field M must be positive definite; it is not at node \(2, 3\), x = .*M12 = -1.5.*identity"),
        (("x - 0.2", 0, 1), r"field M must be positive definite; it is not at node \(0, 0\), x = 0, y = 0"),
        (INDEFINITE[:, :-1, :-1], r"not at cell \(2, 3\), where M11 = 1"),
        (
            (NAN, 0, 1),
            r"the component M11 of the field M must be finite at every node; it is nan at node \(3, 5\), x =",
        ),
        (("1/x", 0, 1), r"component M11 of the field M must be finite.*node \(0, 0\), x = 0.*check its formula there"),
        (("1e150", 0, 1), r"component M11 of the field M is 1e\+150 at node \(0, 0\).*divide it by a constant"),
        ((np.ones((4, 4)), 0, 1), r"component M11 .* shape \(9, 8\), per cell, shape \(8, 7\), or per corner.*on_grid"),
        (np.ones((2, 9, 8)), r"needs 3 components, in the order M11, M12, M22.*came an array of shape \(2, 9, 8\)"),
        (("1", "0"), "needs 3 components.*a tuple of 3 formulas"),
        ("1", "needs 3 components.*came '1'"),
        (
            lambda x, y: np.ones((2, *x.shape)),
            r"must return an array of shape \(3, 9, 8\), components first; came \(2,",
        ),
        (lambda x: x, "needs 3 components"),
        (lambda x, y: 1 / 0, r"component M11 of the field M .*lambda.* cannot be evaluated: ZeroDivisionError"),
        (("x", 0, "1 + z"), "component M22 of the field M: unknown name 'z'"),
        (gg.Field(("xi", 0, 1)), "component M11 of the field M: unknown name 'xi'"),
        (
            gg.Field(INDEFINITE, mode="differentiated"),
            "field M is an array, which has no derivatives: use mode='frozen'",
        ),
    ],
)
def test_bad_tensors_are_refused_with_their_place_and_the_repair(field, match):
    with pytest.raises(gg.GridgenError, match=match):
        gg.energy(mild_grid(), DVINSKY, fields={"M": field}, backend="numpy")


@pytest.mark.parametrize(
    ("fields", "match"),
    [
        (None, r"'spread' needs values of the field p \(scalar\): give fields=\{'p': \.\.\.\}"),
        ({"p": 1}, r"needs values of the field q"),
        ({"p": 1, "q": 1, "r": 2}, r"has no field 'r'; it declares p \(scalar\), q \(scalar\)"),
        ({"p": 1, "q": 1, "s": 2}, "has no field 's'.*give the weight as weight="),
        ([1, 2], "fields must map names to values"),
        ({"p": "x - 0.5", "q": 1}, r"'spread' needs p > 0; at node \(0, 0\), x = 0, y = 0 came p = -0.5: change"),
        ({"p": 1, "q": 1e-4}, r"needs q > 1e-3; at node \(0, 0\).*q = 0.0001: change the field q there"),
        ({"p": gg.Field("xi - 0.5", domain="logical"), "q": 1}, r"p > 0; at node \(0, 0\), xi = 0, eta = 0"),
        ({"p": -np.ones((4, 8, 7)), "q": 1}, r"needs p > 0; at corner \(0, 0, 0\), x = 0, y = 0 came p = -1"),
        ({"p": np.ones((3, 9, 8)), "q": 1}, r"the field p must have one value per node, shape \(9, 8\)"),
        ({"p": ("1", "2"), "q": 1}, r"the field p is scalar and needs 1 component, in the order p"),
    ],
)
def test_bad_fields_are_refused_by_name(fields, match):
    with pytest.raises(gg.GridgenError, match=match):
        gg.energy(mild_grid(), CONTROLLED, fields=fields, backend="numpy")


def test_a_constraint_on_two_fields_is_checked_where_both_are():
    functional = gg.define(
        "ordered", "(p*g11 + q*g22)/J", fields={"p": "scalar", "q": "scalar"}, constraints=("p < q",)
    )
    with pytest.raises(gg.GridgenError, match=r"needs p < q; at cell|corner .*p = 2, q = 1: change the field p or q"):
        gg.energy(mild_grid(), functional, fields={"p": np.full((8, 7), 2.0), "q": "1"}, backend="numpy")


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (lambda: gg.Field("x", domain="polar"), "domain must be 'physical' or 'logical'; came 'polar'"),
        (lambda: gg.Field("x", mode="melted"), "mode must be 'frozen' or 'differentiated'; came 'melted'"),
        (lambda: gg.Field("xi", "logical", "differentiated"), "nothing to differentiate through: drop mode"),
        (lambda: gg.Field.on_raster(AXIS, AXIS, np.ones(41)), r"must have 2 axes, or 3 with the components along the"),
    ],
)
def test_what_is_no_field_is_refused_at_once(make, match):
    with pytest.raises(gg.GridgenError, match=match):
        make()


def test_a_field_that_ends_on_the_way_ends_steps_and_not_the_run():
    """A trial position where a field has no value, or none that is allowed, is not taken."""
    start = gg.domain("square", 17, 17)
    fields = {"p": "sqrt(1.0001 - x)*sqrt(1e-4 + x) + 1e-3", "q": 1}
    for mode in MODES:
        given = {"p": gg.Field(fields["p"], mode=mode), "q": fields["q"]}
        result = gg.optimize(start, CONTROLLED, fields=given, max_iterations=10, backend="numpy")
        assert result.quality.valid
        assert np.isfinite(result.energy)


def test_a_field_without_a_derivative_is_named_by_its_term():
    functional = gg.define("kinked", "g11 + g22 + sqrt(abs(p*J - 1))", fields={"p": "scalar"})
    result = gg.optimize(gg.domain("square", 9, 9), functional, fields={"p": np.ones((9, 9))}, backend="numpy")
    assert "the functional kinked has no derivative at this grid: the term sqrt(Abs" in result.message
