"""From the density to the weight: it equidistributes, in any unit, for functionals of one's own too."""

from __future__ import annotations

import numpy as np
import pytest
from support_solvers import farthest

import gridgen_sym as gg
from gridgen_sym.adaptation.nodes import BlockNodes
from gridgen_sym.adaptation.weight_exponent import weight_exponent_of, weight_values

from .conftest import SHARP, interpolation_error, ring, square


@pytest.mark.parametrize("name", ["ring", "two scales", "shock"])
def test_the_density_is_equidistributed(name):
    result = gg.adapt(square(), SHARP[name])
    assert result.converged, result.message
    assert result.after.weight.variation < result.before.weight.variation / 5
    assert result.after.weight.ratio < result.before.weight.ratio / 2
    assert result.after.weight == gg.equidistribution(result.grid, result.density).weight
    assert result.history[-1].spread == pytest.approx(result.after.weight.variation)


def test_weights_of_known_exponents_and_of_ones_own():
    """Where the grid's area is a, and the density over its mean r: r^p/a^q, and r^p for a power that is given."""
    grid = gg.Grid(0.5 * square(5).xy)
    area, density = 0.5**2, np.full((5, 5), 3.0)
    density[2, 2] = 19.0  # The mean over the cells is 4.
    for name, power, expected in (
        ("area", None, density / 4 / area**2),
        ("length", None, density / 4 / area),
        ("mine", 0.5, np.sqrt(density / 4)),
    ):
        np.testing.assert_allclose(
            weight_values(density, BlockNodes(grid), weight_exponent_of(name, power)), expected, rtol=1e-12
        )


def test_a_functional_of_ones_own_needs_its_exponent():
    own = gg.define("own_adaptive", lambda m: m.s * (m.g11 + m.g22) + 1e-7 / m.J, replace=True)
    with pytest.raises(gg.GridgenError, match="how 'own_adaptive' places nodes with a weight is not known"):
        gg.adapt(square(17), ring, functional=own)
    result = gg.adapt(square(), ring, functional=own, weight_exponent=1, max_iterations=5)
    with pytest.warns(DeprecationWarning, match=r"power=.*weight_exponent"):
        assert gg.adapt(square(), ring, functional=own, power=1, max_iterations=5).grid == result.grid
    assert result.quality.valid
    assert interpolation_error(result.grid, ring) < 0.5 * interpolation_error(square(), ring)


@pytest.mark.parametrize("scale", [1e-3, 1e4])
def test_units_do_not_matter(scale):
    function = lambda x, y: 7 * scale * ring(x / scale, y / scale)  # noqa: E731
    plain = gg.adapt(square(21), ring, max_iterations=5).grid
    scaled = gg.adapt(gg.Grid(square(21).xy * scale), function, max_iterations=5).grid
    assert farthest(gg.Grid(scaled.xy / scale), plain) < 1e-6
