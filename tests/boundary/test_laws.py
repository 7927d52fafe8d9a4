"""Spacing laws: the lengths that were asked for, monotone and smooth, for many lines at once."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import gridgen_sym as gg
from gridgen_sym.boundary.laws import geometric, growing, hyperbolic_sine, hyperbolic_tangent, two_ended

ONE_ENDED = [geometric, hyperbolic_sine, hyperbolic_tangent]
firsts = st.floats(1e-8, 0.3)


@pytest.mark.parametrize("law", ONE_ENDED)
@given(first=st.lists(firsts, min_size=1, max_size=4), cells=st.integers(2, 200))
def test_the_first_cell_is_as_long_as_asked(law, first, cells):
    first = [min(one, 2 / cells) for one in first]
    found = law(first, cells)
    assert found.shape == (len(first), cells + 1)
    step = np.diff(found, axis=1)
    reachable = np.array(first) > 2 * np.exp(-5.0 * (cells - 1))
    np.testing.assert_allclose(step[reachable, 0], np.array(first)[reachable], rtol=1e-6)
    assert (step > 0).all()
    np.testing.assert_array_equal(found[:, [0, -1]], [[0.0, 1.0]] * len(first))


def test_a_geometric_law_has_one_ratio_and_the_others_do_not_exceed_it_by_much():
    ratios = [(lambda step: step[0, 1:] / step[0, :-1])(np.diff(law(1e-5, 40), axis=1)) for law in ONE_ENDED]
    assert np.ptp(ratios[0]) < 1e-9
    assert max(ratios[1].max(), ratios[2].max()) < 1.1 * ratios[0][0]
    # tanh ends with nearly equal cells, sinh goes on to grow.
    assert ratios[2][-1] < 1.05 < ratios[1][-1]


@given(first=firsts, last=firsts, cells=st.integers(6, 200))
def test_a_law_of_two_ends_has_both_lengths(first, last, cells):
    if first + last > 2.2 / cells or min(first, last) < 1e-6:
        first, last = min(first, 1 / cells), min(last, 1 / cells)
        first, last = max(first, 1e-6), max(last, 1e-6)
    step = np.diff(two_ended(first, last, cells), axis=1)[0]
    assert (step > 0).all()
    np.testing.assert_allclose(step[[0, -1]], [first, last], rtol=1e-6)


@given(first=st.floats(1e-7, 1e-2), growth=st.floats(1.01, 1.6), cells=st.integers(10, 120))
def test_cells_grow_as_told_until_the_rest_is_even(first, growth, cells):
    step = np.diff(growing(first, growth, cells), axis=1)[0]
    np.testing.assert_allclose(step.sum(), 1, rtol=1e-12)
    ratio = step[1:] / step[:-1]
    if first * (growth**cells - 1) / (growth - 1) >= 1:
        assert step[0] == pytest.approx(min(first, 1 / cells), rel=1e-9)
        assert ratio.max() <= growth * (1 + 1e-9)
        assert ratio.min() >= 1 - 1e-9
        assert step[-1] == pytest.approx(step[-2])
    else:
        assert step[0] == pytest.approx(first, rel=1e-9)
        np.testing.assert_allclose(ratio[: cells // 2 - 1], growth, rtol=1e-9)
        np.testing.assert_allclose(ratio[cells // 2 :], ratio[-1], rtol=1e-6)


def test_layers_say_how_many_cells_grow_at_least():
    ratio = (lambda step: step[1:] / step[:-1])(np.diff(growing(1e-6, 1.05, 64, 20), axis=1)[0])
    np.testing.assert_allclose(ratio[:19], 1.05, rtol=1e-12)
    assert ratio[20:].min() > 1.2


@pytest.mark.parametrize("first", [0.0, -1e-3, 1.0, np.nan])
def test_a_first_cell_without_a_place_on_the_line_is_refused(first):
    with pytest.raises(gg.GridgenError, match="the first cell of line 1 has"):
        geometric([0.1, first], 10)
