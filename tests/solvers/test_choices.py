"""Functionals with choices are minimized on a curved domain without a fold, to the same grid by both back ends."""

from __future__ import annotations

import numpy as np
import pytest

import gridgen_sym as gg
from gridgen_sym.runtime import find_compiler

pytestmark = pytest.mark.slow

#: After Barrera-Sanchez, Dominguez-Mota and others (UNAM): area functionals, here with a barrier beside them.
FUNCTIONALS = {
    "epsilon_area": ("swan", "(g11 + g22)/J + max(0, a/2 - J)**2/a**2", {"a": 1.0}),
    "s_omega": ("annulus", "(g11 + g22)/J + a/(a/9 + J)", {"a": 1.0}),
    "bilateral": ("swan", "(g11 + g22)/J + where(J >= a, a/J, (J/a - 1)*(J/a - 2) + 1)", {"a": 1.0}),
    "angle": ("annulus", "(g11 + g22)/J + (acos(g12/sqrt(g11*g22)) - pi/2)**2", {}),
}


def minimized(name, backend, monkeypatch):
    """Return the minimum; a is the mean area of a cell."""
    monkeypatch.setenv("GRIDGEN_SYM_BACKEND", backend)
    domain, density, parameters = FUNCTIONALS[name]
    start = gg.domain(domain, 13, 13)
    gg.define("chosen", density, parameters=parameters, replace=True)
    mean = gg.quality(start).mean_jacobian
    return gg.optimize(start, "chosen", tolerance=1e-9, parameters=dict.fromkeys(parameters, mean))


@pytest.mark.slow
@pytest.mark.skipif(find_compiler() is None, reason="needs a C compiler")
@pytest.mark.parametrize("name", FUNCTIONALS)
def test_both_back_ends_find_the_same_minimum(name, monkeypatch):
    compiled, plain = (minimized(name, backend, monkeypatch) for backend in ("c", "numpy"))
    for result in (compiled, plain):
        assert result.converged, result.message
        assert gg.quality(result.grid).valid
    assert np.abs(compiled.grid.planes - plain.grid.planes).max() <= 1e-6 * np.ptp(plain.grid.planes)


@pytest.mark.parametrize(
    ("density", "given"),
    [
        ("max(s, 1 + 2*J)*g11/J + min(x, y)*g22", {"weight": "differentiated"}),
        pytest.param(
            "where(p > 1, p*t11, t22)/tau + max(xi, y)*J",
            {"field": "differentiated", "target": True},
            marks=pytest.mark.slow,
        ),
    ],
)
def test_gradients_are_slopes_of_the_energy_also_through_choices_in_formulas(density, given, monkeypatch):
    """Choices of places, of values that move with the nodes, and of the metric of a target, in both languages."""
    monkeypatch.setenv("GRIDGEN_SYM_BACKEND", "numpy")
    gg.define("chosen", density, fields={"p": "scalar"} if "field" in given else None)
    grid = gg.domain("wavy", 6, 7)
    options = {}
    if "weight" in given:
        options["weight"] = gg.Weight("1 + max(x, y)**2 + where(x + y > 1, sin(x*y), 0.2*x)", given["weight"])
    if "field" in given:
        options["fields"] = {
            "p": gg.Field("2*min(x, y)**2 + sign(x - 0.3)/3 + atan2(x + 1, y + 1)", mode=given["field"])
        }
    if "target" in given:
        options["target"] = gg.Target(0.2, "max(0.1, xi/5)")

    slope, random = gg.gradient(grid, "chosen", **options), np.random.default_rng(2)
    for _ in range(10):
        way = np.zeros_like(grid.planes)
        way[:, 1:-1, 1:-1] = random.normal(size=way[:, 1:-1, 1:-1].shape)

        def energy(step, way=way):
            return gg.energy(gg.Grid.from_planes(*(grid.planes + 1e-5 * step * way)), "chosen", **options)

        expected = (8 * (energy(1) - energy(-1)) - (energy(2) - energy(-2))) / 12e-5
        assert (slope * np.moveaxis(way, 0, -1)).sum() == pytest.approx(expected, abs=1e-8 * np.abs(slope).max())
