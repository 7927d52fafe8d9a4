"""What several test modules share: the cases, random input, evaluation to 50 digits, and comparison."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from pathlib import Path

import mpmath
import numpy as np
import pytest
import sympy

from gridgen_sym.backends.numpy.loader import load_module
from gridgen_sym.codegen.backend import find_backend
from gridgen_sym.codegen.generate import committed_variants
from gridgen_sym.codegen.kernel import Kernel, Program, reciprocal
from gridgen_sym.codegen.programs import kernel
from gridgen_sym.functionals import Functional, functional, functionals, is_builtin, is_literature
from gridgen_sym.functionals.choices import CHOICES
from gridgen_sym.runtime import KernelSet, kernels

BUILTIN = [name for name in functionals(literature=False) if is_builtin(name)]
#: Functionals of the literature: no kernel of theirs is committed, and deriving all of them takes a minute.
LITERATURE = [name for name in functionals() if is_literature(name)]
#: Every functional in every variant whose kernels are committed.
COMMITTED = [(name, variant) for name in BUILTIN for variant in committed_variants(functional(name))]
#: Weighted variants of functionals that do not name the weight: they are derived when first used.
DERIVED = [(name, variant) for name in ("winslow", "knupp") for variant in ("frozen", "differentiated")]
CASES = COMMITTED + DERIVED
#: The main tier has every functional plain, and one of every other variant; the slow tier has the rest.
MAIN_VARIANTS = {("area_winslow", "frozen"), ("area", "differentiated"), ("winslow", "regularized")}
#: Those that have Euler-Lagrange equations.
EQUATION_CASES = [case for case in CASES if "regularized" not in case[1]]

#: Domains that are not part of the repository; the tests that read them are skipped where there are none.
SHARED = Path(os.environ.get("GRIDGEN_SYM_SHARED") or Path(__file__).resolve().parents[2] / "shared")
NO_SHARED = f"no {{}} in {SHARED}: set GRIDGEN_SYM_SHARED to the folder of shared domains"

EPSILON = 0.3
#: How far 50-digit numbers are from each other where two formulas mean the same.
SAME = mpmath.mpf(10) ** -35


def case_name(case: object) -> str | None:
    """Name a parametrized (functional, variant) pair."""
    return "-".join(case) if isinstance(case, tuple) else None


def tiered(cases: Iterable[tuple[str, str]]) -> list[object]:
    """Return cases to parametrize with, those of the slow tier marked."""
    main = {(name, "plain") for name in BUILTIN} | MAIN_VARIANTS
    return [case if case in main else pytest.param(case, marks=pytest.mark.slow) for case in cases]


@cache
def derived_kernel(name: str | Functional, variant: str) -> Kernel:
    return kernel(functional(name), variant)


def rendered(name: str | Functional, variant: str, backend: str) -> str:
    """Return the source of a kernel as it is printed now."""
    return find_backend(backend).render(derived_kernel(name, variant))


@cache
def numpy_names(name: str | Functional, variant: str) -> dict[str, object]:
    """Return the names of the freshly rendered NumPy module."""
    return load_module("rendered.py", rendered(name, variant, "numpy"))


def kernel_set(name: str | Functional, variant: str = "plain", backend: str = "numpy") -> KernelSet:
    parameters = {"epsilon": EPSILON} if "regularized" in variant else None
    return kernels(functional(name), variant, parameters, backend)


# ---- exact evaluation ----


def evaluate(node: sympy.Basic, values: Mapping[str, mpmath.mpf]) -> mpmath.mpf:
    """Evaluate an expression by its tree, in mpmath's working precision."""
    if node.is_Symbol:
        return values[node.name]
    if node.is_Rational:
        return mpmath.mpf(node.p) / node.q
    if node in (sympy.pi, sympy.E):
        return +(mpmath.pi if node == sympy.pi else mpmath.e)
    if isinstance(node, sympy.DiracDelta):
        return mpmath.mpf(0)
    if isinstance(node, CHOICES):
        left, right, first, second = node.as_choice().args
        return evaluate(first if evaluate(left, values) < evaluate(right, values) else second, values)
    arguments = [evaluate(argument, values) for argument in node.args]
    if node.is_Add:
        return mpmath.fsum(arguments)
    if node.is_Mul:
        return mpmath.fprod(arguments)
    if node.is_Pow:
        return mpmath.power(*arguments)
    if isinstance(node, reciprocal):
        return 1 / arguments[0]
    names = {"Abs": "fabs"}
    return getattr(mpmath, names.get(type(node).__name__, type(node).__name__))(*arguments)


def run(program: Program, values: Mapping[str, mpmath.mpf]) -> dict[str, mpmath.mpf]:
    """Carry out a program's assignments and return its outputs."""
    known = dict(values)
    for assignment in program.assignments:
        known[assignment.name] = evaluate(assignment.value, known)
    return {name: known[name] for name in program.outputs}


def metric_values(values: Mapping[str, mpmath.mpf]) -> dict[str, mpmath.mpf]:
    """Return the values with those of the metric added, from the definitions of a textbook."""
    a, b, c, d = (values[name] for name in ("x_xi", "y_xi", "x_eta", "y_eta"))
    metric = _metric(a, b, c, d, values)
    if "V11" in values:
        v11, v12, v21, v22 = (values[name] for name in ("V11", "V12", "V21", "V22"))
        relative = a * v11 + c * v21, b * v11 + d * v21, a * v12 + c * v22, b * v12 + d * v22
        named = dict(zip(("x_xi", "y_xi", "x_eta", "y_eta"), relative, strict=True)) | _metric(*relative, values)
        metric |= {f"target_{name}": value for name, value in named.items()}
    return dict(values) | metric


def _metric(
    a: mpmath.mpf, b: mpmath.mpf, c: mpmath.mpf, d: mpmath.mpf, values: Mapping[str, mpmath.mpf]
) -> dict[str, mpmath.mpf]:
    metric = {"g11": a * a + b * b, "g22": c * c + d * d, "g12": a * c + b * d, "J": a * d - b * c}
    if "epsilon" in values:
        root = mpmath.sqrt(metric["J"] ** 2 + values["epsilon"] ** 2)
        metric |= {"root": root, "chi": (metric["J"] + root) / 2}
    return metric


def parameter_values(definition: Functional, variant: str) -> dict[str, mpmath.mpf]:
    extra = {"epsilon": EPSILON} if "regularized" in variant else {}
    return {name: mpmath.mpf(value) for name, value in (dict(definition.parameters) | extra).items()}


def random_values(
    names: Iterable[str], parameters: Mapping[str, mpmath.mpf], seed: int, *, folded: bool = False
) -> dict[str, mpmath.mpf]:
    """Return random values of a program's inputs, and of the parameters under both of their names.

    The first derivatives have J > 0, or J < 0 with `folded`; the weight and the determinant of a target are positive.
    """
    generator = np.random.default_rng(seed)
    values = {name: mpmath.mpf(float(generator.uniform(-1, 1))) for name in names}
    x_xi, y_xi = generator.uniform(0.7, 1.5), generator.uniform(-0.4, 0.4)
    x_eta, y_eta = generator.uniform(-0.4, 0.4), generator.uniform(0.7, 1.5) * (-1 if folded else 1)
    given = {"x_xi": x_xi, "y_xi": y_xi, "x_eta": x_eta, "y_eta": y_eta, "s": generator.uniform(0.5, 2)}
    given |= {"V11": generator.uniform(0.5, 2), "V22": generator.uniform(0.5, 2)}
    given |= {"V12": generator.uniform(-0.4, 0.4), "V21": generator.uniform(-0.4, 0.4)}
    values |= {name: mpmath.mpf(float(value)) for name, value in given.items() if name in values}
    return values | dict(parameters) | {f"parameter_{name}": value for name, value in parameters.items()}


def moved_weight(values: Mapping[str, mpmath.mpf], dx: mpmath.mpf, dy: mpmath.mpf) -> dict[str, mpmath.mpf]:
    """Return the values after a move of the point by (dx, dy), the weight being a quadratic function of the place."""
    v = values
    return dict(values) | {
        "s": v["s"] + v["s_x"] * dx + v["s_y"] * dy
        + (v["s_xx"] * dx * dx + 2 * v["s_xy"] * dx * dy + v["s_yy"] * dy * dy) / 2,
        "s_x": v["s_x"] + v["s_xx"] * dx + v["s_xy"] * dy,
        "s_y": v["s_y"] + v["s_xy"] * dx + v["s_yy"] * dy,
    }  # fmt: skip


def slopes(
    program: Program, values: Mapping[str, mpmath.mpf], move: Callable[[mpmath.mpf], Mapping[str, mpmath.mpf]]
) -> dict[str, mpmath.mpf]:
    """Return central differences of a program's outputs along a move; good to 20 digits at 50."""
    step = mpmath.mpf(10) ** -12
    ahead, behind = run(program, move(step)), run(program, move(-step))
    return {name: (ahead[name] - behind[name]) / (2 * step) for name in program.outputs}


def moved(values: Mapping[str, mpmath.mpf], name: str) -> Callable[[mpmath.mpf], Mapping[str, mpmath.mpf]]:
    """Return the move that adds to one input, or (for `x` and `y`) moves the point under its weight."""
    if name in ("x", "y"):
        return lambda step: moved_weight(values, step * (name == "x"), step * (name == "y"))
    return lambda step: dict(values) | {name: values[name] + step}


def close(value: mpmath.mpf, expected: mpmath.mpf, tolerance: mpmath.mpf, scale: mpmath.mpf | float = 1) -> bool:
    return abs(value - expected) <= tolerance * max(abs(expected), scale)


# ---- arrays ----


def relative_difference(value: object, expected: object) -> float:
    """Return the largest difference over the largest expected value; not a number where either is not finite."""
    value, expected = np.asarray(value, dtype=float), np.asarray(expected, dtype=float)
    scale = np.max(np.abs(expected), initial=0.0)
    return float(np.max(np.abs(value - expected), initial=0.0) / (scale or 1.0))


def random_grid(ni: int, nj: int, seed: int = 0, noise: float = 0.1) -> np.ndarray:
    """Return unit cells with normally distributed noise in every node, as planes (2, ni, nj)."""
    grid = np.stack(np.meshgrid(np.arange(ni), np.arange(nj), indexing="ij")).astype(float)
    return grid + noise * np.random.default_rng(seed).normal(size=grid.shape)


def random_weight(planes: int, ni: int, nj: int, seed: int = 1) -> np.ndarray | None:
    return np.random.default_rng(seed).uniform(0.5, 2.0, size=(planes, ni, nj)) if planes else None


#: Planes of the stored half of the Hessian: the other node of the block, and its first plane.
HESSIAN_BLOCKS = (((0, 0), 0), ((1, 0), 3), ((0, 1), 7), ((1, 1), 11), ((1, -1), 15))


def dense_hessian(planes: np.ndarray) -> np.ndarray:
    """Assemble the stored half of a block Hessian to a symmetric matrix over (component, i, j)."""
    _, ni, nj = planes.shape
    matrix = np.zeros((2, ni, nj, 2, ni, nj))
    for (along_i, along_j), first in HESSIAN_BLOCKS:
        for i in range(ni):
            for j in range(nj):
                p, q = i + along_i, j + along_j
                inside = p < ni and 0 <= q < nj
                block = planes[first : first + (3 if first == 0 else 4), i, j]
                if not inside:
                    assert not block.any(), "a block with a node outside of the grid must be zero"
                    continue
                entries = block[[0, 1, 1, 2]].reshape(2, 2) if first == 0 else block.reshape(2, 2)
                matrix[:, i, j, :, p, q] = entries
                matrix[:, p, q, :, i, j] = entries.T
    return matrix.reshape(2 * ni * nj, 2 * ni * nj)


def observed_order(coarse: float, fine: float) -> float:
    """Return the order of convergence from the errors at h and h/2."""
    return math.log2(coarse / fine)
