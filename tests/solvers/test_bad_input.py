"""Whatever comes in, a solver either works or raises a GridgenError that names the thing."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from support import BUILTIN
from support_solvers import farthest, mild_grid

import gridgen_sym as gg

FEW = settings(max_examples=25)
SOLVERS = {"optimize": gg.optimize, "solve_euler_lagrange": gg.solve_euler_lagrange}
ALL = SOLVERS | {"untangle": gg.untangle}
EVERYTHING = ALL | {"energy": gg.energy, "gradient": gg.gradient, "hessian": gg.hessian}

each_solver = pytest.mark.parametrize("solve", SOLVERS.values(), ids=SOLVERS)
each_of_all = pytest.mark.parametrize("solve", ALL.values(), ids=ALL)
each_function = pytest.mark.parametrize("solve", EVERYTHING.values(), ids=EVERYTHING)

numbers = st.floats(allow_nan=True, allow_infinity=True)
#: Names that come close to the right ones, and any other.
names = st.sampled_from(["", "Winslow", "winslow ", "winslo", "newtonn", "../winslow"]) | st.text(max_size=12)


# ---- grids ----


@FEW
@given(
    ni=st.integers(3, 8),
    nj=st.integers(3, 8),
    bad=st.sampled_from([np.nan, np.inf, -np.inf]),
    data=st.data(),
)
def test_a_node_that_is_not_finite_is_named(ni, nj, bad, data):
    xy = gg.domain("square", ni, nj).xy
    i, j, c = (data.draw(st.integers(0, n - 1)) for n in (ni, nj, 2))
    xy[i, j, c] = bad
    with pytest.raises(gg.GridgenError) as caught:
        gg.Grid(xy)
    assert f"node ({i}, {j})" in str(caught.value)


@FEW
@given(shape=st.lists(st.integers(0, 5), max_size=4))
def test_coordinates_of_any_shape_make_a_grid_or_an_error(shape):
    xy = np.random.default_rng(0).normal(size=shape)
    if len(shape) == 3 and shape[2] == 2 and min(shape[:2]) >= 3:
        assert gg.Grid(xy).shape == tuple(shape[:2])
    else:
        with pytest.raises(gg.GridgenError, match=r"shape \(ni, nj, 2\)|at least 3 x 3 nodes"):
            gg.Grid(xy)


@each_function
@pytest.mark.parametrize(
    "grid", [gg.domain("square", 5, 5).xy, None, "swan", 3], ids=["array", "none", "text", "number"]
)
def test_what_is_no_grid_is_refused(solve, grid):
    with pytest.raises(gg.GridgenError, match="grid"):
        solve(grid, "winslow")


@pytest.mark.slow
@each_of_all
def test_the_smallest_grid_is_solved(solve):
    start = gg.domain("wavy", 3, 3)
    result = solve(start, "winslow")
    assert result.converged, result.message


# ---- names ----


@each_function
@FEW
@given(name=names)
def test_an_unknown_functional_is_named(solve, name):
    if name in gg.functionals():
        return
    with pytest.raises(gg.GridgenError) as caught:
        solve(mild_grid(), name)
    assert f"unknown functional {name!r}" in str(caught.value)


@each_function
@pytest.mark.parametrize(
    "name",
    [
        None,
        3,
        b"winslow",
        1.5,
        ["winslow"],
    ],
    ids=repr,
)
def test_a_functional_that_is_no_name_is_refused(solve, name):
    with pytest.raises(gg.GridgenError, match="functional"):
        solve(mild_grid(), name)


@each_solver
@FEW
@given(method=names)
@example(method="Newton")
@example(method="multigrid")
def test_an_unknown_method_is_named(solve, method):
    with pytest.raises(gg.GridgenError) as caught:
        solve(mild_grid(), "winslow", method)
    assert f"unknown method {method!r}" in str(caught.value)
    assert "'newton' or" in str(caught.value)


@each_solver
@pytest.mark.parametrize("method", [None, 3, ["newton"]], ids=repr)
def test_a_method_that_is_no_name_is_refused(solve, method):
    with pytest.raises(gg.GridgenError, match="unknown method"):
        solve(mild_grid(), "winslow", method)


@each_function
@FEW
@given(backend=names)
def test_an_unknown_backend_is_named(solve, backend):
    if not backend:
        return
    with pytest.raises(gg.GridgenError) as caught:
        solve(mild_grid(), "winslow", backend=backend)
    assert f"unknown backend {backend!r}" in str(caught.value)


@each_function
@FEW
@given(parameter=st.text(min_size=1, max_size=8), value=numbers)
def test_an_unknown_parameter_is_named(solve, parameter, value):
    with pytest.raises(gg.GridgenError) as caught:
        solve(mild_grid(), "winslow", parameters={parameter: value})
    assert f"no parameter {parameter!r}" in str(caught.value)


@pytest.mark.parametrize("solve", [gg.optimize, gg.solve_euler_lagrange, gg.energy, gg.gradient, gg.hessian])
@pytest.mark.parametrize("parameters", [{"k_A": "a"}, {"k_A": None}, 5, [1]], ids=repr)
def test_parameters_that_are_no_numbers_are_refused(solve, parameters):
    with pytest.raises(gg.GridgenError, match="parameter"):
        solve(mild_grid(), "combined", parameters=parameters)


# ---- controls ----


@each_solver
@FEW
@given(tolerance=numbers.filter(lambda value: not 0 < value < 1))
@example(tolerance=0.0)
@example(tolerance=1.0)
@example(tolerance=float("nan"))
def test_a_tolerance_outside_of_0_and_1_is_refused(solve, tolerance):
    with pytest.raises(gg.GridgenError, match=r"tolerance .* between 0 and 1; came"):
        solve(mild_grid(), "winslow", tolerance=tolerance)


@each_solver
@FEW
@given(limit=st.integers(max_value=-1))
def test_a_negative_number_of_iterations_is_refused(solve, limit):
    with pytest.raises(gg.GridgenError, match=f"max_iterations must not be negative; came {limit}"):
        solve(mild_grid(), "winslow", max_iterations=limit)


@each_solver
@pytest.mark.parametrize(
    "options",
    [
        {"tolerance": "a"},
        {"tolerance": [1e-3]},
        {"max_iterations": 2.5},
        {"max_iterations": True},
        {"max_iterations": "3"},
        {"max_iterations": float("nan")},
    ],
    ids=repr,
)
def test_controls_of_another_type_are_refused(solve, options):
    with pytest.raises(gg.GridgenError):
        solve(mild_grid(), "winslow", **options)


@pytest.mark.parametrize(
    "spacing",
    [
        (0, 1),
        (1, -1),
        (0.0, 0.0),
        (np.nan, 1),
        (1, np.inf),
        (1,),
        (1, 2, 3),
        3,
        "ab",
        None,
    ],
    ids=repr,
)
def test_a_spacing_that_means_nothing_is_refused(spacing):
    with pytest.raises(gg.GridgenError, match="spacing is 'unit', 'index' or two positive numbers"):
        gg.solve_euler_lagrange(mild_grid(), "length", spacing=spacing)
    with pytest.raises(gg.GridgenError, match="spacing is 'unit', 'index' or two positive numbers"):
        gg.optimize(mild_grid(), "length", spacing=spacing)


@FEW
@given(relaxation=numbers.filter(lambda value: not 0 < value < 2))
def test_a_relaxation_outside_of_0_and_2_is_refused(relaxation):
    with pytest.raises(gg.GridgenError, match="relaxation between 0 and 2"):
        gg.solve_euler_lagrange(mild_grid(), "winslow", "relaxation", relaxation=relaxation)


# ---- masks ----


@each_of_all
@FEW
@given(shape=st.lists(st.integers(0, 9), max_size=3), kind=st.sampled_from([bool, int]))
@example(shape=[8, 9], kind=bool)
def test_a_mask_of_another_shape_is_refused(solve, shape, kind):
    if shape == [9, 8]:
        return
    with pytest.raises(gg.GridgenError, match=r"fixed must be a mask of the grid's shape \(9, 8\)"):
        solve(mild_grid(9, 8), "winslow", fixed=np.zeros(shape, dtype=kind))


@each_of_all
@pytest.mark.parametrize("kind", [float, complex, object, "U3", "datetime64[s]"])
def test_a_mask_of_another_type_is_refused(solve, kind):
    with pytest.raises(gg.GridgenError, match=r"fixed must be a mask .* came shape .*, type"):
        solve(mild_grid(9, 8), "winslow", fixed=np.zeros((9, 8), dtype=kind))


@each_of_all
def test_a_ragged_mask_is_refused(solve):
    with pytest.raises(gg.GridgenError, match="fixed"):
        solve(mild_grid(), "winslow", fixed=[[1], [1, 2]])


# ---- grids at the edge of what numbers can hold ----


@pytest.mark.slow
@pytest.mark.parametrize("name", ["length", "winslow", "liao"])
@each_solver
def test_a_huge_grid_is_solved(solve, name):
    result, expected = (solve(gg.Grid(mild_grid().xy * scale), name) for scale in (1e25, 1.0))
    assert result.converged, result.message
    assert np.isfinite(result.energy)
    assert farthest(gg.Grid(result.grid.xy / 1e25), expected.grid) < 1e-6


@pytest.mark.parametrize("name", ["length", "winslow", "liao"])
@each_function
def test_a_grid_beyond_all_bounds_is_refused(solve, name):
    if solve is gg.untangle and name != "winslow":
        return
    with pytest.raises(gg.GridgenError, match=r"coordinates reach 1.*e\+200, .* scale them"):
        solve(gg.Grid(mild_grid().xy * 1e200), name)


@each_function
def test_a_grid_whose_powers_vanish_is_refused(solve):
    """Of coordinates of 1e-100 every product underflows: a folded grid would look like a solution."""
    with pytest.raises(gg.GridgenError, match=r"extent is .*e-100, .* scale it"):
        solve(gg.Grid(mild_grid().xy * 1e-100), "winslow")


@pytest.mark.parametrize("name", BUILTIN)
@each_solver
def test_a_grid_of_one_point_is_not_called_good(solve, name):
    result = solve(gg.Grid(np.full((5, 5, 2), 0.3)), name)
    assert result.quality.folded_cells == 16
    assert np.isfinite(result.grid.planes).all()
    if name in ("winslow", "modified_liao"):
        assert not result.converged


@each_solver
def test_a_mirrored_grid_cannot_be_made_valid(solve):
    result = solve(gg.Grid(mild_grid().xy[::-1]), "winslow")
    assert not result.converged
    assert result.quality.folded_cells > 0
    assert "folded" in result.message


def test_a_gradient_is_written_where_it_is_asked_for():
    grid = gg.domain("wavy", 7, 6)
    out = np.full((7, 6, 2), np.nan)
    assert gg.gradient(grid, "winslow", out=out) is out
    assert np.array_equal(out, gg.gradient(grid, "winslow"))
    with pytest.raises(gg.GridgenError, match="several blocks does not take 'out'"):
        gg.gradient(gg.layout("tee"), "winslow", out=out)


@pytest.mark.parametrize(
    ("out", "came"),
    [
        (np.zeros((2, 7, 6)), r"of the shape \(7, 6, 2\); came float64, shape \(2, 7, 6\)"),
        (np.zeros((7, 6, 2), dtype=np.float32), "came float32"),
        ([], r"came \[\]"),
        (np.broadcast_to(0.0, (7, 6, 2)), "read-only"),
    ],
)
def test_a_gradient_is_not_written_elsewhere(out, came):
    with pytest.raises(gg.GridgenError, match=came):
        gg.gradient(gg.domain("wavy", 7, 6), "winslow", out=out)
