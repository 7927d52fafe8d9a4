"""Densities that cannot be used are refused, with a message that names the repair."""

from __future__ import annotations

import contextlib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gridgen_sym.errors import GridgenError
from gridgen_sym.functionals import define, functional, functionals
from gridgen_sym.functionals.metric import DENSITY_NAMES


@pytest.mark.parametrize(
    ("density", "message"),
    [
        ("J^2", r"\*\*"),
        ("q + J", "unknown name 'q'"),
        ("sqrt(-1)*J", "not real"),
        ("1/(g11 - g11)", "not real and finite"),
        ("log(-J)", "real and finite|not real"),
        ("J +", "cannot be read"),
        ("__import__('os')", "unknown function|not arithmetic"),
        ("3", "does not depend on the grid"),
        (lambda m: m.J ^ 2, r"\*\*"),
        (lambda m: m.area, "cannot use m.area"),
        (lambda m, k: k * m.J, "default value"),
        (lambda m: None, "not a formula"),
    ],
)
def test_bad_densities(density, message):
    before = functionals()
    with pytest.raises(GridgenError, match=message):
        define("bad_density", density)
    assert functionals() == before


def test_names_and_constraints():
    with pytest.raises(GridgenError, match="exists"):
        define("area", "J**2")
    with pytest.raises(GridgenError, match="lower-case"):
        define("Bad Name", "J**2")
    with pytest.raises(GridgenError, match="needs k >= 0"):
        define("bad_density", "k*J**2", parameters={"k": -1}, constraints=("k >= 0",))
    with pytest.raises(GridgenError, match="something else"):
        define("bad_density", "s*J", parameters={"s": 1})
    with pytest.raises(GridgenError, match="k_A \\+ k_L"):
        functional("combined").values({"k_A": 0.9})
    with pytest.raises(GridgenError, match="finite"):
        functional("combined").values({"k_A": float("nan")})
    with pytest.raises(GridgenError, match="Did you mean 'winslow'"):
        functional("winslo")


@settings(deadline=None, max_examples=40)
@given(st.text(alphabet="abcdJgs1+-*/^(). ", min_size=1, max_size=8))
def test_any_text_is_defined_or_refused(text):
    with contextlib.suppress(GridgenError):
        made = define("any_text", text, replace=True)
        assert {str(v) for v in made.expression().free_symbols} <= set(DENSITY_NAMES)
