"""The law of equidistribution has a name of its own, and its old one for a while."""

from __future__ import annotations

import pytest

from gridgen_sym import adaptation, symbolic


def test_the_law_and_the_measurement_are_two_classes_with_two_names():
    assert symbolic.EquidistributionLaw.__name__ == "EquidistributionLaw"
    with pytest.warns(DeprecationWarning, match="called EquidistributionLaw"):
        assert symbolic.Equidistribution is symbolic.EquidistributionLaw
    assert adaptation.Equidistribution is not symbolic.EquidistributionLaw
    with pytest.raises(AttributeError, match="no attribute 'Equidistributions'"):
        _ = symbolic.Equidistributions
