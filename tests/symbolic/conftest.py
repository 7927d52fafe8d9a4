"""Functionals that a test defines do not stay for the others."""

from __future__ import annotations

import pytest

from gridgen_sym.functionals import definition


@pytest.fixture(autouse=True)
def _clean_registry():
    before = dict(definition._registry)
    yield
    definition._registry.clear()
    definition._registry.update(before)
