"""The page of a functional that declares fields: what they are, and pictures made with smooth ones."""

from __future__ import annotations

import pytest

from gridgen_sym.documentation import pictures
from gridgen_sym.documentation.functional_page import write_functional_page
from gridgen_sym.functionals import Functional

pytestmark = pytest.mark.slow


@pytest.mark.slow
def test_a_page_names_the_fields_and_their_values(tmp_path, monkeypatch):
    pytest.importorskip("matplotlib")
    monkeypatch.setattr(pictures, "domain_names", lambda: ("square",))
    scaled = Functional("scaled", "p*(g11 + g22)/J", fields={"p": "scalar"}, constraints=("p > 0",))
    text = write_functional_page(scaled, tmp_path).read_text()
    assert "- **Fields**: p is a scalar; p > 0." in text
    assert "cells when this page was built, with the fields p = `" in text
    assert "| `square` | 0 | 0 | " in text
    assert "P = " in text
