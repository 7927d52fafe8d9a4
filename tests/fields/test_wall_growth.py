"""Growth that cells at a wall cannot keep is told, by numbers and in the message; a growth below 1 is an error."""

import numpy as np
import pytest
from support_walls import channel

import gridgen_sym as gg
from gridgen_sym.boundary.laws import geometric, growing, growing_from_both
from gridgen_sym.boundary.wall import walls_by_side
from gridgen_sym.fields.wall_growth import wall_remarks


def square(ni=9, nj=17):
    return gg.domain("square", ni, nj).planes


def remarks(planes=None, **walls):
    return wall_remarks(walls_by_side(walls), square() if planes is None else planes)


def test_cells_that_do_not_reach_the_opposite_side():
    """16 cells from 1/100 that grow by 1.1: (1.1^16 - 1)/0.1/100 of the distance."""
    (found,) = remarks(bottom=gg.Wall(0.01, growth=1.1))
    assert (found.side, found.kind) == ("bottom", "short")
    assert found.covered == pytest.approx((1.1**16 - 1) / 10, rel=1e-12)
    step = np.diff(geometric(0.01, 16)[0])
    assert found.reaching == pytest.approx(step[1] / step[0], rel=1e-9)
    assert not remarks(bottom=gg.Wall(0.01, growth=1.001 * found.reaching))
    outer = np.diff(growing(0.01, 1.1, 16)[0])
    assert f"farther out they grow by {outer[-1] / outer[-2]:.3g}" in found.text
    assert f"A growth of {found.reaching:.3g} would reach it." in str(found)


def test_all_cells_are_stretched_where_all_must_grow_so():
    (found,) = remarks(bottom=gg.Wall(0.01, growth=1.1, share=1.0))
    assert "all are stretched" in found.text


def test_cells_that_are_too_high_to_grow():
    (found,) = remarks(bottom=gg.Wall(0.1, growth=1.1))
    assert found.kind == "long"
    assert found.reaching < 1 < found.covered
    assert "16 cells of the first height at bottom are 1.6 times the distance" in found.text


@pytest.mark.parametrize(
    ("side", "other", "cells"), [("top", "bottom", 16), ("left", "right", 8), ("right", "left", 8)]
)
def test_every_side_has_its_own_distance_and_cells(side, other, cells):
    planes = square() * [[[3.0]], [[1.0]]]
    distance = 1.0 if side == "top" else 3.0
    (found,) = remarks(planes, **{side: gg.Wall(0.01, growth=1.2)})
    assert found.side == side
    assert found.covered == pytest.approx(0.01 * (1.2**cells - 1) / 0.2 / distance, rel=1e-12)
    both = remarks(planes, **{side: gg.Wall(0.01, growth=1.2), other: gg.Wall(0.01)})
    assert [(one.side, one.kind) for one in both] == [(side, "unused")]


def test_two_walls_whose_cells_meet():
    assert not remarks(bottom=gg.Wall(0.02, growth=1.3), top=gg.Wall(0.02, growth=1.3))
    short = remarks(bottom=gg.Wall(0.001, growth=1.1), top=gg.Wall(0.001, growth=1.1))
    assert [one.kind for one in short] == ["unused", "unused"]


def test_cells_grow_from_both_ends_and_are_even_in_the_middle():
    law = growing_from_both([0.03, 0.03], 1.3, [0.01, 0.03], [1.5, 1.2], 16)
    step = np.diff(law, axis=1)
    np.testing.assert_allclose(step[:, 0], [0.03, 0.03], rtol=1e-9)
    np.testing.assert_allclose(step[:, -1], [0.01, 0.03], rtol=1e-9)
    np.testing.assert_allclose(step[:, 1:4] / step[:, :3], 1.3, rtol=1e-9)
    np.testing.assert_allclose(step[:, -4:-1] / step[:, -3:], [[1.5] * 3, [1.2] * 3], rtol=1e-9)
    for line in step:
        even = line[np.isclose(line, line.max(), rtol=1e-9)]
        assert len(even) >= 2
    assert growing_from_both(0.001, 1.1, 0.001, 1.1, 16) is None
    # An odd number of cells that just meet: the one in the middle is longer than they are, by less than the growth.
    short = 0.98 * 0.5 * 0.2 / (1.2**7 - 1 + 0.1 * 1.2**7)
    middle = np.diff(growing_from_both(short, 1.2, short, 1.2, 15)[0])[6:9]
    assert 1 < middle[1] / (1.2 * middle[0]) < 1.2
    assert growing_from_both(0.1, 1.1, 0.01, 1.1, 16) is None


def test_the_worst_node_of_a_wall_counts():
    first = np.full(9, 0.03)
    first[4] = 0.01
    (found,) = remarks(bottom=gg.Wall(first, growth=1.1))
    assert found.covered == pytest.approx((1.1**16 - 1) / 10, rel=1e-12)
    assert not remarks(bottom=gg.Wall(first[:4], growth=1.1, nodes=(0, 4)))


def test_without_a_growth_there_is_nothing_to_tell():
    assert not remarks(bottom=gg.Wall(1e-9), left=gg.Wall(0.2))


@pytest.mark.parametrize("control", [None, "hilgenstock-white"])
def test_results_have_the_remarks_and_their_sentences(control):
    start, walls = channel(17, 13, first=1e-2), {"bottom": gg.Wall(1e-2, growth=1.1)}
    solved = gg.solve_euler_lagrange(start, "winslow", walls=walls, control=control, progress=False)
    (found,) = solved.wall_remarks
    assert found.kind == "short"
    assert found.text in solved.message
    if control is None:
        minimized = gg.optimize(start, "winslow", walls=walls, progress=False)
        assert [one.kind for one in minimized.wall_remarks] == ["short"]
        assert minimized.wall_remarks[0].text in minimized.message
        assert gg.optimize(start, "winslow", walls={"bottom": gg.Wall(1e-2)}, progress=False).wall_remarks == ()


@pytest.mark.parametrize("growth", [0.5, 0.999, [1.2, 0.9, 1.2]])
def test_a_growth_below_one_is_refused_at_once(growth):
    with pytest.raises(gg.GridgenError, match="growth of the wall must be 1 or more, since cells that shrink"):
        gg.Wall(1e-3, growth=growth)


@pytest.mark.parametrize("cells", [2, 3, 4])
def test_a_geometric_law_meets_its_first_cell_on_few_cells(cells):
    assert geometric(1e-9, cells)[0, 1] == pytest.approx(1e-9, rel=1e-9)
    assert growing(1e-9, 1.2, cells)[0, 1] == pytest.approx(1e-9, rel=1e-9)
