"""Which of two starts a run takes: that of less folds, or of lower energy where that means something."""

from __future__ import annotations

import numpy as np
import pytest

import gridgen_sym as gg
from gridgen_sym.functionals import functional
from gridgen_sym.solvers.binding import make_problem
from gridgen_sym.solvers.minimization import Run
from gridgen_sym.solvers.run.progress import Progress

SQUARE = gg.domain("square", 7, 7).planes
WEIGHT = "1 + x + 2*y"


def with_moved(*moves):
    """The uniform grid with some nodes moved: (i, j, x, y) in units of a cell."""
    planes = SQUARE.copy()
    for i, j, x, y in moves:
        planes[:, i, j] += np.array([x, y]) / 6
    return planes


EVEN, BENT = SQUARE.copy(), with_moved(*((i, j, 0.45, 0.45) for i in (1, 4) for j in (1, 4)))
ONE_FOLD, LONG_FOLD = with_moved((1, 1, 1.2, 0)), with_moved((1, 1, 3, 3))
#: Folded in two places, and one corner only just: winslow's energy, which means nothing there, is far below zero.
TWO_FOLDS = with_moved((1, 1, 1.01, 1.01), (4, 4, 1.2, 1.2))


def energy(planes, name):
    return gg.energy(gg.Grid.from_planes(*planes), name)


def folds(planes):
    return gg.quality(gg.Grid.from_planes(*planes)).folded_cells


@pytest.mark.parametrize(
    ("name", "present", "offered", "better"),
    [
        ("winslow", BENT, EVEN, True),
        ("winslow", EVEN, BENT, False),
        ("winslow", ONE_FOLD, EVEN, True),
        ("winslow", EVEN, ONE_FOLD, False),
        ("winslow", ONE_FOLD, TWO_FOLDS, False),
        ("winslow", TWO_FOLDS, ONE_FOLD, True),
        ("length", TWO_FOLDS, EVEN, True),
        ("length", BENT, ONE_FOLD, False),
        ("length", ONE_FOLD, BENT, True),
        ("length", LONG_FOLD, TWO_FOLDS, True),
        ("length", TWO_FOLDS, LONG_FOLD, False),
    ],
)
def test_the_better_of_two_starts_is_taken(name, present, offered, better):
    definition = functional(name)
    problem = make_problem(gg.Grid.from_planes(*present), name, weight=WEIGHT)
    run = Run(
        problem, lambda grid: problem, definition, None, present.copy(), Progress("test"), gg.Grid.from_planes(*present)
    )
    run.take(offered.copy())
    taken = offered if better else present
    np.testing.assert_array_equal(run.coordinates, taken)
    # The weight is held as it is on the grid that counts.
    np.testing.assert_allclose(problem.values(run.coordinates).nodes[0], 1 + taken[0] + 2 * taken[1])
    untangled = name == "winslow" and folds(present) > 0 and folds(taken) == 0
    assert (run.untangled_by == "nested iteration") == untangled


def test_what_the_cases_are_meant_to_show():
    """The less folded grid has the higher energy, in each pair of which one is folded."""
    assert [folds(grid) for grid in (EVEN, BENT, ONE_FOLD, LONG_FOLD, TWO_FOLDS)] == [0, 0, 2, 3, 6]
    assert energy(TWO_FOLDS, "winslow") < energy(ONE_FOLD, "winslow")
    assert energy(ONE_FOLD, "length") < energy(BENT, "length")
    assert energy(TWO_FOLDS, "length") < energy(LONG_FOLD, "length")
