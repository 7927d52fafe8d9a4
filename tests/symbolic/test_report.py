"""The report shows every part, in text and in LaTeX."""

from __future__ import annotations

import pytest

from gridgen_sym.functionals import functional, functionals
from gridgen_sym.functionals.definition import Functional
from gridgen_sym.symbolic import derive_latex, derive_text


@pytest.mark.parametrize("name", functionals())
def test_text_has_every_part(name):
    text = derive_text(functional(name))
    for part in ("Density", "Corner energy", "dE/dx_xi =", "H+/d", "divergence form", "expanded form", "det A(k) ="):
        assert part in text
    assert ("Equidistribution, weight frozen" in text) == ("*s" in text.split("Corner")[0])


@pytest.mark.parametrize("name", functionals())
def test_latex_is_balanced(name):
    latex = derive_latex(functional(name))
    assert latex.count("{") == latex.count("}")
    assert latex.count(r"\left") == latex.count(r"\right")
    assert latex.count(r"\[") - latex.count(r"\\[") == latex.count(r"\]")
    assert r"x_{\xi \xi}" in latex
    assert "_xi" not in latex.replace(r"\_xi", "")


def test_weight_laws_and_reduction_are_shown():
    text = derive_text(functional("area"))
    assert "c = J*s\n" in text
    assert "c = J*sqrt(s)\n" in text
    assert "det M = 4/J**4" in derive_text(functional("winslow"))


def test_what_is_not_there_is_said_in_words():
    text = derive_text(Functional("other", "g11 - g22"))
    assert "in g1 alone: not homogeneous" in text
    assert "Lower bound: none, unbounded below by scaling." in text
    assert "Lower bound: none found." in derive_text(Functional("other", "J**2 - J**4"))
    assert "None" not in text
