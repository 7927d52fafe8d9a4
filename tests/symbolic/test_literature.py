"""Functionals of the literature against independent statements: matrix formulas, known minima, relations, sources."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
import sympy
from support import BUILTIN, LITERATURE

import gridgen_sym as gg
from gridgen_sym.codegen.generate import all_sources
from gridgen_sym.functionals import functional, is_builtin
from gridgen_sym.functionals.bibliography import REFERENCES, short
from gridgen_sym.functionals.check import check_density
from gridgen_sym.functionals.registry import literature, literature_sources
from gridgen_sym.selfcheck import checks

IDENTITY, E1, E2 = np.eye(2), np.array([1.0, 0.0]), np.array([0.0, 1.0])
#: Jacobian matrices with positive determinant, of all sizes.
MATRICES = [a if np.linalg.det(a) > 0 else a[:, ::-1] for a in np.random.default_rng(1).normal(size=(40, 2, 2))]


def value(name, a, **others):
    """Return the density at a Jacobian matrix, whose columns are the edge vectors."""
    definition = functional(name)
    (x_xi, x_eta), (y_xi, y_eta) = a
    g11, g22, g12 = a[:, 0] @ a[:, 0], a[:, 1] @ a[:, 1], a[:, 0] @ a[:, 1]
    known = {"x_xi": x_xi, "x_eta": x_eta, "y_xi": y_xi, "y_eta": y_eta, "g11": g11, "g22": g22, "g12": g12, "s": 1.0}
    known |= {"J": np.linalg.det(a), "t11": g11, "t22": g22, "t12": g12, "tau": np.linalg.det(a)}
    known |= dict(definition.parameters) | others
    density = evaluator(name)
    return float(density(*(known[str(v)] for v in sorted(definition.expression().free_symbols, key=str))))


_evaluators = {}


def evaluator(name):
    if name not in _evaluators:
        expression = functional(name).expression()
        _evaluators[name] = sympy.lambdify(sorted(expression.free_symbols, key=str), expression, "numpy")
    return _evaluators[name]


def turned(angle):
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def norm2(a):
    return float(np.sum(a * a))


def size(t):
    return np.linalg.det(t)


def inverse_transpose(t):
    return np.linalg.inv(t).T


def stretches(t):
    return np.linalg.svd(t, compute_uv=False)


def rotation_of(t):
    """Return the rotation of the polar decomposition."""
    u, _, v = np.linalg.svd(t)
    return u @ v


def oddy(t):
    c = t.T @ t
    return (norm2(c) - np.trace(c) ** 2 / 2) / size(t) ** 2


def sine(t):
    return size(t) / np.prod(np.linalg.norm(t, axis=0))


#: The same by matrices: norms, inverses, singular values.
BY_MATRICES = {
    "tmop_1": norm2,
    "tmop_2": lambda t: norm2(t) / (2 * size(t)) - 1,
    "tmop_7": lambda t: norm2(t - inverse_transpose(t)),
    "tmop_9": lambda t: size(t) * norm2(t - inverse_transpose(t)),
    "tmop_14": lambda t: norm2(t - IDENTITY),
    "tmop_50": oddy,
    "tmop_55": lambda t: (size(t) - 1) ** 2,
    "tmop_56": lambda t: (np.sqrt(size(t)) - 1 / np.sqrt(size(t))) ** 2 / 2,
    "tmop_58": lambda t: norm2(t.T @ t) / size(t) ** 2 - 2 * norm2(t) / size(t) + 2,
    "tmop_77": lambda t: (size(t) - 1 / size(t)) ** 2 / 2,
    "tmop_80": lambda t: (norm2(t) / (2 * size(t)) - 1) / 2 + (size(t) - 1 / size(t)) ** 2 / 4,
    "tmop_85": lambda t: norm2(t - np.sqrt(norm2(t) / 2) * IDENTITY),
    "tmop_98": lambda t: norm2(t - IDENTITY) / size(t),
    "knupp_shape": lambda t: (np.linalg.cond(t, "fro") / 2) ** 2,
    "knupp_size": lambda t: max(size(t), 1 / size(t)) ** 2,
    "knupp_skew": lambda t: 1 / sine(t) ** 2,
    "knupp_orientation": lambda t: 1 - np.trace(rotation_of(t)) / 2,
    "garanzha": lambda t: 0.8 * np.linalg.cond(t, "fro") / 2 + 0.2 * (size(t) + 1 / size(t)) / 2,
    "jacquotte": lambda t: (stretches(t)[0] - stretches(t)[1]) ** 2 + (size(t) - 1) ** 2,
    "neo_hookean": lambda t: (norm2(t) - 2) / 2 - np.log(size(t)) + np.log(size(t)) ** 2 / 2,
    "brackbill_saltzman": lambda a: (
        norm2(np.linalg.inv(a)) * size(a)
        + size(a) ** 2
        + (np.linalg.inv(a)[0] @ np.linalg.inv(a)[1]) ** 2 * size(a) ** 4
    ),
    "near_orthogonal": lambda a: np.sqrt(0.997 / sine(a) ** 2 + 0.003 * (np.linalg.cond(a, "fro") / 2) ** 2) - 1,
    "unam_area": lambda a: 1 / (0.01 + size(a)),
    "quasi_harmonic": lambda a: (norm2(a) - 2 * size(a)) / (0.01 + size(a)),
    "epsilon_area": lambda a: max(0.0, 0.1 - size(a)) ** 2,
    "bilateral_area": lambda a: 1 / size(a) + size(a) ** 2,
}


@pytest.mark.parametrize("name", BY_MATRICES)
def test_a_density_is_the_formula_of_its_paper_in_matrices(name):
    for a in MATRICES:
        assert value(name, a) == pytest.approx(BY_MATRICES[name](a), rel=1e-9, abs=1e-12)


SCALED, TURNED, SHEARED = 1.7 * IDENTITY, turned(0.8), np.array([[1.0, 0.6], [0.0, 1.0]])
#: The least value, and matrices of the target's class at which it is attained.
MINIMA = {
    "tmop_2": (0, [SCALED, TURNED, 0.3 * TURNED]),
    "tmop_50": (0, [SCALED, TURNED, 0.3 * TURNED]),
    "tmop_58": (0, [SCALED, TURNED, 0.3 * TURNED]),
    "knupp_shape": (1, [SCALED, TURNED, 0.3 * TURNED]),
    "knupp_skew": (1, [SCALED, TURNED, TURNED @ np.diag([2, 3])]),
    "near_orthogonal": (0, [SCALED, TURNED, 0.3 * TURNED]),
    "tmop_55": (0, [TURNED, SHEARED, np.diag([2, 0.5])]),
    "tmop_56": (0, [TURNED, SHEARED, np.diag([2, 0.5])]),
    "tmop_77": (0, [TURNED, SHEARED, np.diag([2, 0.5])]),
    "knupp_size": (1, [TURNED, SHEARED, np.diag([2, 0.5])]),
    "tmop_7": (0, [TURNED]),
    "tmop_9": (0, [TURNED]),
    "tmop_80": (0, [TURNED]),
    "garanzha": (1, [TURNED]),
    "jacquotte": (0, [TURNED]),
    "neo_hookean": (0, [TURNED]),
    "tmop_14": (0, [IDENTITY]),
    "tmop_98": (0, [IDENTITY]),
    "tmop_85": (0, [SCALED]),
    "knupp_orientation": (0, [SCALED, np.array([[2, 0.3], [0.3, 1]])]),
}


@pytest.mark.parametrize("name", MINIMA)
def test_known_minima(name):
    least, places = MINIMA[name]
    assert min(value(name, a) for a in MATRICES) > least
    for a in places:
        assert value(name, a) == pytest.approx(least, abs=1e-14)


def metric_of(m):
    return {"M11": m[0, 0], "M12": m[0, 1], "M22": m[1, 1]}


def test_harmonic_maps_and_monitors():
    f = np.array([0.7, -0.4])
    m = np.array([[1.5, 0.4], [0.4, 0.8]])
    scalar = 1.8 * IDENTITY
    for a in MATRICES:
        inverse = np.linalg.inv(a.T @ m @ a)  # grad xi . M⁻¹ grad xi and so on
        volume = np.sqrt(np.linalg.det(m)) * size(a)
        winslow = value("winslow", a)
        assert value("dvinsky", a, **metric_of(m)) == pytest.approx(np.trace(inverse) * volume)
        assert value("dvinsky", a, **metric_of(scalar)) == pytest.approx(winslow)
        surface = metric_of(IDENTITY + np.outer(f, f))
        assert value("harmonic_surface", a, f1=f[0], f2=f[1]) == pytest.approx(value("dvinsky", a, **surface))
        assert value("winslow_tensor", a, **metric_of(m)) == pytest.approx(np.trace(inverse) * size(a))
        assert value("winslow_tensor", a, **metric_of(scalar)) == pytest.approx(value("winslow_diffusion", a, s=1.8))
        theta = 1 / 3
        huang = theta * np.trace(inverse) ** 2 * volume + (1 - 2 * theta) * 4 / volume
        assert value("huang", a, **metric_of(m)) == pytest.approx(huang)
        # At a given volume it is least where the cell is uniform in M.
        uniform = np.linalg.inv(np.linalg.cholesky(m)).T * np.sqrt(volume)
        assert value("huang", uniform, **metric_of(m)) <= value("huang", a, **metric_of(m)) * (1 + 1e-12)
        assert value("riemannian_length", a, **metric_of(m)) == pytest.approx(np.trace(a.T @ m @ a) / 2)


def test_control_functions_directions_and_references():
    p, q, k = 1.3, 0.6, 1.0
    b = MATRICES[0]
    for a in MATRICES:
        stretched = a @ np.linalg.inv(np.diag([p, q]))
        expected = value("winslow", stretched) * p * q
        assert value("thomas_middlecoff", a, p=p, q=q) == pytest.approx(expected)
        along = value("winslow", a) + k * size(a) * (np.linalg.inv(a)[0] @ [0.4, 0.9]) ** 2
        assert value("brackbill_direction", a, B1=0.4, B2=0.9) == pytest.approx(along)
        parts = dict(zip(("B11", "B12", "B21", "B22"), b.ravel(), strict=True))
        assert value("reference_jacobian", a, **parts) == pytest.approx(norm2(a - b) * size(b) / size(a))
        assert value("area_at_corners", a, S=1.5) == pytest.approx(value("area", a, s=1.5))
        equal = value("steinberg_roache", a, phi=1, psi=1, k_L=0.2, k_A=0.5, k_O=0.3)
        assert equal == pytest.approx(
            0.2 * value("length", a) + 0.5 * value("area", a) + 0.3 * value("orthogonality", a)
        )


@pytest.mark.slow
def test_the_check_of_one_with_two_branches_passes():
    assert [one.text for one in checks(functional("knupp_size")) if not one.passed] == []


# ---- the registry ----


def test_there_are_thirty_and_more_and_all_can_be_derived():
    assert len(LITERATURE) >= 30
    assert not set(LITERATURE) & set(BUILTIN)
    for name in LITERATURE:
        assert is_builtin(name)
        assert name in gg.functionals()
        definition = functional(name)
        check_density(definition)
        definition.values(definition.parameters)
        assert definition.description
        assert len(literature_sources(name)) == definition.reference.count("; ") + 1


def test_a_name_of_the_literature_is_taken():
    with pytest.raises(gg.GridgenError, match="a functional named 'dvinsky' exists"):
        gg.define("dvinsky", "J**2")


def test_an_unknown_source_is_an_error_at_once():
    with pytest.raises(KeyError):
        literature("nobody1900")(lambda m: m.J)


def test_sources_are_one_line_each():
    assert short("knupp2001") == "Knupp, SIAM Journal on Scientific Computing 23 (2001)"
    assert short("winslow1981") == "Winslow, Report UCID-19062, Lawrence Livermore National Laboratory (1981)"
    assert short("barrera2009").startswith("Barrera-Sánchez, González-Flores, Domínguez-Mota and Tinoco-Ruiz, ")
    assert not [key for key in REFERENCES if set("{}\\") & set(short(key))]


def test_no_kernel_of_the_literature_is_committed(monkeypatch):
    import gridgen_sym.codegen.generate as generate

    seen = []
    monkeypatch.setattr(generate, "sources", lambda one, variants: seen.append(one.name) or [])
    monkeypatch.setattr(generate, "report_text", lambda one: "")
    list(all_sources())
    assert seen == BUILTIN


def test_the_list_of_functionals_loads_no_symbolic_package():
    told = subprocess.run(
        [sys.executable, "-c", "import sys, gridgen_sym as gg; gg.functionals(); print('sympy' in sys.modules)"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert told.stdout.strip() == "False"
