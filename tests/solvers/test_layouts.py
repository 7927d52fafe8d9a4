"""Several blocks are minimized as one grid: known answers, each to rounding."""

from __future__ import annotations

import itertools
from types import SimpleNamespace

import numpy as np
import pytest
from layouts import assembled, butterfly, cut, kinks, ring
from support import NO_SHARED, SHARED

import gridgen_sym as gg
from gridgen_sym.solvers.layout import optimize as solver
from gridgen_sym.solvers.layout import untangling
from gridgen_sym.solvers.layout.binding import make_layout_problem

SIZE = (13, 17)
CUTS = {
    "1 x 2": ((0, 12), (0, 8, 16)),
    "2 x 2": ((0, 6, 12), (0, 4, 16)),
    "3 x 5": ((0, 2, 5, 12), (0, 2, 5, 9, 12, 16)),
}
RANDOM = np.random.default_rng(3)
CUTS["random"] = tuple(
    (0, *sorted(RANDOM.choice(np.arange(1, count // 2), 2, replace=False) * 2), count - 1) for count in SIZE
)


@pytest.fixture(scope="module")
def own():
    """A user's functional, and a reference grid for a target."""
    reference = gg.optimize(gg.domain("swan", *SIZE), "area_winslow", weight="1 + 3*x**2").grid
    return gg.Functional("own", "g11**2/J**2 + (g22 + g11)/J"), reference


CASES = [
    pytest.param("winslow", {}, id="winslow"),
    pytest.param("modified_liao", {}, id="modified_liao"),
    pytest.param("area_winslow", {"weight": "1 + x**2"}, id="area_winslow"),
    pytest.param("own", {}, id="own", marks=pytest.mark.slow),
    pytest.param("target", {}, id="target"),
]


@pytest.fixture
def apart(monkeypatch):
    """Let solvers not put blocks together."""
    for one in (solver, untangling):
        monkeypatch.setattr(one, "merge", lambda layout: SimpleNamespace(layout=layout))


def test_blocks_that_make_up_a_plain_grid_are_solved_as_that(own):
    """Where nothing is given block by block the cuts cost nothing, and the grid is the same bit by bit."""
    whole, lines = gg.domain("wavy", *SIZE), CUTS["3 x 5"]
    start, reference = cut(whole, *lines), own[1]
    for given, of_blocks in (({}, {}), ({"target": reference}, {"target": cut(reference, *lines)})):
        expected = gg.optimize(whole, "winslow", **given)
        found = gg.optimize(start, "winslow", **of_blocks)
        assert np.array_equal(assembled(found.grid, *lines), expected.grid.planes)
        assert (found.energy, found.iterations, found.message) == (
            expected.energy,
            expected.iterations,
            expected.message,
        )
        assert [grid.shape for grid in found.grid.blocks] == [grid.shape for grid in start.blocks]
    assert gg.untangle(found.grid).grid.names == start.names


def test_blocks_with_nodes_of_their_own_are_put_together(monkeypatch):
    """Where inner nodes are not those of transfinite interpolation, the one merged block starts from them."""
    sizes = []

    def make(on, *given, **named):
        sizes.append(len(on))
        return make_layout_problem(on, *given, **named)

    monkeypatch.setattr(solver, "make_layout_problem", make)
    whole, lines = gg.domain("wavy", 33, 17), ((0, 8, 32), (0, 16))
    bent = np.array(whole.planes)
    bent[0, 1:-1, 1:-1] += 0.004
    found = gg.optimize(cut(gg.Grid.from_planes(*bent), *lines), "winslow", tolerance=1e-10)
    assert set(sizes) == {1}
    expected = gg.optimize(whole, "winslow", tolerance=1e-10).grid.planes
    assert np.abs(assembled(found.grid, *lines) - expected).max() < 1e-9


def test_coarse_grids_help_where_the_start_has_kinks():
    """Bilinear cells of 8 x 8: what has moved has their kinks, too, and is not what is interpolated then."""
    corners = np.stack(np.meshgrid(np.arange(4.0), np.arange(4.0), indexing="ij"))
    corners[:, 1:-1, 1:-1] += np.random.default_rng(0).uniform(-0.45, 0.45, (2, 2, 2))
    weights = np.maximum(0, 1 - np.abs(np.arange(25)[:, None] / 8 - np.arange(4)))
    start = gg.Grid.from_planes(*(weights @ corners @ weights.T))
    found = gg.optimize(gg.MultiBlock([start]), "winslow")
    assert found.converged
    assert found.iterations == 1


def test_folded_blocks_and_the_local_method_are_those_of_a_plain_grid():
    whole, lines = gg.domain("zee", 17, 17), ((0, 2, 8, 16), (0, 16))
    start = cut(whole, *lines)
    for expected, found in (
        (gg.untangle(whole), gg.untangle(start)),
        (gg.optimize(whole, "winslow"), gg.optimize(start, "winslow")),
        (gg.optimize(whole, "winslow", "local"), gg.optimize(start, "winslow", "local")),
    ):
        assert np.array_equal(assembled(found.grid, *lines), expected.grid.planes)
        assert found.grid.names == start.names
        for told in ("converged", "status", "message", "iterations", "energy", "history", "untangled_by"):
            assert getattr(found, told) == getattr(expected, told)


@pytest.mark.usefixtures("apart")
@pytest.mark.parametrize(("name", "given"), CASES)
@pytest.mark.parametrize("lines", CUTS.values(), ids=CUTS)
def test_a_grid_is_the_same_however_it_is_cut(lines, name, given, own):
    functional = {"own": own[0], "target": "winslow"}.get(name, name)
    start = gg.domain("swan" if name == "target" else "wavy", *SIZE)
    whole, parts = dict(given), dict(given)
    if name == "target":
        whole["target"], parts["target"] = own[1], cut(own[1], *lines)
    expected = gg.optimize(start, functional, tolerance=1e-12, **whole)
    found = gg.optimize(cut(start, *lines), functional, tolerance=1e-12, **parts)
    assert found.converged, found.message
    assert found.energy == pytest.approx(expected.energy, rel=1e-12)
    difference = assembled(found.grid, *lines) - expected.grid.planes
    assert np.abs(difference).max() < 1e-10 * np.ptp(expected.grid.planes)


@pytest.mark.parametrize("backend", ["c", "numpy"])
def test_energy_gradient_and_hessian_are_those_of_the_uncut_grid(backend):
    start = gg.optimize(gg.domain("wavy", 9, 9), "winslow", max_iterations=1).grid
    lines = (0, 4, 8), (0, 2, 8)
    layout = cut(start, *lines)
    assert gg.energy(layout, "winslow", backend=backend) == pytest.approx(gg.energy(start, "winslow"), rel=1e-14)
    expected, found = gg.gradient(start, "winslow"), gg.gradient(layout, "winslow", backend=backend)
    joined = assembled(gg.MultiBlock({k: gg.Grid(v) for k, v in found.items()}, []), *lines)
    assert np.moveaxis(joined, 0, -1) == pytest.approx(expected, abs=1e-13)
    values = [np.linalg.eigvalsh(gg.hessian(one, "winslow").toarray()) for one in (start, layout)]
    assert values[0] == pytest.approx(values[1], rel=1e-9)


def test_the_radii_of_an_annulus_are_those_of_winslows_grid():
    found = gg.optimize(gg.MultiBlock([ring(np.linspace(0, 2 * np.pi, 25), 1.0, 3.0, 9)]), "winslow", tolerance=1e-13)
    radii = np.hypot(*found.grid.blocks[0].planes)
    assert radii == pytest.approx(np.broadcast_to(3.0 ** (np.arange(9) / 8), (25, 9)), rel=1e-13)


def test_an_o_grid_is_the_same_wherever_its_cut_lies():
    angles = np.linspace(0, 2 * np.pi, 25)
    inner, outer = 1 + 0.3 * np.cos(3 * angles[:-1]), 3 + 0.5 * np.sin(2 * angles[:-1])
    grids = []
    for shift in (0, 7):
        turned = np.roll(angles[:-1], -shift)
        around = (np.append(one, one[0]) for one in (turned, np.roll(inner, -shift), np.roll(outer, -shift)))
        found = gg.optimize(gg.MultiBlock([ring(*around, 9)]), "winslow", tolerance=1e-12)
        assert found.converged
        grids.append(np.roll(found.grid.blocks[0].planes[:, :-1], shift, axis=1))
    assert grids[0] == pytest.approx(grids[1], abs=1e-11)


def cascade(pitches):
    """A passage between cambered blades, with periodic inlet and outlet; the second pitch lies above the first."""
    x = np.linspace(-1, 2, 25)
    camber = 0.3 * np.sin(np.pi * np.clip(x, 0, 1))
    thick = np.where((x >= 0) & (x <= 1), 0.1 * np.sin(np.pi * np.clip(x, 0, 1)), 0)
    blocks, part = {}, np.linspace(0, 1, 9)
    for pitch in range(pitches):
        low, high = camber + thick + pitch, camber - thick + pitch + 1
        y = low[:, None] * (1 - part) + high[:, None] * part
        blocks[str(pitch)] = gg.Grid.from_planes(np.broadcast_to(x[:, None], y.shape), y)
    bonds = []
    for nodes in ((0, 8), (16, 24)):
        for pitch in range(pitches):
            last = pitch == pitches - 1
            other, shift = ("0", (0, -pitches)) if last else (str(pitch + 1), (0, 0))
            bonds.append(gg.Connection((str(pitch), "top", nodes), (other, "bottom", nodes), translation=shift))
    return gg.MultiBlock(blocks, bonds)


@pytest.mark.usefixtures("apart")
def test_a_cascade_is_the_same_with_one_more_pitch():
    one, two = (gg.optimize(cascade(pitches), "winslow", tolerance=1e-12) for pitches in (1, 2))
    assert one.converged
    assert two.converged
    alone = one.grid.blocks[0].planes
    assert np.abs(alone - cascade(1).blocks[0].planes)[:, 1:-1, 0].max() > 1e-3  # Periodic nodes have moved.
    for pitch, block in enumerate(two.grid.blocks):
        assert block.planes - np.array([0, pitch])[:, None, None] == pytest.approx(alone, abs=1e-10)


def test_a_sector_is_a_part_of_its_annulus():
    sector = ring(np.linspace(0, 2 * np.pi / 6, 5), 1.0, 3.0, 9)
    bent = np.array(sector.planes)
    bent[:, 1:-1, 1:-1] += 0.01 * np.random.default_rng(0).uniform(-1, 1, (2, 3, 7))
    bond = gg.Connection((0, "left"), (0, "right"), rotation=-60)
    found = gg.optimize(gg.MultiBlock([gg.Grid.from_planes(*bent)], [bond]), "winslow", tolerance=1e-13)
    radii = np.hypot(*found.grid.blocks[0].planes)
    assert radii == pytest.approx(np.broadcast_to(3.0 ** (np.arange(9) / 8), (5, 9)), rel=1e-12)


@pytest.mark.usefixtures("apart")
def test_a_pipe_is_as_symmetric_as_its_layout_and_the_best_of_its_neighbors():
    found = gg.optimize(butterfly(8, 6), "winslow", tolerance=1e-13)
    assert found.converged
    assert found.quality.valid
    core, south, east = found.grid["core"].planes, found.grid["south"].planes, found.grid["east"].planes
    assert core[0] == pytest.approx(-core[0, ::-1], abs=1e-11)
    assert core == pytest.approx(core[::-1].transpose(0, 2, 1), abs=1e-11)
    assert np.stack((-south[1], south[0])) == pytest.approx(east, abs=1e-11)
    # It is a minimum: no small move of the free nodes has less energy.
    problem = make_layout_problem(found.grid, "winslow")
    place = problem.exchange.join([block.planes for block in found.grid.blocks])
    random = np.random.default_rng(0)
    for _ in range(20):
        move = problem.exchange.of_first_copies(random.normal(0, 1e-3, place.shape))
        move[problem._held] = 0.0
        assert problem.energy(place + move)[0] > found.energy


def test_lines_cross_the_cut_of_a_c_grid_without_a_kink():
    """The wake's cut begins bent, with kinks of 10 to 20 degrees; as a connection it is as smooth as the rest."""
    wake = np.linspace(3, 1, 9)[:-1]
    wake = wake + 0.2j * (wake - 1)
    inside = np.concatenate((wake, np.exp(-1j * np.linspace(0, 2 * np.pi, 17)), wake[::-1]))
    half = -3j * np.exp(-1j * np.pi * np.linspace(0, 1, 17))
    outside = np.concatenate((np.linspace(3, 0, 9)[:-1] - 3j, half, np.linspace(0, 3, 9)[1:] + 3j))
    part = np.linspace(0, 1, 9)
    nodes = inside[:, None] * (1 - part) + outside[:, None] * part
    layout = gg.MultiBlock([gg.Grid.from_planes(nodes.real, nodes.imag)])
    assert len(layout.bonds) == 1
    found = gg.optimize(layout, "winslow")
    assert found.quality.valid
    assert kinks(layout)[1:4].min() > 9
    assert kinks(found.grid)[1:4].max() < 2


@pytest.mark.skipif(not (SHARED / "nasa").is_dir(), reason=NO_SHARED.format("nasa"))
def test_lines_cross_the_cut_of_a_real_c_grid_without_a_kink():
    """Those of the file have kinks of up to 55 degrees; the target are the lengths of its edges, at right angles."""
    layout = gg.read(SHARED / "nasa" / "n4412_225-65.p2dfmt", layout=True)
    found = gg.optimize(layout, "winslow", target=gg.Target.of(layout.blocks[0], angle=90))
    assert found.converged, found.message
    assert found.quality.valid
    assert kinks(layout).max() > 50
    assert kinks(found.grid).max() < 0.1


@pytest.mark.usefixtures("apart")
def test_a_folded_layout_is_untangled():
    lines = (0, 8, 16), (0, 16)
    start = cut(gg.domain("zee", 17, 17), *lines)
    assert not gg.quality(start).valid
    for found in (gg.untangle(start), gg.optimize(start, "winslow")):
        assert found.converged
        assert found.quality.valid
        assert found.untangled_by
        assert "was folded at the start" in found.message
    valid = gg.optimize(start, "winslow").grid
    again = gg.untangle(valid)
    assert all(np.array_equal(a.planes, b.planes) for a, b in zip(valid.blocks, again.grid.blocks, strict=True))


def test_values_may_be_given_by_block():
    start = cut(gg.domain("square", 9, 9), (0, 4, 8), (0, 8))
    same = gg.optimize(start, "area_winslow", weight={"0-0": "1", "1-0": "1"}, tolerance=1e-10)
    assert same.energy == pytest.approx(gg.optimize(start, "area_winslow", weight="1", tolerance=1e-10).energy)
    other = gg.optimize(start, "area_winslow", weight={"0-0": "1", "1-0": "9"}, tolerance=1e-10)
    assert other.grid["0-0"].x[4, 4] > same.grid["0-0"].x[4, 4] + 0.01
    with pytest.raises(gg.GridgenError, match="values by block need one for each of 0-0, 1-0"):
        gg.optimize(start, "area_winslow", weight={"0-0": "1"})
    with pytest.raises(gg.GridgenError, match="block 1-0: "):
        gg.optimize(start, "area_winslow", weight={"0-0": "1", "1-0": "x +"})


def test_targets_may_be_given_by_block():
    """As grids, in any order, as targets, or as a layout: the same grid, though only grids can be merged."""
    lines = (0, 4, 8), (0, 8)
    start = cut(gg.domain("wavy", 9, 9), *lines)
    wanted = gg.optimize(start, "area_winslow", weight="1 + 3*x**2").grid
    named = dict(zip(wanted.names, wanted.blocks, strict=True))
    backwards = dict(reversed(named.items()))
    targets = {name: gg.Target.of(block) for name, block in named.items()}
    for target in (wanted, named, backwards, targets):
        found = gg.optimize(start, "winslow", target=target)
        assert np.abs(assembled(found.grid, *lines) - assembled(wanted, *lines)).max() < 1e-8
    with pytest.raises(gg.GridgenError, match="values by block need one for each of 0-0, 1-0"):
        gg.optimize(start, "winslow", target={"0-0": named["0-0"]})
    with pytest.raises(gg.GridgenError, match=r"block 1-0: the reference grid of the target has \(4, 4\) nodes"):
        gg.optimize(start, "winslow", target=named | {"1-0": gg.domain("square", 4, 4)})


def test_nodes_that_are_fixed_stay_in_all_copies():
    start = cut(gg.domain("wavy", 9, 9), (0, 4, 8), (0, 8))
    mask = np.zeros((5, 9), dtype=bool)
    mask[4, 3] = True
    found = gg.optimize(start, "winslow", fixed={"0-0": mask})
    for name, i in (("0-0", 4), ("1-0", 0)):
        assert np.array_equal(found.grid[name].xy[i, 3], start["0-0"].xy[4, 3])


def test_an_error_of_the_callback_comes_with_all_blocks():
    start = cut(gg.domain("wavy", 9, 9), (0, 4, 8), (0, 8))

    def fail(_):
        raise ValueError("mine")

    with pytest.raises(ValueError, match="mine") as caught:
        gg.optimize(start, "winslow", callback=fail)
    assert caught.value.result.grid.names == start.names


def test_what_layouts_do_not_take_is_told():
    start = cut(gg.domain("wavy", 9, 9), (0, 4, 8), (0, 8))
    with pytest.raises(gg.GridgenError, match="optimize of several blocks does not take 'interior_only'"):
        gg.optimize(start, "winslow", interior_only=True)
    with pytest.raises(gg.GridgenError, match="unknown method 'fast'"):
        gg.optimize(start, "winslow", "fast")
    with pytest.raises(gg.GridgenError, match="fixed of several blocks maps names of blocks to masks"):
        gg.optimize(start, "winslow", fixed=np.zeros((5, 9)))


@pytest.mark.usefixtures("apart")
def test_copies_stay_equal_bit_by_bit():
    found = gg.optimize(cut(gg.domain("wavy", 9, 9), (0, 4, 8), (0, 4, 8)), "winslow").grid
    copies = found.copies
    places = np.array(
        [found.blocks[b].planes[:, i, j] for b, i, j in zip(copies.block, copies.i, copies.j, strict=True)]
    )
    for begin, count in itertools.pairwise([*copies.starts, len(copies.block)]):
        assert (places[begin:count] == places[begin]).all()
