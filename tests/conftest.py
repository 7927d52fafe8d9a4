"""Fixtures of several folders of tests."""

from __future__ import annotations

import pytest

from gridgen_sym.functionals import definition


@pytest.fixture(autouse=True)
def not_quiet(monkeypatch):
    """Let messages be told, also where the user's environment silences them."""
    monkeypatch.delenv("GRIDGEN_SYM_QUIET", raising=False)


@pytest.fixture
def clean_registry(monkeypatch):
    """Forget the functionals that a test defines."""
    monkeypatch.setattr(definition, "_registry", dict(definition._registry))
