"""The Euler–Lagrange equations on several blocks: the grids are those of one block, and of any other cut."""

from __future__ import annotations

import numpy as np
import pytest
from layouts import assembled, butterfly, cut, ring

import gridgen_sym as gg
from gridgen_sym.solvers.equations.blocks import system as equations
from gridgen_sym.solvers.equations.blocks.euler_lagrange import solve_layout_euler_lagrange
from gridgen_sym.solvers.equations.blocks.system import LayoutEquations
from gridgen_sym.solvers.layout.binding import make_layout_problem

SIZE, LINES = (13, 17), ((0, 2, 5, 12), (0, 2, 5, 9, 12, 16))


def quarter(grid, quarters):
    """The same nodes, whose directions are turned."""
    planes = grid.planes
    for _ in range(quarters):
        planes = planes.transpose(0, 2, 1)[:, ::-1]
    return gg.Grid.from_planes(*planes)


def turned(layout):
    """A layout whose blocks have their directions turned, each otherwise."""
    blocks = zip(layout.names, layout.blocks, strict=True)
    return gg.MultiBlock({name: quarter(block, k % 4) for k, (name, block) in enumerate(blocks)})


def turned_back(layout):
    blocks = zip(layout.names, layout.blocks, strict=True)
    return gg.MultiBlock({name: quarter(block, -k % 4) for k, (name, block) in enumerate(blocks)})


def reference():
    """A valid grid whose cells are of other lengths."""
    xi, eta = np.meshgrid(np.linspace(0, 1, SIZE[0]), np.linspace(0, 1, SIZE[1]), indexing="ij")
    return gg.Grid.from_planes(xi + 0.2 * xi * (1 - xi), eta + 0.3 * eta**2 + 0.1 * xi)


CASES = {
    "winslow": ("winslow", {}),
    "frozen": ("area_winslow", {"weight": "1 + 0.3*x**2"}),
    "differentiated": ("area_winslow", {"weight": gg.Weight("1 + x**2", "differentiated")}),
    "target": ("winslow", {"target": reference()}),
    "lengths": ("winslow", {"target": gg.Target.of(reference(), angle=80)}),
}


def of_blocks(target, change):
    """What a target asks for, block by block."""
    if isinstance(target, gg.Grid):
        return change(cut(target, *LINES))
    # The angle between edges along xi and eta is another one where they are turned by a quarter.
    blocks, turns = cut(reference(), *LINES), change is turned
    return {
        name: gg.Target.of(quarter(block, k % 4 * turns), angle=100 if turns and k % 2 else 80)
        for k, (name, block) in enumerate(zip(blocks.names, blocks.blocks, strict=True))
    }


@pytest.mark.parametrize(
    "name", [pytest.param(one, marks=[pytest.mark.slow] * (one in ("frozen", "lengths"))) for one in CASES]
)
def test_a_solution_is_the_same_however_the_grid_is_cut(name):
    """Also where the blocks' directions are turned against each other."""
    functional, given = CASES[name]
    start = gg.domain("chevron" if "target" in given else "wavy", *SIZE)
    expected = gg.solve_euler_lagrange(start, functional, tolerance=1e-12, **given)
    assert expected.converged, expected.message
    for change, back in ((lambda same: same, lambda same: same), (turned, turned_back)):
        parts = {key: of_blocks(one, change) if key == "target" else one for key, one in given.items()}
        layout = change(cut(start, *LINES))
        found = solve_layout_euler_lagrange(layout, functional, tolerance=1e-12, **parts)
        assert found.converged, found.message
        difference = assembled(back(found.grid), *LINES) - expected.grid.planes
        assert np.abs(difference).max() < 1e-10 * np.ptp(expected.grid.planes)
        assert "stationary" not in found.message


@pytest.mark.parametrize("method", ["newton", "relaxation"])
def test_blocks_that_make_up_a_plain_grid_are_solved_as_one(method):
    start = gg.domain("wavy", *SIZE)
    expected = gg.solve_euler_lagrange(start, "winslow", method)
    found = gg.solve_euler_lagrange(cut(start, *LINES), "winslow", method)
    assert found.message == expected.message
    assert np.array_equal(assembled(found.grid, *LINES), expected.grid.planes)


def test_one_block_may_lie_beside_two():
    """Where two blocks meet in the middle of a third one's side, too; the target has values at corners."""

    def cut_in_three(grid):
        parts = {"low": np.s_[:, :7], "left": np.s_[:5, 6:], "right": np.s_[4:, 6:]}
        return gg.MultiBlock({name: gg.Grid.from_planes(*grid.planes[:, *part]) for name, part in parts.items()})

    start = gg.domain("chevron", *SIZE)
    expected = gg.solve_euler_lagrange(start, "winslow", tolerance=1e-12, target=reference()).grid
    found = gg.solve_euler_lagrange(
        cut_in_three(start), "winslow", tolerance=1e-12, target=cut_in_three(reference())
    ).grid
    for one, other in zip(found.blocks, cut_in_three(expected).blocks, strict=True):
        assert one.planes == pytest.approx(other.planes, abs=1e-10)


LAYOUTS = {
    "pipe": lambda: gg.layout("pipe", across=4),
    "hole": lambda: gg.layout("square_with_hole", around=8, outwards=3),
    "sector": lambda: gg.layout("sector", around=4, outwards=6),
    "cascade": lambda: gg.layout("cascade", along=8, before=4, behind=4, across=6),
    "turned": lambda: turned(cut(gg.domain("wavy", 9, 9), (0, 4, 8), (0, 4, 8))),
}


@pytest.mark.parametrize("name", LAYOUTS)
@pytest.mark.parametrize("target", [False, True], ids=["plain", "target"])
def test_the_jacobian_is_the_derivative_of_the_residual(name, target):
    layout = LAYOUTS[name]()
    problem = make_layout_problem(layout, "winslow", target=layout if target else None)
    place = problem.exchange.join([block.planes for block in layout.blocks])
    random = np.random.default_rng(0)
    system = LayoutEquations(problem, place)
    place = place + system.field(random.normal(0, 1e-4, len(system.residual(place))))
    step = random.normal(size=len(system.residual(place)))
    move = 1e-6 * system.field(step)
    difference = (system.residual(place + move) - system.residual(place - move)) / 2e-6
    assert system.matrix(place) @ step == pytest.approx(difference, abs=1e-7 * np.abs(difference).max())


def test_an_o_grid_is_the_same_wherever_its_cut_lies():
    angles = np.linspace(0, 2 * np.pi, 25)
    inner, outer = 1 + 0.3 * np.cos(3 * angles[:-1]), 3 + 0.5 * np.sin(2 * angles[:-1])
    grids = []
    for shift in (0, 7):
        lines = (np.roll(angles[:-1], -shift), np.roll(inner, -shift), np.roll(outer, -shift))
        layout = gg.MultiBlock([ring(*(np.append(one, one[0]) for one in lines), 9)])
        found = gg.solve_euler_lagrange(layout, "winslow", tolerance=1e-12)
        assert found.converged
        grids.append(np.roll(found.grid.blocks[0].planes[:, :-1], shift, axis=1))
    assert grids[0] == pytest.approx(grids[1], abs=1e-11)


@pytest.mark.parametrize("target", [False, True], ids=["plain", "target"])
def test_a_sector_is_the_part_of_an_annulus_that_it_says(target):
    """Periodic up to a rotation: three sectors of 120 degrees round the same wavy ring."""
    angles = np.linspace(0, 2 * np.pi, 25)

    def of_sector(whole):
        part = gg.Grid.from_planes(*whole.planes[:, :9])
        return gg.MultiBlock([part], [gg.Connection((0, "left"), (0, "right"), rotation=-120)])

    whole = ring(angles, 1 + 0.2 * np.cos(3 * angles), 3.0, 9)
    twisted = ring(angles + 0.05 * np.sin(3 * angles), 1.0, 3 + 0.3 * np.sin(3 * angles), 9) if target else None
    wanted = (gg.MultiBlock([twisted]), of_sector(twisted)) if twisted else (None, None)
    expected = gg.solve_euler_lagrange(gg.MultiBlock([whole]), "winslow", tolerance=1e-12, target=wanted[0])
    found = gg.solve_euler_lagrange(of_sector(whole), "winslow", tolerance=1e-12, target=wanted[1])
    assert found.converged
    assert found.grid.blocks[0].planes == pytest.approx(expected.grid.blocks[0].planes[:, :9], abs=1e-10)


@pytest.mark.parametrize("target", [None, butterfly(8, 6)], ids=["plain", "target"])
def test_a_pipe_is_symmetric_and_its_singular_nodes_have_least_energy(target):
    """Five blocks, three of which meet at the corners of the core: there the gradient of the energy vanishes."""
    found = gg.solve_euler_lagrange(butterfly(8, 6), "winslow", tolerance=1e-12, target=target)
    assert found.converged
    assert found.quality.valid
    assert "4 connected nodes have no logical coordinates" in found.message
    core, south, east = found.grid["core"].planes, found.grid["south"].planes, found.grid["east"].planes
    assert core == pytest.approx(core[::-1].transpose(0, 2, 1), abs=1e-11)
    assert np.stack((-south[1], south[0])) == pytest.approx(east, abs=1e-11)
    gradient = gg.gradient(found.grid, "winslow", target=target)["core"]
    assert np.abs(gradient[0, 0]).max() < 1e-9
    assert np.abs(gradient[1:-1, 1:-1]).max() > 1e-4  # Elsewhere it is a discretization error.


@pytest.mark.slow
def test_a_density_with_names_of_one_block_has_no_stencils_across_connections():
    own = gg.Functional("own_xi", "(1 + xi)*(g11 + g22)/J")
    problem = make_layout_problem(cut(gg.domain("square", 9, 9), (0, 4, 8), (0, 8)), own, backend="numpy")
    place = problem.exchange.join([np.zeros(2 * block.fixed.size) for block in problem.blocks])
    with np.errstate(all="ignore"):
        assert LayoutEquations(problem, place).others == 7


@pytest.mark.parametrize("name", [pytest.param("pipe", marks=pytest.mark.slow), "cascade", "sector"])
def test_relaxation_gives_the_same(name):
    layout = LAYOUTS[name]()
    expected = gg.solve_euler_lagrange(layout, "winslow", tolerance=1e-11)
    found = gg.solve_euler_lagrange(layout, "winslow", "relaxation", tolerance=1e-9)
    assert found.converged
    assert "relaxation factor" in found.message
    for one, other in zip(found.grid.blocks, expected.grid.blocks, strict=True):
        assert one.planes == pytest.approx(other.planes, abs=1e-8)


def test_many_nodes_are_solved_by_gmres(monkeypatch):
    expected = gg.solve_euler_lagrange(gg.layout("pipe", across=8), "winslow", tolerance=1e-12)
    monkeypatch.setattr(equations, "_FEW", 0)
    monkeypatch.setattr(equations, "factorize", None)
    found = gg.solve_euler_lagrange(gg.layout("pipe", across=8), "winslow", tolerance=1e-12)
    assert found.converged
    for one, other in zip(found.grid.blocks, expected.grid.blocks, strict=True):
        assert one.planes == pytest.approx(other.planes, abs=1e-9)


@pytest.mark.slow
def test_walls_are_a_target():
    layout = gg.layout("pipe", across=8)
    found = gg.solve_euler_lagrange(layout, "winslow", walls={"wall": gg.Wall(first=0.01)})
    assert found.converged, found.message
    assert found.quality.valid


@pytest.mark.slow
def test_a_folded_start_is_untangled():
    start = cut(gg.domain("zee", 17, 17), (0, 8, 16), (0, 16))
    found = solve_layout_euler_lagrange(start, "winslow")
    assert found.untangled_by
    assert found.quality.valid


def test_what_is_for_one_block_is_told():
    layout = gg.layout("pipe", across=4)
    with pytest.raises(gg.GridgenError, match="several blocks does not take 'control'"):
        gg.solve_euler_lagrange(layout, "winslow", control=(0, 0))
    with pytest.raises(gg.GridgenError, match="unknown method 'sweep': solve_euler_lagrange takes 'newton' or"):
        gg.solve_euler_lagrange(layout, "winslow", "sweep")
