"""Mixed derivatives of the energy, in the nodes and in what a density is given, against differences of the gradient."""

from __future__ import annotations

import numpy as np
import pytest

from gridgen_sym import Functional, functional
from gridgen_sym.functionals.variant import Modes
from gridgen_sym.runtime import KernelSet, Values, kernels

ODD = Functional(
    "odd_mixed",
    "p*(g11 + k*g22)**2/J + s*J**2*exp(k*M12) + M11*g11 + M22*g22*y + xi*J**2 + sqrt(g11)*x_eta",
    parameters={"k": 1.5},
    fields={"p": "scalar", "M": "symmetric"},
)
CASES = [
    (functional("winslow"), "target"),
    (functional("area"), "differentiated"),
    (ODD, "frozen+M:differentiated"),
    (ODD, "differentiated+target"),
]
_SHAPE, _STEPS = (5, 6), (0.25, 0.2)


def case_name(case: object) -> str:
    return case.name if isinstance(case, Functional) else str(case)


def setting(one: Functional, variant: str, backend: str) -> tuple[KernelSet, KernelSet, np.ndarray, np.ndarray]:
    """Return kernels, those of mixed derivatives, coordinates and values per corner (planes, 4, ni-1, nj-1)."""
    random = np.random.default_rng(3)
    place = np.stack(np.meshgrid(*(np.linspace(0, 1, n) for n in _SHAPE), indexing="ij"))
    place = place + 0.04 * random.standard_normal(place.shape)
    mixed_variant = Modes.ordered(f"{variant}+mixed").variant
    plain, mixed = (kernels(one, v, backend=backend) for v in (variant, mixed_variant))
    values = 0.1 * random.standard_normal((len(plain.planes), 4, _SHAPE[0] - 1, _SHAPE[1] - 1))
    for name, plane in zip(plain.planes, values, strict=True):
        plane += name not in ("V12", "V21")
    return plain, mixed, place, values


@pytest.mark.parametrize("interior_only", [False, True])
@pytest.mark.parametrize("backend", ["c", "numpy"])
@pytest.mark.parametrize(
    ("one", "variant"), [CASES[0], *(pytest.param(*case, marks=pytest.mark.slow) for case in CASES[1:])], ids=case_name
)
def test_mixed_derivatives_are_those_of_the_gradient(one, variant, backend, interior_only):
    """At every corner, for every plane and parameter, to the accuracy of central differences of the sixth order."""
    plain, mixed, place, values = setting(one, variant, backend)
    random = np.random.default_rng(4)
    vector = random.standard_normal(place.shape)
    at = Values.of(values, _SHAPE)
    found = mixed.mixed(place, vector, at, _STEPS, interior_only=interior_only)
    # Corners of `Values.of` are counter-clockwise, those of kernels are not.
    found = found[:, [0, 1, 3, 2]]
    along = random.standard_normal(found.shape)
    along[len(plain.planes) :] = along[len(plain.planes) :, :1, :1, :1]
    changes = along[: len(plain.planes)].copy()
    for k, name in enumerate(plain.planes):
        if name in ("x", "y", "xi", "eta") or name.endswith(("_xx", "_xy", "_yy")):
            changes[k] = 0
    names = tuple(one.parameters)

    def slope(t: float) -> float:
        moved = {n: v + t * along[len(plain.planes) + k, 0, 0, 0] for k, (n, v) in enumerate(one.parameters.items())}
        kernel = kernels(one, variant, {n: moved[n] for n in names}, backend)
        there = Values.of(values + t * changes, _SHAPE)
        return float((kernel.energy_gradient(place, there, _STEPS, interior_only=interior_only)[2] * vector).sum())

    h = 1e-3
    weights = ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60))
    expected = sum(w * (slope(k * h) - slope(-k * h)) for k, w in weights) / h
    got = (found[: len(plain.planes)] * changes).sum() + (found[len(plain.planes) :] * along[len(plain.planes) :]).sum()
    assert got == pytest.approx(expected, rel=1e-9)
