"""A functional without a derivative at the grid: the run ends with the term, and the command line with 1."""

from __future__ import annotations

import numpy as np
import pytest

import gridgen_sym as gg
from gridgen_sym.functionals import Functional
from gridgen_sym.solvers.differentiability import missing_derivative

KINK = "sqrt(g12**2 + (g11 - g22)**2)"


@pytest.mark.parametrize("method", ["newton", "local"])
def test_the_term_without_a_derivative_is_named(method, clean_registry, monkeypatch):
    monkeypatch.setenv("GRIDGEN_SYM_BACKEND", "numpy")
    gg.define("kink", "g11 + g22 + sqrt(abs(g12))")
    result = gg.optimize(gg.domain("square", 5, 5), "kink", method)
    assert not result.converged
    assert result.status is gg.Status.NOT_DIFFERENTIABLE
    assert "the functional kink has no derivative at this grid: the term sqrt(Abs(g12)) is" in result.message
    assert "no step downhill" not in result.message


def test_the_equations_have_no_solution_there_either(clean_registry, monkeypatch):
    monkeypatch.setenv("GRIDGEN_SYM_BACKEND", "numpy")
    kink = gg.define("kink", "g11 + g22 + sqrt(abs(g12))")
    result = gg.solve_euler_lagrange(gg.domain("square", 5, 5), kink)
    assert result.status is gg.Status.NOT_DIFFERENTIABLE
    assert "the term sqrt(Abs(g12)) is not smooth at" in result.message


def test_a_missing_second_derivative_is_named_where_no_step_is_found(clean_registry, monkeypatch):
    monkeypatch.setenv("GRIDGEN_SYM_BACKEND", "numpy")
    gg.define("bend", "g11 + g22 + 3*x_xi + abs(g12)**(4/3)")
    grid = gg.domain("square", 5, 5)
    result = gg.optimize(gg.Grid.from_planes(grid.x**2, grid.y), "bend")
    assert result.status is gg.Status.NOT_DIFFERENTIABLE
    assert "has no second derivative at this grid: the term Abs(g12)**(4/3) is not smooth at" in result.message


def test_corners_are_counted():
    kink = Functional("kink", KINK)
    planes, steps = gg.domain("square", 5, 5).planes.copy(), (0.25, 0.25)
    assert f"{KINK} is not smooth at 64 of 64 corners" in missing_derivative(kink, None, planes, steps)
    planes[0, 2, 2] += 0.01
    assert f"{KINK} is not smooth at 52 of 64 corners" in missing_derivative(kink, None, planes, steps)
    assert missing_derivative(Functional("smooth", "g11**2"), None, planes, steps) is None


def test_parameters_are_those_of_the_run():
    functional = Functional("shifted", "sqrt(abs(J - k))", parameters={"k": 2.0})
    planes = np.stack(np.meshgrid(np.arange(4.0), np.arange(4.0), indexing="ij"))
    assert missing_derivative(functional, None, planes, (1.0, 1.0)) is None
    assert "sqrt(Abs(J - k))" in missing_derivative(functional, {"k": 1.0}, planes, (1.0, 1.0))
    assert "sqrt(Abs(J - k))" in missing_derivative(functional, None, planes, (1.0, 0.5))


def test_a_value_that_is_no_number_is_named_with_its_place():
    log = Functional("log_of_a_field", "log(p)*(g11 + g22)/J", fields={"p": "scalar"})
    grid = gg.domain("swan", 9, 9)
    valid = gg.optimize(grid, "winslow").grid
    match = r"no finite value at .* corners of this grid, first at that of node \(0, 0\).*p = -1, because .*log\(p\)"
    with pytest.raises(gg.GridgenError, match=match):
        gg.energy(valid, log, fields={"p": -1.0})
    result = gg.optimize(valid, log, fields={"p": -1.0})
    assert not result.converged
    assert result.status is gg.Status.NOT_DIFFERENTIABLE
    assert "p = -1, because of the term" in result.message
    assert gg.quality(result.grid).valid
