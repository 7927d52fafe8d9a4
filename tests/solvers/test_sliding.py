"""Sliding boundary nodes: conformal maps that are known, derivatives along the curves, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import gridgen_sym as gg
from gridgen_sym.boundary.slide_curve import SlideCurve, chord_fractions, slide_curve
from gridgen_sym.solvers.binding import make_problem
from gridgen_sym.solvers.sliding.prolongation import finer_parameters, shrink_corners
from gridgen_sym.solvers.sliding.side import SlidingSide, side_index
from gridgen_sym.solvers.sliding.slide import Slide
from gridgen_sym.solvers.subdomains import restrict

SIDES_ALL = "bottom", "right", "top", "left"

# The sides of a quarter of the annulus with radii 1 and 2, as functions of t.
QUARTER = {
    "bottom": lambda t: np.stack([np.cos(np.pi / 2 * (1 - t)), np.sin(np.pi / 2 * (1 - t))], -1),
    "top": lambda t: 2 * np.stack([np.cos(np.pi / 2 * (1 - t)), np.sin(np.pi / 2 * (1 - t))], -1),
    "left": lambda t: np.stack([0 * t, 1 + t], -1),
    "right": lambda t: np.stack([1 + t, 0 * t], -1),
}


def uneven_quarter(n):
    """A start whose boundary nodes are far from where they belong."""
    u = np.linspace(0, 1, n + 1)
    v = u + np.sin(2 * np.pi * u) / 40
    sides = {side: QUARTER[side](t) for side, t in zip(QUARTER, (v, u**1.1, v, u), strict=True)}
    return gg.transfinite(**sides)


@pytest.mark.parametrize("backend", ["c", "numpy"])
@pytest.mark.parametrize(("n", "energy"), [(8, 2.7195863267723), (16, 2.7104758100262)])
def test_the_quarter_annulus_is_conformal_to_round_off(n, energy, backend):
    result = gg.optimize(uneven_quarter(n), "winslow", slide=QUARTER, tolerance=1e-12, backend=backend)
    assert result.converged
    radius, angle = np.hypot(result.grid.x, result.grid.y), np.arctan2(result.grid.y, result.grid.x)
    u = np.linspace(0, 1, n + 1)
    np.testing.assert_allclose(radius, np.broadcast_to(2**u, radius.shape), atol=1e-11)
    np.testing.assert_allclose(angle, np.broadcast_to(np.pi / 2 * (1 - u[:, None]), angle.shape), atol=1e-11)
    assert result.energy_per_corner == pytest.approx(energy, abs=1e-12)


def test_the_module_of_a_trapezoid():
    corners = np.array([[0.0, 0], [1, 0], [1, 2], [0, 1]])
    energies = []
    for n in (16, 32, 64):
        u = np.linspace(0, 1, n + 1)[:, None]
        side = {k: corners[a] + u * (corners[b] - corners[a]) for k, a, b in SIDES}
        energies.append(gg.optimize(gg.transfinite(**side), "winslow", slide="all", tolerance=1e-10).energy_per_corner)
    first, second, third = energies
    ratio = (second - third) / (first - second)
    limit = third - (second - third) * ratio / (1 - ratio)
    module = (limit + np.sqrt(limit**2 - 4)) / 2
    assert module == pytest.approx(1.279261571171, abs=1e-4)


SIDES = (("bottom", 0, 1), ("top", 3, 2), ("left", 0, 3), ("right", 1, 2))


def sprung_quarter():
    """The same curves with springs, uneven ones, on three sides of 6 x 6 cells."""
    random = np.random.default_rng(7)
    curves = {side: slide_curve(curve) for side, curve in QUARTER.items()}
    for side in ("bottom", "left", "right"):
        curves[side] = replace(curves[side], springs=random.uniform(100.0, 500.0, 6))
    return curves


@pytest.mark.parametrize("curves", [QUARTER, sprung_quarter()], ids=["plain", "springs"])
def test_gradient_and_hessian_are_those_of_the_parameters(curves):
    start = uneven_quarter(6)
    problem = make_problem(start, "winslow", slide=curves)
    place = start.planes.copy()
    problem.retract(place)
    random = np.random.default_rng(3)
    way = problem.pin(random.normal(size=place.shape))

    def gradient_at(step):
        moved = make_problem(start, "winslow", slide=curves)
        there = place + step * way
        moved.retract(place.copy())
        moved.retract(there)
        energy, _, gradient = moved.energy_gradient(there)
        return energy, gradient

    _, _, gradient = problem.energy_gradient(place)
    h = 3e-5
    (ahead, slope_ahead), (behind, slope_behind) = gradient_at(h), gradient_at(-h)
    assert (ahead - behind) / (2 * h) == pytest.approx(float((gradient * way).sum()), rel=1e-5)
    from gridgen_sym.solvers.linear.sparse import assemble_hessian, to_vector

    mask = problem.slide.mask(problem.fixed)
    matrix, vector = assemble_hessian(problem.hessian(place), mask), to_vector(way, mask)
    bend = (ahead - 2 * problem.energy(place)[0] + behind) / h**2
    assert float(vector @ (matrix @ vector)) == pytest.approx(bend, rel=1e-3)
    assert not np.allclose(slope_ahead, slope_behind)


def test_stiff_springs_make_weight_times_length_equal():
    start = gg.domain("square", 9, 9)
    weights = np.linspace(1.0, 3.0, 8)
    curves = {
        side: replace(SlideCurve.of_points(start.xy[nodes]), springs=1e6 * weights)
        for side, nodes in (("bottom", np.s_[:, 0]), ("left", np.s_[0]))
    }
    found = gg.optimize(start, "winslow", slide=curves, tolerance=1e-10).grid.xy
    for line in (found[:, 0], found[0]):
        pulls = weights * np.hypot(*np.diff(line, axis=0).T)
        np.testing.assert_allclose(pulls, pulls.mean(), rtol=1e-4)


def test_nodes_stay_on_their_curves_and_corners_stay():
    start = uneven_quarter(12)
    result = gg.optimize(start, "winslow", slide=QUARTER)
    np.testing.assert_allclose(np.hypot(result.grid.x[:, 0], result.grid.y[:, 0]), 1, atol=1e-13)
    np.testing.assert_allclose(result.grid.x[0], 0, atol=1e-15)
    for corner in ((0, 0), (0, -1), (-1, 0), (-1, -1)):
        np.testing.assert_array_equal(result.grid.xy[corner], start.xy[corner])


def test_no_node_passes_its_neighbor_or_a_corner():
    """Whatever a step asks for: random parameters, and a side with a sharp turn whose node stays."""
    turn = np.array([[0.0, 0], [1, 0], [2, 0], [2, 1], [2, 2], [2, 3]])
    curve, random = SlideCurve.of_points(turn), np.random.default_rng(5)
    side = SlidingSide("bottom", side_index("bottom", (6, 4)), curve, chord_fractions(turn))
    np.testing.assert_array_equal(side.free, [False, True, False, True, True, False])
    for _ in range(200):
        wanted = side.at + random.normal(scale=1.0, size=6)
        found = side.in_order(wanted)
        assert (np.diff(found) >= 0.0999 * np.diff(side.at)).all()
        np.testing.assert_allclose(found[~side.free], side.at[~side.free], rtol=1e-14)
    near = side.at + 1e-3 * side.free
    np.testing.assert_allclose(side.in_order(near), near, rtol=1e-14)


def test_nodes_slide_on_coarse_grids_so_that_the_finest_takes_few_steps():
    start = gg.domain("quarter_annulus", 65, 65)
    shapes = [step.shape for step in gg.optimize(start, "winslow", slide="all").history]
    assert shapes.count((65, 65)) <= 3


def test_coarse_grids_that_cut_off_a_bend_lead_nowhere():
    """On 17 x 17 nodes an edge of the swan's top spans its bay: the finer grids would keep that."""
    result = gg.optimize(gg.domain("swan", 33, 33), "winslow", slide="all")
    assert result.converged
    assert "cut off" not in result.message


def test_a_subdomain_slides_where_it_reaches_a_sliding_side():
    start = uneven_quarter(12)
    problem = make_problem(start, "winslow", slide={side: QUARTER[side] for side in ("bottom", "left")})
    window = slice(0, 6), slice(0, 5)
    part, coordinates = restrict(problem, start.planes, window)
    np.testing.assert_array_equal(coordinates, start.planes[:, *window])
    bottom, left = part.slide.sides
    assert (bottom.name, left.name) == ("bottom", "left")
    np.testing.assert_allclose(bottom.curve.point(bottom.at), start.xy[:6, 0], atol=1e-12)
    np.testing.assert_allclose(left.curve.point(left.at), start.xy[0, :5], atol=1e-12)
    np.testing.assert_array_equal(bottom.free, [False, True, True, True, True, False])
    assert restrict(problem, start.planes, (slice(3, 9), slice(2, 13)))[0].slide is None


def test_nodes_that_are_relaxed_together_have_no_cell_in_common():
    slide = make_problem(uneven_quarter(6), "winslow", slide=QUARTER).slide
    masks = list(slide.colors())
    np.testing.assert_array_equal(np.sum(masks, axis=0), 1)
    for mask in masks:
        i, j = (index[mask] for index in slide.nodes)
        apart = np.maximum(np.abs(i[:, None] - i), np.abs(j[:, None] - j)) + 9 * np.eye(len(i))
        assert apart.min() > 1


def test_a_finer_side_takes_the_spacing_of_a_coarser_one():
    line = np.stack([np.linspace(0, 1, 33), np.zeros(33)], -1)
    curve = SlideCurve.of_points(line)
    fine, coarse = (SlidingSide("top", side_index("top", (n, 3)), curve, np.linspace(0, 1, n)) for n in (33, 17))
    coarse.at = coarse.at**2
    np.testing.assert_allclose(finer_parameters(fine, coarse), fine.at**2, atol=1e-12)


@pytest.mark.parametrize("exponent", [0.3, 0.5, 1.0, 1.5])
def test_corners_of_a_finer_grid_follow_powers_of_the_index(exponent):
    """Interpolated by polynomials, parameters beside the end are wrong by 5 to 70 % where the power is not 1."""
    line = np.stack([np.linspace(0, 1, 33), np.zeros(33)], -1)
    curve = SlideCurve.of_points(line)
    fine, coarse = (SlidingSide("top", side_index("top", (n, 3)), curve, np.linspace(0, 1, n)) for n in (33, 17))
    for flip in (False, True):
        for side in (coarse, fine):
            power = np.linspace(0, 1, len(side.at)) ** exponent
            side.at = 1 - power[::-1] if flip else power
        np.testing.assert_allclose(np.diff(finer_parameters(fine, coarse)), np.diff(fine.at), rtol=0.02)
    u, v = np.meshgrid(np.linspace(0, 1, 33), np.linspace(0, 1, 33), indexing="ij")
    power = (u + 1j * v) ** exponent
    exact, start = np.stack([power.real, power.imag]), np.zeros((2, 33, 33))
    shrink_corners(start, np.ascontiguousarray(exact[:, ::2, ::2]))
    np.testing.assert_allclose(start[:, :4, :4], exact[:, :4, :4] if exponent != 1 else 0, atol=1e-12)
    np.testing.assert_array_equal(start[:, 4:], 0)


@pytest.mark.parametrize("name", ["swan", "wavy"])
def test_a_finer_grid_starts_near_its_solution_where_nodes_crowd(name):
    """Displacements from the transfinite grid of such a boundary had gradients a hundred times larger than these."""
    steps = [step for step in gg.optimize(gg.domain(name, 65, 65), "winslow", slide="all").history]
    assert len(steps) <= 5
    assert steps[0].gradient_norm < 2.0


def test_a_step_along_a_curve_is_as_long_as_it_was_along_the_tangent():
    """To the second order, however the parameter runs along the curve."""
    curve = slide_curve(lambda t: np.stack([np.cos(t + t * t), np.sin(t + t * t)], -1))
    slide = Slide([SlidingSide("bottom", side_index("bottom", (9, 3)), curve, np.linspace(0, 1, 9))], (9, 3))
    start = np.zeros((2, 9, 3))
    slide.place(start)
    (side,), at = slide.sides, slide.sides[0].at[1:-1]
    for step in (1e-2, 5e-3):
        _, ((found, _),) = slide.moved(start, np.full(len(at), step))
        assert np.abs(found + found**2 - (side.at + side.at**2) - step)[1:-1].max() < step**3


def test_curves_that_are_evaluated_at_once_are_those_of_their_sides():
    start = gg.domain("chevron", 17, 13)
    slide = make_problem(start, "winslow", slide="all").slide
    _, places = slide.moved(start.planes.copy(), np.random.default_rng(1).normal(scale=0.02, size=len(slide.points[0])))
    for side, (at, derivatives) in zip(slide.sides, places, strict=True):
        np.testing.assert_array_equal(derivatives, side.curve.derivatives(at[side.free]))


def test_a_side_that_runs_against_its_curve_slides_as_well():
    back = {side: (lambda t, of=of: of(1 - t)) for side, of in QUARTER.items()}
    forth, found = (gg.optimize(uneven_quarter(8), "winslow", slide=curves) for curves in (QUARTER, back))
    np.testing.assert_allclose(found.grid.xy, forth.grid.xy, atol=1e-9)


def test_one_side_slides_and_the_others_stay():
    start = gg.domain("quarter_annulus", 17, 13)
    result = gg.optimize(start, "winslow", slide="left")
    np.testing.assert_array_equal(result.grid.xy[1:, [0, -1]], start.xy[1:, [0, -1]])
    assert np.abs(result.grid.xy[0, 1:-1] - start.xy[0, 1:-1]).max() > 1e-3
    assert result.energy < gg.optimize(start, "winslow").energy


def test_sharp_turns_of_a_side_stay():
    start = gg.domain("chevron", 17, 13)
    result = gg.optimize(start, "winslow", slide="all")
    assert result.converged
    np.testing.assert_allclose(result.grid.xy[8, 0], start.xy[8, 0])


def test_walls_and_sliding_sides_go_together():
    start = gg.domain("quarter_annulus", 33, 25)
    result = gg.optimize(start, "winslow", walls={"bottom": gg.Wall(1e-3)}, slide=("left", "right"))
    side = result.quality.sides["bottom"]
    assert side.non_orthogonality.percentile_95 < 0.6
    assert side.first_heights[1] == pytest.approx(1e-3, rel=1e-2)
    assert "Boundary nodes stay" not in result.message


@pytest.mark.parametrize(
    ("domain", "walls", "wrong"),
    [("square", SIDES_ALL, 1e-3), ("quarter_annulus", ("bottom", "top"), 1e-2), ("quarter_annulus", SIDES_ALL, 0.25)],
)
def test_where_all_sides_slide_walls_have_their_heights_up_to_the_corners(domain, walls, wrong):
    """Heights that were corrected for boundary nodes that stay were too small by a factor of up to 1.9."""
    start = gg.domain(domain, 17, 17)
    result = gg.optimize(start, "winslow", walls={side: gg.Wall(first=2e-3) for side in walls}, slide="all")
    assert result.converged
    for side in walls:
        np.testing.assert_allclose(result.quality.sides[side].first_heights, 2e-3, rtol=wrong)


def test_a_valid_grid_is_not_worsened_and_other_functionals_slide_too():
    start = gg.domain("swan", 21, 21)
    for name in ("winslow", "modified_liao", "area_winslow"):
        fixed = gg.optimize(start, name)
        result = gg.optimize(start, name, slide="all")
        assert result.quality.valid
        assert result.energy <= fixed.energy * (1 + 1e-9)


@pytest.mark.parametrize("form", ["points", "spline", "function"])
def test_every_form_of_a_curve_has_its_derivatives(form):
    t = np.linspace(0, 1, 41)
    function = QUARTER["bottom"]
    given = {"points": function(t), "spline": CubicSpline(3 * t, function(t)), "function": function}[form]
    curve = slide_curve(given)
    at, h = np.linspace(0.1, 0.9, 7), 1e-4
    exact = form == "function"
    np.testing.assert_allclose(np.hypot(*curve.point(at).T), 1, atol=1e-12 if exact else 1e-5)
    np.testing.assert_allclose(curve.first(at), (curve.point(at + h) - curve.point(at - h)) / (2 * h), atol=1e-5)
    np.testing.assert_allclose(curve.second(at), (curve.first(at + h) - curve.first(at - h)) / (2 * h), atol=1e-3)
    np.testing.assert_allclose(curve.nearest(1.1 * curve.point(at)), at, atol=1e-12 if exact else 2e-3)


def test_points_have_corners_at_sharp_turns():
    curve = SlideCurve.of_points([[0, 0], [1, 0], [2, 0], [2, 1], [2, 2]])
    np.testing.assert_allclose(curve.corners, [0, 0.5, 1])


def test_points_of_a_curve_are_found_where_its_arms_are_close():
    """Both at the vertices and between them: the nearest sample may be on another arm."""
    random = np.random.default_rng(0)
    for _ in range(20):
        along = np.cumsum(random.uniform(0.5, 1.5, 30))
        spikes = np.where(np.arange(30) % 5 == 2, random.uniform(5, 10, 30), random.uniform(0, 0.3, 30))
        curve = SlideCurve.of_points(np.stack([along / 20, spikes], -1))
        at = np.sort(np.concatenate([curve.corners, random.uniform(0, 1, 200)]))
        np.testing.assert_allclose(curve.nearest(curve.point(at)), at, atol=1e-9)


@pytest.mark.parametrize(
    ("slide", "match"),
    [
        ("below", "unknown side 'below' in slide: the sides are bottom, right, top, left, or 'all'"),
        (3, "slide must be 'all', sides, or a mapping from sides to curves; came 3"),
        ({"bottom": [[0, 0], [5, 0]]}, "the curve of the side bottom must begin and end at the corners"),
        ({"left": 3}, "the curve of a side must be points"),
        ({"left": [[0, 0]]}, "at least two different points"),
        ({"left": lambda t: t}, r"must return points of shape \(9, 2\)"),
        ({"left": [[0, 1], [0, 1.5], [0, 1.5], [0, 2]]}, r"points 1 and 2 are \[0.0, 1.5\] and \[0.0, 1.5\]"),
        ({"left": [[0, 1], [0, np.nan], [0, 2]]}, "must be finite, and each different"),
        ({"left": lambda t: np.full((len(t), 2), np.nan)}, "must be finite for all t from 0 to 1"),
        ([["left"]], r"unknown side \['left'\] in slide"),
        ({"left": [[0, 1], [-1, 1.5], [0, 2]]}, "the nodes of the side left must lie on its curve"),
    ],
)
def test_what_cannot_slide_is_refused(slide, match):
    with pytest.raises(gg.GridgenError, match=match):
        gg.optimize(uneven_quarter(8), "winslow", slide=slide)


def test_nodes_that_do_not_follow_each_other_along_their_curve_are_refused():
    xy = uneven_quarter(8).xy
    xy[0, 3], xy[0, 4] = xy[0, 4].copy(), xy[0, 3].copy()
    with pytest.raises(gg.GridgenError, match="must follow each other along its curve; nodes 3 and 4 are at"):
        gg.untangle(gg.Grid(xy), slide={"left": QUARTER["left"]})


@pytest.mark.slow
@pytest.mark.parametrize(("slide", "better"), [(None, 0.3), ("all", 1.0)])
def test_near_orthogonal_grids_of_the_swan(slide, better):
    start = gg.domain("swan", 31, 31)
    winslow, found = (gg.optimize(start, name, slide=slide) for name in ("winslow", "near_orthogonal"))
    assert found.converged
    assert found.quality.valid
    assert found.quality.non_orthogonality.mean < better * winslow.quality.non_orthogonality.mean


def test_edges_that_cut_off_a_bend_are_told():
    """A circle around which few nodes slide: energy falls where an edge spans the hole of the annulus."""
    start = gg.domain("annulus", 33, 9)
    result = gg.optimize(start, "winslow", slide="bottom", max_iterations=60)
    assert "Edges at bottom cut off bends of the curve" in result.message
    assert "cut off" not in gg.optimize(start, "winslow", slide=("left", "right")).message
    assert "cut off" not in gg.optimize(uneven_quarter(8), "winslow", slide="all").message
