"""Control functions of the elliptic generator: known answers, every form, refusals."""

from __future__ import annotations

import numpy as np
import pytest
from support import kernel_set, observed_order, random_grid

import gridgen_sym as gg
from gridgen_sym.solvers.equations.control import thomas_middlecoff

#: x = X(xi) and y = Y(eta) on a rectangle, with X''/X' = 2 and Y''/Y' = -1.5.
P, Q = -2.0, 1.5


def rectangle(ni, nj):
    xi, eta = np.meshgrid(np.linspace(0, 1, ni), np.linspace(0, 1, nj), indexing="ij")
    return np.stack([2 * np.expm1(2 * xi) / np.expm1(2), np.expm1(-1.5 * eta) / np.expm1(-1.5)])


def disturbed(planes):
    moved = planes.copy()
    moved[:, 1:-1, 1:-1] += 0.003 * np.random.default_rng(0).normal(size=moved[:, 1:-1, 1:-1].shape)
    return gg.Grid.from_planes(*moved)


def solved(planes, control, functional="winslow", method="newton", **options):
    result = gg.solve_euler_lagrange(
        disturbed(planes), functional, method, control=control, tolerance=1e-11, progress=False, **options
    )
    assert result.converged, result.message
    return result.grid.planes


@pytest.mark.parametrize("method", ["newton", "relaxation"])
def test_the_spacing_of_the_boundary_is_carried_inwards(method):
    """On a rectangle the discrete solution is the product of its sides, to round-off."""
    planes = rectangle(13, 17)
    assert np.abs(solved(planes, "thomas-middlecoff", method=method) - planes).max() < 1e-10
    plain = gg.solve_euler_lagrange(disturbed(planes), "winslow", progress=False).grid.planes
    assert np.abs(plain - planes).max() > 0.1


def test_given_control_functions_are_met_at_second_order():
    errors = [np.abs(solved(rectangle(n, n), (P, Q)) - rectangle(n, n)).max() for n in (11, 21)]
    assert observed_order(*errors) > 1.9
    assert np.abs(solved(rectangle(21, 21), (-P, Q)) - rectangle(21, 21)).max() > 0.1


def test_control_functions_come_in_every_form():
    planes = rectangle(9, 12)
    expected = solved(planes, (lambda xi, eta: P + 0 * xi * eta, "1.5 + 0*xi"))
    assert np.abs(solved(planes, (P, Q)) - expected).max() < 1e-9
    assert np.abs(solved(planes, (np.full((9, 12), P), str(Q))) - expected).max() < 1e-9
    index = P / 8, Q / 11
    assert np.abs(solved(planes, index, spacing="index") - expected).max() < 1e-9


def test_the_kernel_is_the_textbooks_generator():
    x, y = random_grid(6, 7)
    planes = np.stack([np.sin(x), np.cos(y)])
    found = kernel_set("winslow", "control").euler_lagrange_residual(np.stack([x, y]), planes, (0.5, 0.25))
    for r, part in zip((x, y), found, strict=True):
        assert np.allclose(part[1:-1, 1:-1], generator(r, x, y, planes, 0.5, 0.25), rtol=1e-12, atol=1e-10)


def generator(r, x, y, control, h, k):
    def along(z):
        return (z[2:, 1:-1] - z[:-2, 1:-1]) / (2 * h), (z[1:-1, 2:] - z[1:-1, :-2]) / (2 * k)

    (x_xi, x_eta), (y_xi, y_eta), (r_xi, r_eta) = map(along, (x, y, r))
    g11, g22, g12 = x_xi**2 + y_xi**2, x_eta**2 + y_eta**2, x_xi * x_eta + y_xi * y_eta
    inner = r[1:-1, 1:-1]
    r_xixi = (r[2:, 1:-1] - 2 * inner + r[:-2, 1:-1]) / h**2
    r_etaeta = (r[1:-1, 2:] - 2 * inner + r[1:-1, :-2]) / k**2
    r_xieta = (r[2:, 2:] - r[2:, :-2] - r[:-2, 2:] + r[:-2, :-2]) / (4 * h * k)
    p, q = control[:, 1:-1, 1:-1]
    return g22 * (r_xixi + p * r_xi) - 2 * g12 * r_xieta + g11 * (r_etaeta + q * r_eta)


@pytest.mark.slow
def test_the_functional_of_thomas_and_middlecoff_gives_the_same_grid():
    """Fields p = X' and q = Y' in the density, and the control functions -p'/p and -q'/q in the equations."""
    fields = {"p": "scalar", "q": "scalar"}
    own = gg.define("own_stretched", "(g11*q**2 + g22*p**2)/J", fields=fields, replace=True)
    values = {"p": gg.Field("exp(2*xi)", domain="logical"), "q": gg.Field("exp(-1.5*eta)", domain="logical")}
    errors = []
    for n in (11, 21):
        planes = rectangle(n, n)
        found = gg.solve_euler_lagrange(disturbed(planes), own, fields=values, tolerance=1e-11, progress=False)
        assert found.converged
        errors.append(np.abs(found.grid.planes - solved(planes, (P, Q))).max())
    assert observed_order(*errors) > 1.8


@pytest.mark.parametrize(
    ("control", "functional", "message"),
    [
        ("laplace", "winslow", "control must be two functions (P, Q)"),
        ((1,), "winslow", "control must be two functions (P, Q)"),
        (3.0, "winslow", "control must be two functions (P, Q)"),
        (("x", 0), "winslow", "the control P: unknown name 'x'"),
        ((0, np.zeros((3, 3))), "winslow", "the control Q must have one value per node"),
        ((0, "log(xi - 2)"), "winslow", "the control Q must be finite"),
        ((0, 0), "knupp", "those of 'knupp' are not"),
    ],
)
def test_what_is_no_control_is_refused(control, functional, message):
    with pytest.raises(gg.GridgenError) as error:
        gg.solve_euler_lagrange(disturbed(rectangle(5, 6)), functional, control=control, progress=False)
    assert message in str(error.value)


def test_sides_whose_nodes_coincide_are_refused():
    planes = rectangle(6, 6)
    planes[:, 2:5, 0] = planes[:, 2:3, 0]
    with pytest.raises(gg.GridgenError, match="boundary nodes in different places"):
        thomas_middlecoff(planes, (0.2, 0.2))
