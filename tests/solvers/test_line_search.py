"""How long a step is, and how well the next system is solved: by problems of one number."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

import gridgen_sym as gg
from gridgen_sym.errors import UnusableValueError
from gridgen_sym.solvers.convergence import ConvergenceTest
from gridgen_sym.solvers.folds import mean_jacobian
from gridgen_sym.solvers.iterate import Iterate
from gridgen_sym.solvers.newton.line_search import LineSearch
from gridgen_sym.solvers.newton.steps import NewtonSteps
from gridgen_sym.solvers.norms import inner, norm_of
from gridgen_sym.solvers.run.deadline import Deadline
from gridgen_sym.solvers.run.step_control import StepControl, diverges, jacobian_floor


class OneNumber:
    """An energy of the first coordinate alone; its Jacobian, too, is a function of it."""

    inputs = None
    norm, inner, mean_jacobian = staticmethod(norm_of), staticmethod(inner), staticmethod(mean_jacobian)

    def __init__(self, energy, slope, jacobian=lambda x: 1.0, scale=1.0, round_off=0.0, barrier=True):
        self._energy, self._slope, self._jacobian = energy, slope, jacobian
        self.scale, self.rounding = scale, round_off
        self.kernels = SimpleNamespace(barrier=barrier, polyconvex=True, planes=())

    @property
    def lags(self):
        return self.inputs is not None and self.inputs.lags

    def refresh(self, coordinates):
        """There is no weight."""

    def retract(self, coordinates, *, trial=False):
        """No node slides."""

    def follow(self, coordinates):
        """No node slides."""

    def energy(self, coordinates):
        x = float(coordinates[0, 0, 0])
        return self._energy(x), self._jacobian(x)

    def energy_gradient(self, coordinates, out=None):
        gradient = np.zeros_like(coordinates) if out is None else out
        gradient[0, 0, 0] = self._slope(float(coordinates[0, 0, 0]))
        return *self.energy(coordinates), gradient

    def gradient_scale(self, coordinates, energy):
        return self.scale * abs(energy)

    def round_off(self, coordinates, gradient):
        return self.rounding


def place(x):
    coordinates = np.zeros((2, 3, 3))
    coordinates[0, 0, 0], coordinates[1, 2, 2] = x, 8.0  # The extent of the grid.
    return coordinates


def search(problem, x, lowest=-np.inf):
    point = Iterate(problem, place(x))
    return LineSearch(point, lowest, np.empty_like(point.coordinates))


def direction(dx):
    return place(dx) - place(0.0)


PARABOLA = OneNumber(lambda x: x * x, lambda x: 2 * x)


@pytest.mark.parametrize(("dx", "length"), [(-1.0, 1.0), (-1.9, 1.0), (-2.0, 0.5), (-8.0, 0.125), (-7.0, 0.25)])
def test_a_step_must_lower_the_energy_enough(dx, length):
    """A step to the other side of the parabola, just as high, is none: it is halved."""
    along = search(PARABOLA, 1.0)
    assert along.along(direction(dx))
    assert along.length == length
    assert not along.folds


def test_rounding_is_no_rise():
    flat = OneNumber(lambda x: 1e6 + 1e-9 * (x < 1), lambda x: 1e-12)
    along = search(flat, 1.0)
    assert along.along(direction(-1e-3))
    assert along.length == 1.0


def test_uphill_there_is_no_step():
    assert not search(PARABOLA, 1.0).along(direction(1.0))


def test_no_step_goes_below_the_lowest_jacobian():
    along = search(OneNumber(lambda x: x, lambda x: 1.0, jacobian=lambda x: x), 1.0, lowest=0.3)
    assert along.along(direction(-1.0))
    assert (along.length, along.folds) == (0.5, True)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_direction_of_negative_curvature_is_followed_downhill(sign):
    """Whichever way it points, and as far as that lowers the energy most: here to -2, by halves of the extent."""
    hill = OneNumber(lambda x: (x * x - 4) ** 2 + 1e-3 * x, lambda x: 4 * x * (x * x - 4) + 1e-3)
    away = search(hill, 0.0)
    assert away.away(direction(sign))
    assert away.length * sign == -2.0


def test_the_energy_of_the_accepted_step_is_known():
    along = search(PARABOLA, 1.0)
    assert along.along(direction(-8.0))
    assert along.energy == 0.0
    hill = search(OneNumber(lambda x: (x * x - 4) ** 2, lambda x: 4 * x * (x * x - 4)), 0.0)
    assert hill.away(direction(1.0))
    assert (abs(hill.length), hill.energy) == (2.0, 0.0)


def test_only_cut_steps_that_lead_nowhere_in_a_row_hold_back():
    control = StepControl(True, 0.0)
    for cut, progress, in_vain in ((1, 0, 1), (1, 0, 2), (1, 1, 0), (1, 0, 1), (0, 0, 0), (1, 0, 1)):
        control.count(bool(cut), bool(progress))
        assert control.in_vain == in_vain
    assert str(control) == " 5 steps were cut short so that no cell folds."
    assert not control.holds_back
    for _ in range(4):
        control.count(True, False)
    assert control.holds_back
    assert str(StepControl(True, 0.0)) == ""


def test_how_far_a_step_may_take_the_smallest_jacobian():
    control = StepControl(True, 1e-3)
    assert control.lowest(5.0) == 0.5
    assert control.lowest(2e-3) == 1e-3
    for free in (control.lowest(0.0), control.lowest(-1.0), StepControl(False, 1e-3).lowest(5.0)):
        assert free == -np.inf
    assert (jacobian_floor(2.0), jacobian_floor(-2.0)) == (2e-6, 0.0)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_step_far_beyond_the_domain_diverges(sign):
    step = np.zeros((2, 3, 3))
    for far, too_far in ((999.0, False), (1001.0, True), (np.nan, True)):
        step[1, 1, 1] = sign * far
        assert diverges(step, 1.0) == too_far


def newton(forcing=0.1):
    return NewtonSteps(PARABOLA, None, Deadline(), only_semidefinite=False, forcing=forcing)


def taken(length, folds=False):
    return SimpleNamespace(length=length, folds=folds)


def test_the_next_system_is_solved_as_well_as_it_deserves():
    state = newton()
    state.learn(taken(1.0), reduction=0.1, wanted=1e-6)
    assert state.forcing == pytest.approx(0.05)
    state.learn(taken(1.0), reduction=0.01, wanted=1e-3)
    assert state.forcing == pytest.approx(5e-4), "the last one: Newton's method squares 0.01"
    state.learn(taken(1.0), reduction=0.9, wanted=1e-6)
    assert state.forcing <= 0.1


def test_only_whole_steps_that_lead_nowhere_are_stalls():
    state = newton()
    for length, reduction, stalls in ((1.0, 0.9, 1), (1.0, 0.8, 2), (0.5, 0.9, 0), (1.0, 0.9, 1), (1.0, 0.1, 0)):
        state.learn(taken(length), reduction, 1e-9)
        assert state.stalls == stalls


def test_a_step_that_would_fold_a_cell_says_nothing_of_the_hessian():
    state = newton()
    state.problem = SimpleNamespace(kernels=SimpleNamespace(polyconvex=False))
    state.learn(taken(0.1, folds=True), 0.9, 1e-9)
    assert state.shift == 0
    state.learn(taken(0.1), 0.9, 1e-9)
    assert state.shift > 0


def test_a_goal_is_a_part_of_the_smaller_of_start_and_scale():
    falling = OneNumber(lambda x: x, lambda x: x, scale=0.5)
    goal = ConvergenceTest(Iterate(falling, place(100.0)), 1e-2)
    assert (goal.first, goal.norm) == (50.0, 0.5)
    assert goal.reached(Iterate(falling, place(0.0)))
    assert ConvergenceTest(Iterate(falling, place(100.0)), 1e-2, reference=10.0).first == 10.0


def test_where_the_energy_at_a_barrier_has_fallen_far_the_goal_is_another():
    steep = OneNumber(lambda x: x, lambda x: x, jacobian=lambda x: -1e-9, scale=0.5)
    goal = ConvergenceTest(Iterate(steep, place(100.0)), 1e-2)
    assert not goal.reached(Iterate(steep, place(0.4))), "a part of 0.2, now"
    assert goal.first == pytest.approx(0.2)
    steep.kernels.barrier = False
    assert ConvergenceTest(Iterate(steep, place(100.0)), 1e-2).reached(Iterate(steep, place(0.4)))
    roomy = OneNumber(lambda x: x, lambda x: x, scale=0.5)
    assert ConvergenceTest(Iterate(roomy, place(100.0)), 1e-2).reached(Iterate(roomy, place(0.4))), (
        "an energy may tend to 0"
    )


def test_rounding_is_measured_where_it_decides():
    problem = OneNumber(lambda x: x, lambda x: x, round_off=10.0)
    goal = ConvergenceTest(Iterate(problem, place(20.0)), 1e-3)
    problem.rounding = 1e-3
    assert not goal.reached(Iterate(problem, place(9.0)))
    problem.rounding = 5.0
    goal = ConvergenceTest(Iterate(problem, place(20.0)), 1e-3)
    assert goal.reached(Iterate(problem, place(4.0)))
    assert not ConvergenceTest(Iterate(problem, place(20.0)), 0.1).reached(Iterate(problem, place(4.0))), (
        "who asks for little"
    )


# ---- a weight that has no value at a trial point ----


def ends_at_one(x):
    """An energy whose weight does not exist beyond 1."""
    if x > 1:
        raise UnusableValueError("no value there")
    return (x - 3) ** 2


def test_a_trial_point_without_a_value_is_a_refused_step():
    found = search(OneNumber(ends_at_one, lambda x: 2 * (x - 3)), 0.0)
    assert found.along(direction(3.0))
    assert found.length == 0.25
    assert not found.folds, "no cell would have been folded"
    assert found.away(direction(3.0))
    assert 0 < found.length * 3 <= 1


def test_a_held_weight_must_exist_where_a_step_leads():
    problem = OneNumber(lambda x: (x - 3) ** 2, lambda x: 2 * (x - 3))
    problem.inputs = SimpleNamespace(lags=True)
    problem.exists_at = lambda place: place[0, 0, 0] <= 1
    found = search(problem, 0.0)
    assert found.along(direction(3.0))
    assert found.length == 0.25
    problem.inputs.lags = False
    assert found.along(direction(3.0))
    assert found.length == 1.0


@pytest.mark.slow
@pytest.mark.parametrize("mode", ["frozen", "differentiated"])
@pytest.mark.parametrize("formula", ["1 + 20/cosh(20*(x+y-1))**2", "sqrt(1.0001-x)*sqrt(1e-4+x)*sqrt(1.0001-y)"])
def test_a_weight_that_ends_near_the_boundary_ends_no_run(formula, mode):
    """Pure area with such a weight has its first trial points far outside."""
    start = gg.domain("square", 17, 17)
    result = gg.optimize(
        start, "area_winslow", weight=gg.Weight(formula, mode), parameters={"k": 1e-9}, max_iterations=25
    )
    assert result.quality.valid
    assert result.energy < gg.energy(start, "area_winslow", weight=gg.Weight(formula, mode), parameters={"k": 1e-9})
