"""Functionals are judged at the parameters that their constraints allow, and at no others."""

from __future__ import annotations

import re

import numpy as np
import pytest

from gridgen_sym.functionals import Functional, functional
from gridgen_sym.functionals.expression import holds
from gridgen_sym.symbolic import corner_model, derive_text
from gridgen_sym.symbolic.admissible import admissible

WINSLOW = "(g11 + g22)/J"


def made(density: str, parameters: dict[str, float], *constraints: str) -> Functional:
    return Functional("made", density, parameters=parameters, constraints=constraints)


def splitting(density, parameters, *constraints):
    return corner_model(made(density, parameters, *constraints)).splitting


@pytest.mark.parametrize("variant", ["plain", "frozen", "differentiated", "regularized"])
def test_area_winslow_is_polyconvex(variant):
    """It was called refuted by k = -0.73, which its own constraint k > 0 forbids."""
    found = corner_model(functional("area_winslow"), variant).splitting
    assert (found.holds, found.proof) == (True, "proved")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("factor", "parameters", "constraints"),
    [
        ("k", {"k": 1}, ("k > 0",)),
        ("k", {"k": 1}, ("k >= 0",)),
        ("k", {"k": 1}, ("0 < k",)),
        ("k", {"k": 1}, ("2*k >= 1",)),
        ("(1 - k)", {"k": 0.5}, ("0 < k < 1",)),
        ("(2 - 3*k)", {"k": 0.5}, ("k >= 0", "k <= 2/3")),
        ("(3 - k)", {"k": 0.5}, ("k <= 3",)),
        ("(b - a)", {"a": 0.5, "b": 1}, ("a > 0", "b > a")),
        ("b", {"a": 0.25, "b": 0.75}, ("a + b == 1", "0 <= a <= 1")),
        ("c", {"a": 0.2, "b": 0.3, "c": 0.5}, ("a >= 0", "b >= 0", "c >= 0", "a + b + c == 1")),
        ("(a + b - c)", {"a": 0.5, "b": 2, "c": 1}, ("a + b >= c",)),
        ("(1 - a - 2*b)", {"a": 0.25, "b": 0.25}, ("a >= 0", "b >= 0", "a + 2*b < 1")),
        ("a*b", {"a": 0.5, "b": 2}, ("a*b == 1",)),
        ("k**2", {"k": 1}, ()),
    ],
)
def test_constraints_of_all_kinds_prove_polyconvexity(factor, parameters, constraints):
    found = splitting(f"J**2 + {factor}*{WINSLOW}", parameters, *constraints)
    assert (found.holds, found.proof) == (True, "proved")


@pytest.mark.parametrize(
    ("factor", "parameters", "constraints"),
    [
        ("k", {"k": 1}, ()),
        ("k", {"k": 1}, ("k >= -0.01",)),
        ("(1 - k)", {"k": 0.5}, ("k > 0",)),
        ("(1 - k)", {"k": 0.5}, ("0 < k < 1.01",)),
        ("(b - a)", {"a": 0.5, "b": 1}, ("a > 0", "b > 0")),
        ("(a - b)", {"a": 0.6, "b": 0.4}, ("a + b == 1", "a >= 0", "b >= 0")),
        ("k", {"k": 1}, ("k**2 >= 0.25",)),  # k <= -1/2 is admissible, too
    ],
)
def test_a_witness_is_admissible_and_names_the_parameters(factor, parameters, constraints):
    found = splitting(f"J**2 + {factor}*{WINSLOW}", parameters, *constraints)
    assert (found.holds, found.proof) == (False, "refuted")
    values = {str(variable): value for variable, value in found.witness}
    at = {name: values[name] for name in parameters}
    assert all(holds(constraint, at) for constraint in constraints)
    assert list(values)[: len(parameters)] == sorted(parameters)


def test_what_no_proof_is_known_for_is_sampled_at_admissible_values_only():
    found = splitting(f"J**2 + a*b*{WINSLOW}", {"a": 0.5, "b": 2}, "a*b > 0")
    assert (found.holds, found.proof) == (True, "sampled")


@pytest.mark.parametrize(
    ("parameters", "constraints"),
    [
        ({"k": 0.02}, ("k > 0",)),
        ({"k": 0.5}, ("0 < k < 1",)),
        ({"a": 0.2, "b": 0.3, "c": 0.5}, ("a >= 0", "b >= 0", "c >= 0", "a + b + c == 1")),
        ({"a": 0.5, "b": 2}, ("a*b == 1",)),
        ({"a": 0.6, "b": 0.8}, ("a**2 + b**2 == 1",)),  # cannot be solved linearly: both keep their defaults
        ({"a": 0.5, "b": 2, "c": 0}, ("1/(a + 1) > 0.1", "b >= a", "c**2 < 4")),
        ({}, ()),
    ],
)
def test_samples_are_admissible_and_spread(parameters, constraints):
    values = admissible(made("g11", parameters, *constraints)).sample(np.random.default_rng(0), 500)
    table = {str(parameter): row for parameter, row in values.items()}
    assert set(table) == set(parameters)
    for k in range(500):
        at = {name: float(row[k]) for name, row in table.items()}
        assert all(holds(constraint, at) for constraint in constraints)
    kept = {"a", "b"} if "a**2 + b**2 == 1" in constraints else set()
    for name, row in table.items():
        assert (np.ptp(row) > 0.1) == (name not in kept)


def test_values_beside_a_bound_and_far_from_it_are_met():
    k = admissible(made("g11", {"k": 0.02}, "k > 0")).sample(np.random.default_rng(0), 2000)
    (row,) = k.values()
    assert row.min() < 1e-3
    assert row.max() > 50


@pytest.mark.slow
def test_a_report_says_for_which_parameters_it_holds():
    text = derive_text(made("k*g11 + g22 + m*J", {"k": 2, "m": -1}, "k > 0"))
    assert "is positive semidefinite where J > 0 and k > 0; the density is polyconvex there (proved)." in text
    assert "Classification, where J > 0 and k = 2, m = -1\n" in text
    text = derive_text(made("g11 - k*g22", {"k": -1}, "k < 1"))
    assert "is not always positive semidefinite where J > 0 and k < 1; the density is not polyconvex there" in text
    assert re.search(r"Witness, at which P is not convex: k = 0\.\d+\.\n", text)
    assert "No constraint" not in text
    text = derive_text(made("g11 - k*g22", {"k": -1}))
    assert "No constraint keeps k from that value; with one, such as k > 0, it may hold." in text
    text = derive_text(functional("length"))
    assert "is positive semidefinite where J > 0; the density is polyconvex there (proved)." in text
    assert "Classification, where J > 0\n" in text
