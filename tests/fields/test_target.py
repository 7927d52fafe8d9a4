"""Targets: a grid that attains one is found to ten digits, in every form; all functionals have their target form."""

from __future__ import annotations

import numpy as np
import pytest
import sympy
from hypothesis import given, settings
from hypothesis import strategies as st
from support import BUILTIN
from support_fields import (
    PLACED,
    at_corners,
    corner_matrices,
    logical,
    map_matrices,
    metric,
    relative,
    sum_over_corners,
)
from support_solvers import BACKENDS, CORNER_ENERGIES, disordered, farthest, mild_grid
from support_valid_grids import bent_grid, of_its_boundary

import gridgen_sym as gg
from gridgen_sym.functionals import functional
from gridgen_sym.symbolic.coordinates import TARGET
from gridgen_sym.symbolic.derive.discrete import variant_density

DIGITS = 1e-10


@pytest.fixture(scope="module")
def domains():
    """The Winslow grids of two domains."""
    starts = {"swan": gg.domain("swan", 17, 15), "quarter_annulus": gg.domain("quarter_annulus", 13, 12)}
    return {name: (start, gg.optimize(start, "winslow").grid) for name, start in starts.items()}


# ---- recovery ----


@settings(max_examples=30)
@given(seed=st.integers(0, 2**32 - 1))
def test_any_valid_grid_is_the_minimum_of_its_own_target(seed):
    wanted = bent_grid(seed)
    result = gg.optimize(of_its_boundary(wanted), "winslow", target=gg.Target.of(wanted))
    assert result.converged, result.message
    assert farthest(result.grid, wanted) < DIGITS


@pytest.mark.parametrize("seed", [29, 33, 88, 133, 272])
def test_where_rounding_holds_the_gradient_up_the_end_is_reported(seed):
    """Cells of a millionth of the mean area: the gradient there cannot fall by the factor, and nodes stand still."""
    wanted = bent_grid(seed, most_of_the_way=9)
    result = gg.optimize(of_its_boundary(wanted), "winslow", target=wanted)
    assert result.converged, result.message
    assert result.iterations < 100
    assert farthest(result.grid, wanted) < DIGITS


@pytest.mark.parametrize("seed", range(6))
def test_an_energy_that_is_zero_at_its_target_is_minimized_to_rounding(seed):
    """There the energy is a difference of terms that cancel, and tells nothing of the last steps."""
    wanted = disordered(gg.domain("wavy", 7 + seed, 12 - seed), 0.25, seed=seed)
    result = gg.optimize(of_its_boundary(wanted), "tmop_2", target=wanted)
    assert result.converged, result.message
    assert result.iterations < 100
    assert abs(result.energy) < 1e-14
    assert farthest(result.grid, wanted) < DIGITS


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("name", ["swan", "quarter_annulus"])
def test_a_disordered_grid_of_a_domain_comes_back(name, backend, domains):
    start, smooth = domains[name]
    wanted = disordered(smooth, 0.2, seed=3)
    result = gg.optimize(start, "winslow", target=wanted, backend=backend)
    assert result.converged, result.message
    assert farthest(result.grid, wanted) < DIGITS
    assert farthest(smooth, wanted) > 1e-3


@pytest.mark.parametrize("spacing", ["unit", "index", (0.3, 2.0)])
def test_it_comes_back_whatever_the_logical_steps(spacing, domains):
    start, smooth = domains["quarter_annulus"]
    wanted = disordered(smooth, 0.2, seed=3)
    assert farthest(gg.optimize(start, "winslow", target=wanted, spacing=spacing).grid, wanted) < DIGITS


def test_sweeps_find_it_as_well(domains):
    start, smooth = domains["quarter_annulus"]
    wanted = disordered(smooth, 0.2, seed=4)
    result = gg.optimize(start, "winslow", "local", target=gg.Target.of(wanted))
    assert result.converged, result.message
    assert farthest(result.grid, wanted) < 1e-5


@pytest.mark.slow
def test_the_other_condition_number_finds_it_too(domains):
    start, smooth = domains["quarter_annulus"]
    wanted = disordered(smooth, 0.1, seed=5)
    result = gg.optimize(start, "modified_liao", target=gg.Target.of(wanted))
    assert result.converged, result.message
    assert farthest(result.grid, wanted) < DIGITS


def test_the_law_of_a_tensor_grid_gives_it():
    """Edge lengths per cell of x = X(xi), y = Y(eta) on the unit square, from a uniform start."""
    start = gg.domain("square", 11, 9)
    xi, eta = (np.linspace(0, 1, count) for count in start.shape)
    sides = (np.expm1(2 * xi) / np.expm1(2), eta**1.5)
    wanted = gg.Grid.from_planes(*np.meshgrid(*sides, indexing="ij"))
    lengths = np.meshgrid(*map(np.diff, sides), indexing="ij")
    result = gg.optimize(of_its_boundary(wanted), "winslow", target=gg.Target(*lengths))
    assert farthest(result.grid, wanted) < DIGITS
    scrambled = disordered(wanted, 0.3, seed=1)
    assert farthest(gg.optimize(scrambled, "winslow", target=gg.Target(*lengths)).grid, wanted) < DIGITS


def test_an_angle_gives_parallelograms():
    along, up = np.array([1.0, 0.0]) / 8, np.array([np.cos(np.pi / 3), np.sin(np.pi / 3)]) / 4
    index = np.indices((9, 8)).transpose(1, 2, 0)
    wanted = gg.Grid(index @ np.stack((along, up)))
    target = gg.Target(0.125, 0.25, angle=60)
    result = gg.optimize(disordered(wanted, 0.3), "winslow", target=target)
    assert farthest(result.grid, wanted) < DIGITS
    least, leaning = (gg.energy(wanted, "winslow", target=gg.Target(0.125, 0.25, angle=a)) for a in (60, 90))
    assert np.isclose(gg.energy(wanted, "winslow", target=gg.Target.of(wanted)), least, rtol=1e-13)
    assert leaning > 1.1 * least


# ---- energies ----


def target_energy(grid, name, matrices):
    """The energy relative to a target (2, 2, 4, ni-1, nj-1), in NumPy."""
    own = metric(relative(corner_matrices(grid), matrices))
    return CORNER_ENERGIES[name](own["g11"], own["g22"], own["g12"], own["J"]).sum()


@pytest.mark.parametrize("backend", BACKENDS)
def test_two_lengths_are_a_diagonal_target(backend):
    grid, (w1, w2) = mild_grid(), (0.2, 0.35)
    own = metric(corner_matrices(grid))
    expected = ((own["g11"] / w1**2 + own["g22"] / w2**2) * w1 * w2 / own["J"]).sum()
    found = sum_over_corners(grid, "winslow", target=gg.Target(w1, w2), backend=backend)
    assert found == pytest.approx(expected, rel=1e-12)


def matrix_of(grid, w1, w2, angle=90.0):
    """The target of two lengths and an angle, at the corners."""
    cells = (4, *(count - 1 for count in grid.shape))
    w1, w2, angle = (np.broadcast_to(one, cells) for one in (w1, w2, np.deg2rad(angle)))
    return np.stack([np.stack([w1, w2 * np.cos(angle)]), np.stack([0 * w1, w2 * np.sin(angle)])])


LAWS = (
    ("0.1 + xi*eta", lambda xi, eta: 0.1 + xi * eta),
    ("0.2 + eta**2", lambda xi, eta: 0.2 + eta**2),
    ("80 + 20*xi", lambda xi, eta: 80 + 20 * xi),
)
FORMS = {
    "text": lambda text, call, at: text,
    "SymPy": lambda text, call, at: sympy.sympify(text),
    "function": lambda text, call, at: call,
    "nodes": lambda text, call, at: call(*at),
    "corners": lambda text, call, at: at_corners(call(*at)),
}


@pytest.mark.parametrize("form", FORMS)
def test_every_form_of_a_law_is_the_same_target(form):
    grid = mild_grid()
    at = logical(grid.shape)
    law = gg.Target(*(FORMS[form](text, call, at) for text, call in LAWS))
    matrices = matrix_of(grid, *(at_corners(call(*at)) for _, call in LAWS))
    for target in (law, gg.Target.matrix(matrices.reshape(4, *matrices.shape[2:]))):
        found = sum_over_corners(grid, "winslow", target=target, backend="numpy")
        assert found == pytest.approx(target_energy(grid, "winslow", matrices), rel=1e-12)


def test_a_law_per_cell_and_one_number_go_together():
    grid = mild_grid()
    cells = np.random.default_rng(1).uniform(0.1, 0.3, (8, 7))
    whole = gg.Target(np.stack([cells] * 4), np.full((9, 8), 0.2), 90)
    options = {"backend": "numpy"}
    one = gg.energy(grid, "winslow", target=gg.Target(cells, 0.2), **options)
    assert one == pytest.approx(gg.energy(grid, "winslow", target=whole, **options), rel=1e-14)


def test_a_length_per_node_and_one_per_corner_go_together():
    grid = mild_grid()
    random = np.random.default_rng(8)
    nodal, corners = random.uniform(0.1, 0.3, (9, 8)), random.uniform(0.1, 0.3, (4, 8, 7))
    mixed, whole = (
        gg.energy(grid, "winslow", target=gg.Target(w1, corners), backend="numpy") for w1 in (nodal, at_corners(nodal))
    )
    assert mixed == pytest.approx(whole, rel=1e-14)


@pytest.mark.parametrize(
    "source",
    [
        ("0.2", "0.1*y", "0", "0.3 + 0.1*x"),
        lambda x, y: (0.2, 0.1 * y, 0, 0.3 + 0.1 * x),
        tuple(sympy.sympify(text) for text in ("0.2", "y/10", "0", "0.3 + x/10")),
    ],
    ids=["text", "function", "SymPy"],
)
def test_a_matrix_may_be_of_the_place(source):
    grid = mild_grid()
    x, y = grid.planes
    nodal = np.stack([np.full_like(x, 0.2), 0.1 * y, 0 * x, 0.3 + 0.1 * x])
    options = {"backend": "numpy"}
    expected = gg.energy(grid, "winslow", target=gg.Target.matrix(nodal), **options)
    assert gg.energy(grid, "winslow", target=gg.Target.matrix(source, "physical"), **options) == pytest.approx(expected)
    result = gg.optimize(grid, "winslow", target=gg.Target.matrix(source, "physical"), **options)
    assert result.converged, result.message


@pytest.mark.parametrize("name", BUILTIN)
def test_every_functional_has_its_target_form(name):
    """The density with a target is that of the edges T = A W⁻¹."""
    random = np.random.default_rng(7)
    matrices, target = random.normal(size=(2, 2, 4)), random.normal(size=(2, 2, 4))
    matrices[0, 0] += 4
    matrices[1, 1] += 4
    target[0, 0] += 4
    target[1, 1] += 4
    own, inverse = metric(relative(matrices, target)), np.linalg.inv(np.moveaxis(target, (0, 1), (-2, -1)))
    density, parameters = functional(name), functional(name).parameters
    given = metric(matrices) | {f"V{i + 1}{j + 1}": inverse[..., i, j] for i in (0, 1) for j in (0, 1)}
    derived = variant_density(density, "target")
    for _ in range(2):
        derived = derived.subs(TARGET)
    np.testing.assert_allclose(
        evaluated(derived, given | parameters), evaluated(density.expression(), own | parameters | {"s": 1}), rtol=1e-12
    )


def evaluated(expression, values):
    names = sorted(map(str, expression.free_symbols))
    return sympy.lambdify(sorted(expression.free_symbols, key=str), expression)(*(values[name] for name in names))


@pytest.mark.slow
def test_a_density_may_name_both_metrics():
    grid, wanted = mild_grid(), mild_grid(disorder=0.1)
    own, to_target = (metric(m) for m in (map_matrices(grid), relative(*map(corner_matrices, (grid, wanted)))))
    (x, y), (xi, eta) = ([at_corners(plane) for plane in planes] for planes in (grid.planes, logical(grid.shape)))
    terms = (1 + x**2) * own["g11"] + (1 + xi * eta) * own["g22"] + to_target["g11"] + y * to_target["g22"]
    found = sum_over_corners(grid, PLACED, target=wanted, backend="numpy")
    assert found == pytest.approx((terms / own["J"]).sum(), rel=1e-12)
    without = (1 + x**2 + 1) * own["g11"] + (1 + xi * eta + y) * own["g22"]
    found = sum_over_corners(grid, PLACED, backend="numpy")
    assert found == pytest.approx((without / own["J"]).sum(), rel=1e-12)


# ---- other solvers ----


@pytest.mark.slow
def test_the_equations_take_a_target():
    """The solution of the equations with a smooth target is near the minimum, and not near the one without."""
    start, target = mild_grid(17, 17), gg.Target("0.05*(1 + xi)", "0.06", 90)
    solution = gg.solve_euler_lagrange(start, "winslow", target=target)
    assert solution.converged, solution.message
    minimum, plain = (gg.optimize(start, "winslow", target=one).grid for one in (target, None))
    assert farthest(solution.grid, minimum) < 0.003 < 0.02 < farthest(minimum, plain)


@pytest.mark.slow
def test_a_target_per_corner_is_restricted_to_coarse_grids():
    """A folded start has its coarse grids solved with the target, too, and the result is the target's grid."""
    start = gg.domain("swan", 65, 65)
    smooth = gg.optimize(start, "winslow").grid
    wanted = gg.optimize(start, "winslow", weight="1 + 5*x**2").grid
    result = gg.optimize(start, "winslow", target=wanted)
    assert result.converged, result.message
    assert farthest(result.grid, wanted) < DIGITS < 1e-3 < farthest(smooth, wanted)


# ---- refusals ----


def folded():
    xy = gg.domain("square", 5, 5).xy
    xy[2, 2] = (2.0, 2.0)
    return gg.Grid(xy)


@pytest.mark.parametrize(
    ("make", "match"),
    [
        (
            lambda: gg.Target.of(folded()),
            r"must be valid; it is folded at corner \(0, 2, 2\), x = 2, y = 2: untangle it",
        ),
        (lambda: gg.Target.of("swan"), "expected a Grid"),
        (lambda: gg.Target("1 + x", 1), "w1 of the target: unknown name 'x'"),
        (lambda: gg.Target(1, "1 +"), "w2 of the target"),
        (
            lambda: gg.Target.matrix((1, 0, 1)),
            "the target is matrix and needs 4 components, in the order W11, W12, W21",
        ),
        (lambda: gg.Target.matrix((1, 0, 0, 1), "polar"), "domain must be 'physical' or 'logical'; came 'polar'"),
    ],
)
def test_what_is_no_target_is_refused_at_once(make, match):
    with pytest.raises(gg.GridgenError, match=match):
        make()


@pytest.mark.parametrize(
    ("target", "match"),
    [
        (gg.Target(0.1, 0), r"positive area; det W is 0 at node \(0, 0\).*lengths must be positive"),
        (gg.Target(0.1, 0.2, angle=200), r"det W is -0.00684.*the angle between 0 and 180"),
        (gg.Target("0.5 - xi", 1), r"det W is 0 at node \(4, 0\)"),
        (gg.Target(np.ones((3, 3)), 1), r"w1 of the target must have one value per node, shape \(9, 8\).*\(3, 3\)$"),
        (gg.Target(np.full((8, 7), np.nan), 1), r"w1 of the target must be finite at every cell.*cell \(0, 0\)"),
        (gg.Target("1/xi", 1), r"w1 of the target must be finite at every node; it is inf at node \(0, 0\), xi = 0"),
        (mild_grid(9, 9), r"reference grid of the target has \(9, 9\) nodes, and this grid \(9, 8\)"),
        ("reference.vts", "target must be a Target, such as Target.of"),
        (2.0, "target must be a Target"),
    ],
)
def test_bad_targets_are_refused_with_their_place_and_the_repair(target, match):
    with pytest.raises(gg.GridgenError, match=match):
        gg.energy(mild_grid(), "winslow", target=target, backend="numpy")


def test_lengths_of_a_reference_grid_at_another_angle():
    skew = gg.Grid(gg.domain("square", 5, 7).xy @ np.array([[1.0, 0.0], [0.5, 1.0]]))
    for angle in (90, 60.0):
        w = np.stack([part.numbers for part in gg.Target.of(skew, angle=angle).parts]).reshape(2, 2, -1)
        lengths = np.hypot(w[0], w[1])
        assert lengths[0] == pytest.approx(1 / 4)
        assert lengths[1] == pytest.approx(np.sqrt(1.25) / 6)
        assert (w[:, 0] * w[:, 1]).sum(axis=0) / lengths.prod(axis=0) == pytest.approx(np.cos(np.deg2rad(angle)))
    for wrong in (0, 180, "right", np.nan):
        with pytest.raises(gg.GridgenError, match="must be between 0 and 180 degrees; came"):
            gg.Target.of(skew, angle=wrong)
