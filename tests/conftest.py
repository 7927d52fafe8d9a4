"""Fixtures of several folders of tests."""

from __future__ import annotations

import pytest

from gridgen_sym.functionals import definition


@pytest.fixture
def clean_registry(monkeypatch):
    """Forget the functionals that a test defines."""
    monkeypatch.setattr(definition, "_registry", dict(definition._registry))
