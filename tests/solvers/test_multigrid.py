"""The multigrid below the Newton methods: Galerkin's operators, any shape, and a cost that does not grow."""

import shutil
import subprocess

import numpy as np
import pytest
from support import NO_SHARED, SHARED

import gridgen_sym as gg
from gridgen_sym.runtime import find_compiler
from gridgen_sym.solvers.binding import make_problem
from gridgen_sym.solvers.linear.multigrid import GeneralMultigrid, Multigrid
from gridgen_sym.solvers.linear.multigrid.library import library_source
from gridgen_sym.solvers.linear.sparse import assemble_hessian, assemble_jacobian, to_vector
from gridgen_sym.solvers.linear.systems import DirectSolver
from gridgen_sym.solvers.multilevel.nested import coarse_shapes

pytestmark = pytest.mark.skipif(find_compiler() is None, reason="multigrid is compiled")

AIRFOIL = SHARED / "domains" / "outlines" / "naca0012_cblock.csv"
SHAPES = [(9, 12), (8, 9), (5, 6), (4, 17), (33, 5)]
HESSIAN_NEIGHBORS = (((1, 0), 3), ((0, 1), 7), ((1, 1), 11), ((1, -1), 15))


def hessian(shape, *, inner_fixed=False):
    """Planes and mask of a Hessian on a grid of a shape."""
    fixed = np.zeros(shape, dtype=bool)
    fixed[2, 2] = inner_fixed
    problem = make_problem(gg.domain("wavy", *shape), "winslow", fixed=fixed)
    # The semidefinite one: far from a minimum, as on stretched grids, the full Hessian need not be positive.
    return problem.hessian(gg.domain("wavy", *shape).planes.copy(), semidefinite=True), problem.fixed


def jacobian(shape):
    problem = make_problem(gg.domain("wavy", *shape), "winslow")
    return problem.kernels.euler_lagrange_jacobian(gg.domain("wavy", *shape).planes.copy()), problem.fixed


def interpolation(count, coarse_count):
    """Bilinear interpolation along one direction, as a matrix from the coarse nodes to all."""
    if count == coarse_count:
        return np.eye(count)
    coarse = [*range(0, count - 1, 2), count - 1]
    matrix = np.zeros((count, len(coarse)))
    matrix[coarse, range(len(coarse))] = 1
    for node in set(range(count)) - set(coarse):
        matrix[node, [node // 2, node // 2 + 1]] = 0.5
    return matrix


def stencil(level):
    """The planes (count, ni, nj) that a level keeps row by row."""
    return np.moveaxis(level.operator, 1, 0)[:, :, : level.fixed.shape[1]].astype(float)


def dense(planes):
    """The matrix of a stencil over all nodes."""
    count, ni, nj = planes.shape
    matrix = np.zeros((ni, nj, 2, ni, nj, 2))
    for i, j in np.ndindex(ni, nj):
        if count == 36:
            for neighbor in range(9):
                to = i + neighbor // 3 - 1, j + neighbor % 3 - 1
                if 0 <= to[0] < ni and 0 <= to[1] < nj:
                    matrix[i, j, :, *to, :] = planes[4 * neighbor : 4 * neighbor + 4, i, j].reshape(2, 2)
        else:
            xx, xy, yy = planes[:3, i, j]
            matrix[i, j, :, i, j, :] = [[xx, xy], [xy, yy]]
            for (di, dj), first in HESSIAN_NEIGHBORS:
                to = i + di, j + dj
                if to[0] < ni and 0 <= to[1] < nj:
                    block = planes[first : first + 4, i, j].reshape(2, 2)
                    matrix[i, j, :, *to, :], matrix[*to, :, i, j, :] = block, block.T
    return matrix.reshape(2 * ni * nj, 2 * ni * nj)


@pytest.mark.parametrize("shape", SHAPES, ids=str)
@pytest.mark.parametrize("kind", ["hessian", "hessian with a fixed node", "jacobian"])
def test_coarse_operators_are_galerkins(shape, kind):
    if kind == "jacobian":
        planes, fixed = jacobian(shape)
        multigrid = GeneralMultigrid(fixed)
    else:
        planes, fixed = hessian(shape, inner_fixed=kind != "hessian" and min(shape) > 4)
        multigrid = Multigrid(fixed)
    assert multigrid.set_operator(planes)
    levels = multigrid.arrays[:2]
    fine, coarse = (dense(stencil(level)) for level in levels)
    along_xi, along_eta = (
        interpolation(*counts) for counts in zip(*(level.fixed.shape for level in levels), strict=True)
    )
    prolongation = np.kron(np.kron(along_xi, along_eta), np.eye(2))
    expected = prolongation.T @ fine @ prolongation
    free = np.repeat(levels[1].fixed.ravel() == 0, 2)
    between = np.ix_(free, free)
    np.testing.assert_allclose(coarse[between], expected[between], atol=2e-6 * np.abs(expected).max())


@pytest.mark.parametrize("shape", [*SHAPES, (7, 200), (64, 65)], ids=str)
def test_conjugate_gradients_solve_with_the_hessian(shape):
    planes, fixed = hessian(shape)
    multigrid = Multigrid(fixed)
    assert multigrid.set_operator(planes)
    # The operator is kept in single precision, and that one is solved with.
    kept = stencil(multigrid.arrays[0]) * multigrid.size
    difference = (assemble_hessian(kept, fixed) - assemble_hessian(planes, fixed)).data
    assert np.abs(difference).max() <= 1e-6 * np.abs(planes).max()
    matrix = assemble_hessian(kept, fixed)
    right = np.random.default_rng(0).normal(size=(2, *shape)) * (fixed == 0)
    solution = multigrid.solve(right, 1e-10)
    assert solution.positive
    residual = matrix @ to_vector(solution.vector, fixed) - to_vector(right, fixed)
    assert np.linalg.norm(residual) <= 1e-9 * np.linalg.norm(right)


def free_boundary(shape, sides):
    """A mask in which sides, without their corners, have unknowns, too."""
    fixed = np.ones(shape, dtype=np.uint8)
    fixed[1:-1, 1:-1] = 0
    inner = {"left": np.s_[0, 1:-1], "right": np.s_[-1, 1:-1], "bottom": np.s_[1:-1, 0], "top": np.s_[1:-1, -1]}
    for side in sides:
        fixed[inner[side]] = 0
    return fixed


@pytest.mark.parametrize("sides", [("left",), ("top",), ("right", "bottom"), ("left", "right", "bottom", "top")])
@pytest.mark.parametrize("shape", [(9, 12), (33, 64), (64, 65), (5, 30)], ids=str)
def test_sides_may_have_unknowns(shape, sides):
    planes, _ = hessian(shape)
    fixed = free_boundary(shape, sides)
    planes[0] += 1e-3 * planes[0].mean()
    planes[2] += 1e-3 * planes[2].mean()
    multigrid = Multigrid(fixed)
    assert multigrid.set_operator(planes.copy())
    right = np.random.default_rng(0).normal(size=(2, *shape)) * (fixed == 0)
    solution = multigrid.solve(right, 1e-6)
    assert solution.positive
    assert solution.iterations <= 10
    matrix = assemble_hessian(planes, fixed)
    residual = matrix @ to_vector(solution.vector, fixed) - to_vector(right, fixed)
    assert np.linalg.norm(residual) <= 1e-4 * np.linalg.norm(right)
    assert not solution.vector[:, fixed != 0].any()


def test_nodes_that_slide_cost_no_more_iterations_on_finer_grids():
    counts = []
    for n in (33, 66, 131):
        start = gg.domain("wavy", n, n)
        problem = make_problem(start, "winslow", slide=("bottom", "right", "top"))
        planes, fixed = problem.hessian(start.planes.copy(), semidefinite=True), problem.slide.mask(problem.fixed)
        multigrid = Multigrid(fixed)
        assert multigrid.set_operator(planes)
        right = np.random.default_rng(0).normal(size=(2, n, n)) * (fixed == 0)
        counts.append(multigrid.solve(right, 1e-6).iterations)
    assert max(counts) <= min(counts) + 3


@pytest.mark.parametrize("shape", [(9, 12), (7, 200), (64, 65)], ids=str)
def test_bicgstab_solves_with_the_jacobian(shape):
    planes, fixed = jacobian(shape)
    multigrid = GeneralMultigrid(fixed)
    assert multigrid.set_operator(planes)
    matrix = assemble_jacobian(stencil(multigrid.arrays[0]) * multigrid.size, fixed)
    right = np.random.default_rng(0).normal(size=(2, *shape)) * (fixed == 0)
    solution = multigrid.solve(right, 1e-8)
    residual = matrix @ to_vector(solution.vector, fixed) - to_vector(right, fixed)
    assert np.linalg.norm(residual) <= 1e-7 * np.linalg.norm(right)


@pytest.mark.parametrize(
    ("make", "planes_of"), [(Multigrid, hessian), (GeneralMultigrid, jacobian)], ids=["hessian", "jacobian"]
)
def test_any_number_of_threads_gives_the_same_bits(make, planes_of, monkeypatch):
    shape = (140, 181)
    planes, fixed = planes_of(shape)
    right = np.random.default_rng(0).normal(size=(2, *shape)) * (fixed == 0)
    solutions = []
    for threads in ("1", "2", "3"):
        monkeypatch.setenv("OMP_NUM_THREADS", threads)
        multigrid = make(fixed)
        assert multigrid.set_operator(planes.copy())
        solutions.append(multigrid.solve(right, 1e-6).vector)
    for solution in solutions[1:]:
        np.testing.assert_array_equal(solution, solutions[0])


def swapped(planes):
    """The planes of a Hessian with the directions xi and eta swapped."""
    xx, xy, yy, *others = planes
    up, along, diagonal, falling = np.reshape(others, (4, 4, *xx.shape))
    # The coupling of (i, j) with (i+1, j-1) is, swapped, that of (j, i) with (j-1, i+1), stored at the latter.
    rising = np.zeros_like(falling)
    rising[:, 1:, :-1] = falling[:, :-1, 1:]
    blocks = np.concatenate([np.stack([xx, xy, yy]), along, up, diagonal, rising[[0, 2, 1, 3]]])
    return np.ascontiguousarray(np.swapaxes(blocks, 1, 2))


def test_sheared_lines_are_solved_in_both_directions():
    """Cells of 1/7 by 1/200, sheared: pivots of the lines are nearly singular, in single precision they fail."""
    planes, fixed = hessian((7, 200))
    right = np.random.default_rng(0).normal(size=(2, 7, 200)) * (fixed == 0)
    along, across = Multigrid(fixed), Multigrid(np.ascontiguousarray(fixed.T))
    turned = swapped(planes)
    assert along.set_operator(planes)
    assert across.set_operator(turned)
    one = along.solve(right, 1e-8)
    two = across.solve(np.ascontiguousarray(np.swapaxes(right, 1, 2)), 1e-8)
    assert max(one.iterations, two.iterations) <= 8
    scale = np.abs(one.vector).max()
    np.testing.assert_allclose(np.swapaxes(two.vector, 1, 2), one.vector, atol=1e-4 * scale)


@pytest.mark.parametrize("make", [Multigrid, lambda fixed: DirectSolver(fixed, assemble_hessian)], ids=["cg", "direct"])
def test_a_saddle_is_told_with_a_direction_away_from_it(make):
    planes, fixed = hessian((9, 12))
    # A little less than the smallest eigenvalue: positive blocks, and one negative eigenvalue.
    values = np.linalg.eigvalsh(assemble_hessian(planes, fixed).toarray())
    planes[[0, 2]] -= 0.5 * (values[0] + values[1])
    matrix, solver = assemble_hessian(planes, fixed), make(fixed)
    assert solver.set_operator(planes)
    right = np.random.default_rng(0).normal(size=(2, 9, 12)) * (fixed == 0)
    answer = solver.solve(right, 1e-10)
    if answer.positive:  # A direct solver looks along its solution only.
        answer = solver.solve(answer.vector.copy(), 1e-10)
    assert not answer.positive
    direction = to_vector(answer.vector, fixed)
    assert direction @ matrix @ direction < 0


def test_a_cycle_that_fails_in_single_precision_is_given_up():
    """Nearly flat cells: the condition is 1e9, and the cycle is not positive for every right-hand side."""
    grid = gg.domain("swan", 5, 9)
    problem = make_problem(grid, "modified_liao")
    solver = Multigrid(problem.fixed)
    assert solver.set_operator(problem.hessian(grid.planes.copy(), semidefinite=True))
    for seed in range(6):
        right = np.random.default_rng(seed).normal(size=(2, 5, 9)) * (problem.fixed == 0)
        answer = solver.solve(right, 1e-6)
        assert not answer.positive
        assert answer.iterations <= 50


def test_what_is_told_positive_is_so():
    """Random stencils with definite blocks, on nodes of sizes from 0.01 to 100: half of the matrices are definite."""
    shape, told = (6, 7), []
    fixed = np.ones(shape, dtype=np.uint8)
    fixed[1:-1, 1:-1] = 0
    for seed in range(60):
        random = np.random.default_rng(seed)
        planes = random.choice((0.1, 0.25, 0.4)) * random.uniform(-1, 1, size=(19, *shape))
        planes[[0, 2]] = 1.0
        least = np.linalg.eigvalsh(assemble_hessian(planes, fixed).toarray())[0]  # Scaling keeps its sign.
        size = 10.0 ** random.uniform(-2, 2, size=shape)
        for (di, dj), first in (((0, 0), 0), *HESSIAN_NEIGHBORS):
            planes[first : first + (4 if first else 3)] *= size * np.roll(size, (-di, -dj), (0, 1))
        right = random.normal(size=(2, *shape)) * (fixed == 0)
        solver = Multigrid(fixed)
        if solver.set_operator(planes) and abs(least) > 1e-2:
            told.append(solver.solve(right, 1e-10).positive)
            assert told[-1] == (least > 0), seed
    assert 10 <= sum(told) <= len(told) - 10


@pytest.mark.parametrize(
    ("make", "block"),
    [
        (Multigrid, [-1.0, 0.5, 1.0]),
        (Multigrid, [-1.0, 0.5, -1.0]),
        # Singular, but for the rounding of 0.49 to single precision.
        (Multigrid, [1.0, 0.7, 0.49]),
        (GeneralMultigrid, [1.0, 0.7, 0.7, 0.49]),
    ],
)
def test_an_operator_with_bad_blocks_is_told(make, block):
    planes, fixed = (hessian if make is Multigrid else jacobian)((4, 4))  # No coarser level would tell.
    assert make(fixed).set_operator(planes.copy())
    first = 0 if make is Multigrid else 16
    planes[first : first + len(block)] = np.reshape(block, (-1, 1, 1))
    assert not make(fixed).set_operator(planes)


def strong_lines(make, shape):
    """A stencil whose blocks are definite, but not all lines of nodes: random, with couplings as strong as blocks."""
    fixed = np.ones(shape, dtype=np.uint8)
    fixed[1:-1, 1:-1] = 0
    fixed[5, 6] = 1
    planes = np.random.default_rng(3).uniform(-0.9, 0.9, size=(19 if make is Multigrid else 36, *shape))
    # At node (2, 2) the pivots are special, along xi and along eta: tiny, or singular.
    if make is Multigrid:
        planes[[0, 2]] = 1.0
        planes[1, 1:3, 1:3] = 0.0
        planes[0, 2, 2] = 1 + 2.0**-21
        planes[3:7, 1, 2] = planes[7:11, 2, 1] = 1.0, 0.0, 0.0, 0.5
    else:
        planes[[16, 19]] = 1.0
        planes[17:19, 1:3, 1:3] = 0.0
        planes[16:20, 2, 2] = 2.0, 1.0, 1.0, 2.0
        planes[28:32, 1, 2] = planes[4:8, 2, 2] = planes[20:24, 2, 1] = planes[12:16, 2, 2] = 1.0, 0.0, 0.0, 1.0
    return planes, fixed


@pytest.mark.parametrize("make", [Multigrid, GeneralMultigrid])
def test_a_block_stands_in_for_a_pivot_that_is_not_definite(make):
    """Else the cycle would not be definite where the Hessian is not, and negative curvature would not be met."""
    planes, fixed = strong_lines(make, (12, 14))
    multigrid = make(fixed)
    multigrid.set_operator(planes)
    level, reasons = multigrid.arrays[0], set()
    matrix = dense(stencil(level)).reshape(12, 14, 2, 12, 14, 2)
    stored = [0, 1, 1, 2] if make is Multigrid else [0, 1, 2, 3]
    for pivots, (di, dj) in ((level.pivots_i, (1, 0)), (level.pivots_j, (0, 1))):
        inverses = np.zeros((12, 14, 2, 2))
        for i, j in np.argwhere(fixed == 0):
            own, last = matrix[i, j, :, i, j], (i - di, j - dj)
            pivot = own - matrix[i, j, :, *last] @ inverses[last] @ matrix[*last, :, i, j]
            determinant, size = np.linalg.det(pivot), np.abs(pivot[0, 0] * pivot[1, 1])
            if make is GeneralMultigrid:
                reason = "singular" if abs(determinant) < 1e-7 * size else ""
            elif (np.diag(pivot) <= 0).any():
                reason = "negative"
            elif determinant <= 0:
                reason = "indefinite"
            else:
                reason = "tiny" if (np.diag(pivot) <= 1e-6 * np.diag(own)).any() else ""
            reasons.add(reason)
            inverses[i, j] = np.linalg.inv(own if reason else pivot)
            found = pivots[i, stored, j].reshape(2, 2)
            np.testing.assert_allclose(
                found, inverses[i, j], rtol=1e-4, atol=1e-4 * np.abs(found).max(), err_msg=reason
            )
    assert reasons == {"", *(("negative", "indefinite", "tiny") if make is Multigrid else ("singular",))}


@pytest.mark.skipif(not AIRFOIL.exists(), reason=NO_SHARED.format("domains/outlines"))
def test_a_saddle_point_is_left():
    """Newton's method comes to a saddle first; without negative curvature it stays there for 400 steps."""
    saddle = 114736.19113
    result = gg.optimize(gg.Outline.read(AIRFOIL).grid(81, 81), "winslow", tolerance=1e-8)
    assert result.converged, result.message
    assert result.iterations <= 60
    assert result.energy < saddle - 0.1


def test_the_number_of_steps_does_not_grow_with_the_grid():
    """4 times the nodes, and hardly a step more, of Newton's method or of conjugate gradients."""
    steps, products = [], []
    for nodes in (33, 65, 129):
        result = gg.optimize(gg.domain("wavy", nodes, nodes), "winslow", tolerance=1e-8)
        assert result.converged
        steps.append(result.iterations)
        problem = make_problem(result.grid, "winslow")
        multigrid = Multigrid(problem.fixed)
        assert multigrid.set_operator(problem.hessian(result.grid.planes.copy()))
        right = np.random.default_rng(0).normal(size=(2, nodes, nodes)) * (problem.fixed == 0)
        products.append(multigrid.solve(right, 1e-6).iterations)
    assert max(steps) <= min(steps) + 1
    assert max(products) <= 8


@pytest.mark.parametrize("shape", [(7, 1000), (150, 9), (50, 77)], ids=str)
@pytest.mark.parametrize("domain", ["horseshoe", "quarter_annulus", "square"])
def test_any_shape_is_solved(domain, shape):
    result = gg.optimize(gg.domain(domain, *shape), "winslow")
    assert result.converged, result.message
    assert result.quality.folded_cells == 0


def test_nested_shapes_end_with_the_grids_own():
    assert coarse_shapes((65, 65)) == [(17, 17), (33, 33), (65, 65)]
    assert coarse_shapes((7, 40))[-1] == (7, 40)
    assert all(shape[0] == 7 for shape in coarse_shapes((7, 40)))


@pytest.mark.parametrize("name", ["winslow", "modified_liao"])
def test_the_equations_are_solved_on_large_grids_too(name):
    result = gg.solve_euler_lagrange(gg.domain("swan", 97, 97), name)
    assert result.converged, result.message
    assert result.iterations <= 10
    assert result.quality.folded_cells == 0


def test_an_interrupt_returns_the_best_grid():
    start = gg.domain("wavy", 33, 33)

    def interrupt(step):
        if step.shape == (33, 33) and step.iteration == 2:
            raise KeyboardInterrupt

    result = gg.optimize(start, "winslow", callback=interrupt)
    assert result.interrupted
    assert not result.converged
    assert result.quality.folded_cells == 0
    assert result.energy < gg.energy(start, "winslow")


@pytest.mark.slow
@pytest.mark.parametrize("stencil", ["symmetric", "general", "blocks", "blocks_in_double"])
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("threads", ["-fopenmp", "-Wno-unknown-pragmas"])
def test_the_sources_compile_without_a_warning_of_either_compiler(stencil, compiler, threads, tmp_path):
    if not shutil.which(compiler):
        pytest.skip(f"there is no {compiler}")
    source = tmp_path / "multigrid.c"
    source.write_text(library_source(stencil))
    # What only an optimizer sees, `test_everything_runs_under_a_compiler_that_is_strict` finds.
    flags = ("-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-fsyntax-only", threads)
    command = [compiler, *flags, str(source)]
    told = subprocess.run(command, capture_output=True, text=True, check=False)
    assert told.returncode == 0, told.stderr
