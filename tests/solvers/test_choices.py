"""Functionals with choices are minimized on a curved domain without a fold, to the same grid by both back ends."""

from __future__ import annotations

import numpy as np
import pytest

import gridgen_sym as gg
from gridgen_sym.runtime import find_compiler

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
    gg.define(name, density, parameters=parameters, replace=True)
    mean = gg.quality(start).mean_jacobian
    return gg.optimize(start, name, tolerance=1e-9, parameters=dict.fromkeys(parameters, mean))


@pytest.mark.slow
@pytest.mark.skipif(find_compiler() is None, reason="needs a C compiler")
@pytest.mark.parametrize("name", FUNCTIONALS)
def test_both_back_ends_find_the_same_minimum(name, monkeypatch):
    compiled, plain = (minimized(name, backend, monkeypatch) for backend in ("c", "numpy"))
    for result in (compiled, plain):
        assert result.converged, result.message
        assert gg.quality(result.grid).valid
    assert np.abs(compiled.grid.planes - plain.grid.planes).max() <= 1e-6 * np.ptp(plain.grid.planes)
