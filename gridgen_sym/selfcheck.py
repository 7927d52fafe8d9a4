"""Check the derivatives, equations and kernels of one functional, with the weight 1, against other computations.

Corner derivatives and Euler–Lagrange equations against differences of the bare formula in 80-digit arithmetic; the
compiled kernels against NumPy's; the Hessian kernel against differences of the gradient kernel; and the discrete
gradient against the Euler–Lagrange residual, to which it must tend at second order. Weights stand at 1.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from .functionals import Functional
from .runtime import Array, KernelSet, find_compiler, kernels

_DIGITS = 80
#: Steps of differences: of arithmetic with so many digits, and of double precision.
_STEP, _DOUBLE_STEP = "1e-16", 1e-5
_CORNERS = 5
_SIZE = (9, 70)
_COARSE, _FINE = 16, 32
_FIRST = ("x_xi", "y_xi", "x_eta", "y_eta")
_SECOND = ("x_xixi", "x_xieta", "x_etaeta", "y_xixi", "y_xieta", "y_etaeta")

Numbers = Mapping[str, Any]
Formula = Callable[[Numbers], Any]


@dataclass(frozen=True, slots=True)
class Check:
    """The outcome of one check.

    Attributes:
        name: what was compared.
        measured: the number that decides: a relative difference, or an order of convergence.
        limit: what it must not exceed, or must reach.
        passed: whether it does.
        text: one line.
    """

    name: str
    measured: float
    limit: float
    passed: bool
    text: str


def checks(functional: Functional) -> Iterator[Check]:
    """Yield the checks of a functional one by one, as they are done."""
    yield from _corner_derivatives(functional)
    yield _euler_lagrange(functional)
    yield _hessian_kernel(functional)
    yield _backends(functional)
    yield _limit(functional)


def _difference(name: str, measured: float, limit: float) -> Check:
    """Return a check of a relative difference; one that is not a number fails."""
    return Check(name, measured, limit, measured <= limit, f"{name}: {measured:.1e} (at most {limit:.0e})")


# ---- in many digits ----


def _density(functional: Functional) -> Formula:
    """Return the bare density as a function of numbers by name; the metric is computed from its definition."""
    import sympy

    expression = functional.expression()
    names = sorted(str(name) for name in expression.free_symbols)
    evaluate = sympy.lambdify([sympy.Symbol(name, real=True) for name in names], expression, "mpmath")

    def density(values: Numbers) -> Any:  # noqa: ANN401
        a, b, c, d = (values[name] for name in _FIRST)
        metric = {"g11": a * a + b * b, "g22": c * c + d * d, "g12": a * c + b * d, "J": a * d - b * c, "s": 1}
        known = {**_parameters(functional), **values, **metric}
        return evaluate(*(known[name] for name in names))

    return density


def _derived(expressions: list[Any], functional: Functional) -> Formula:
    """Return derived expressions as a function of numbers by name."""
    import sympy

    from .symbolic.coordinates import expand_metric, s

    written = [expand_metric(part).subs(s, 1) for part in expressions]
    # The second derivative of abs() is zero but at one point, which random numbers do not meet.
    written = [part.replace(sympy.DiracDelta, lambda *_: sympy.S.Zero) for part in written]
    names = [*_FIRST, *_SECOND, *functional.parameters]
    evaluate = sympy.lambdify([sympy.Symbol(name, real=True) for name in names], written, "mpmath")
    return lambda values: evaluate(*({**_parameters(functional), **values}[name] for name in names))


def _parameters(functional: Functional) -> dict[str, Any]:
    """Return the default values with all digits; products of floats would be rounded."""
    from mpmath import mpf  # type: ignore[import-untyped]

    return {name: mpf(value) for name, value in functional.parameters.items()}


def _random_jets(count: int) -> list[dict[str, Any]]:
    """Return derivatives of maps, first and second, with J > 0."""
    from mpmath import mpf

    generator = np.random.default_rng(20)
    jets = []
    for _ in range(count):
        first = np.array([1.0, 0.0, 0.0, 1.0]) + generator.uniform(-0.3, 0.3, 4)
        values = zip((*_FIRST, *_SECOND), (*first, *generator.uniform(-1, 1, 6)), strict=True)
        jets.append({name: mpf(float(value)) for name, value in values})
    return jets


def _slope(function: Formula, values: Numbers, move: Numbers) -> Any:  # noqa: ANN401
    """Return the central difference of a function along a move, given as changes of numbers by name."""
    from mpmath import mpf

    h = mpf(_STEP)
    ahead, behind = ({**values, **{k: values[k] + sign * h * change for k, change in move.items()}} for sign in (1, -1))
    return (function(ahead) - function(behind)) / (2 * h)


def _relative(found: list[Any], expected: list[Any]) -> float:
    """Return the largest difference over the largest expected number."""
    scale = max(abs(value) for value in expected)
    error = max(abs(a - b) for a, b in zip(found, expected, strict=True))
    return float(error / scale if scale else error)


def _corner_derivatives(functional: Functional) -> Iterator[Check]:
    """Compare the derived gradient and Hessian of a corner with differences."""
    import mpmath

    from .symbolic import corner_model

    model, density = corner_model(functional), _density(functional)
    gradient, hessian = (_derived(list(part), functional) for part in (model.gradient, model.hessian))

    def energy(values: Numbers) -> Any:  # noqa: ANN401
        return functional.corner_factor * density(values)

    errors: dict[str, list[float]] = {"gradient": [], "Hessian": []}
    with mpmath.workdps(_DIGITS):
        for jet in _random_jets(_CORNERS):
            slopes = [_slope(energy, jet, {name: 1}) for name in _FIRST]
            errors["gradient"].append(_relative(gradient(jet), slopes))
            curves = [
                _slope(lambda at, q=q: _slope(energy, at, {q: 1}), jet, {p: 1})  # type: ignore[misc]
                for p in _FIRST
                for q in _FIRST
            ]
            errors["Hessian"].append(_relative(hessian(jet), curves))
    for name, values in errors.items():
        yield _difference(f"derived {name} of a corner against differences in {_DIGITS} digits", max(values), 1e-20)


def _euler_lagrange(functional: Functional) -> Check:
    """Compare the derived residual d/dxi F_(r_xi) + d/deta F_(r_eta), r = x or y, with differences."""
    import mpmath

    from .symbolic import euler_lagrange

    density, errors = _density(functional), []
    residual = _derived(list(euler_lagrange(functional).residual), functional)
    with mpmath.workdps(_DIGITS):
        for jet in _random_jets(_CORNERS):
            along = {
                "xi": {f"{r}_{d}": jet[f"{r}_xi{d}"] for r in "xy" for d in ("xi", "eta")},
                "eta": {f"{r}_{d}": jet[f"{r}_{d}eta"] for r in "xy" for d in ("xi", "eta")},
            }
            terms = [
                _slope(lambda at, p=f"{r}_{d}": _slope(density, at, {p: 1}), jet, along[d])  # type: ignore[misc]
                for r in "xy"
                for d in ("xi", "eta")
            ]
            size = max(abs(term) for term in terms) or 1
            expected = [terms[0] + terms[1], terms[2] + terms[3]]
            found = residual(jet)
            errors.append(float(max(abs(a - b) for a, b in zip(found, expected, strict=True)) / size))
    name = f"derived Euler–Lagrange residual against differences in {_DIGITS} digits"
    return _difference(name, max(errors), 1e-20)


# ---- kernels ----


def _random_nodes() -> Array:
    """Return unit squares with noise in every node, (2, ni, nj)."""
    ni, nj = _SIZE
    nodes = np.stack(np.meshgrid(np.arange(ni), np.arange(nj), indexing="ij")).astype(float)
    return nodes + 0.08 * np.random.default_rng(3).normal(size=nodes.shape)


def _apart(found: Any, expected: Any, floor: float) -> float:  # noqa: ANN401
    """Return the largest difference of two arrays over the largest expected value; nan where one is not finite.

    Expected values below `floor` are taken for it: what ought to vanish does so up to round-off only.
    """
    found, expected = np.asarray(found), np.asarray(expected)
    return float(np.abs(found - expected).max() / max(np.abs(expected).max(), floor))


def _floor(functional: Functional) -> float:
    """Return a thousandth of a cell's energy on the random grid, or of 1."""
    nodes = _random_nodes()
    return 1e-3 * abs(kernels(functional, backend="numpy").energy(nodes)[0]) / nodes[0].size or 1e-3


def _hessian_kernel(functional: Functional) -> Check:
    """Compare Hessian times vector with a difference of gradients, at the free nodes."""
    from .grids import Grid
    from .solvers import gradient, hessian

    nodes = _random_nodes()
    move = np.random.default_rng(4).normal(size=nodes.shape)
    move[:, [0, -1]] = 0.0
    move[:, :, [0, -1]] = 0.0
    ahead, behind = (
        gradient(Grid.from_planes(*(nodes + sign * _DOUBLE_STEP * move)), functional)[1:-1, 1:-1].ravel()
        for sign in (1, -1)
    )
    product = hessian(Grid.from_planes(*nodes), functional) @ np.moveaxis(move, 0, -1)[1:-1, 1:-1].ravel()
    return _difference(
        "Hessian kernel against differences of the gradient kernel",
        _apart(product, (ahead - behind) / (2 * _DOUBLE_STEP), _floor(functional)),
        1e-6,
    )


def _backends(functional: Functional) -> Check:
    """Compare all compiled kernels with NumPy's."""
    name = f"C kernels against NumPy kernels on {_SIZE[0]} x {_SIZE[1]} nodes"
    if find_compiler() is None:
        return Check(name, 0.0, 0.0, True, f"{name}: not done, there is no C compiler")
    try:
        compiled, plain = (_outputs(kernels(functional, backend=backend)) for backend in ("c", "numpy"))
    except ArithmeticError as error:
        return Check(name, math.nan, 1e-10, False, f"{name}: {type(error).__name__}: {error}")
    floor = _floor(functional)
    return _difference(name, float(np.max([_apart(a, b, floor) for a, b in zip(compiled, plain, strict=True)])), 1e-10)


def _outputs(kernel: KernelSet) -> list[Any]:
    """Return what every kernel makes of the same random grid."""
    nodes = _random_nodes()
    fixed = np.ones(_SIZE, dtype=np.uint8)
    fixed[1:-1, 1:-1] = 0
    swept, relaxed = nodes.copy(), nodes.copy()
    kernel.sweep(swept, None, fixed, 3, floor=0.0)
    kernel.euler_lagrange_relaxation(relaxed, None, fixed, 3, 0.5)
    return [
        *kernel.energy_gradient(nodes),
        kernel.energy(nodes)[0],
        kernel.hessian(nodes),
        kernel.hessian(nodes, semidefinite=True),
        kernel.euler_lagrange_residual(nodes),
        kernel.euler_lagrange_jacobian(nodes),
        kernel.euler_lagrange_jacobian(nodes, frozen=True),
        swept,
        relaxed,
    ]


# ---- the limit ----


def _limit(functional: Functional) -> Check:
    """Measure the order at which the discrete gradient tends to minus the Euler–Lagrange residual."""
    from .symbolic import euler_lagrange

    residual = _residual_function(functional, euler_lagrange(functional).residual)
    coarse, fine = (_limit_error(functional, residual, cells) for cells in (_COARSE, _FINE))
    name = "discrete gradient against the Euler–Lagrange residual"
    if fine < 1e-9:  # A null Lagrangian: both vanish.
        return Check(name, fine, 1e-9, True, f"{name}: equal to {fine:.1e}")
    order = math.log2(coarse / fine) if coarse > 0 else math.nan
    text = f"{name}: error {coarse:.1e} at {_COARSE} cells, {fine:.1e} at {_FINE}: order {order:.2f} (at least 1.8)"
    return Check(name, order, 1.8, order >= 1.8, text)


def _residual_function(functional: Functional, residual: tuple[Any, Any]) -> Callable[[Mapping[str, Array]], Array]:
    import sympy

    from .symbolic.coordinates import expand_metric, s

    names = [*_FIRST, *_SECOND]
    values = {sympy.Symbol(name, real=True): value for name, value in functional.parameters.items()}
    parts = [expand_metric(part).subs(s, 1).subs(values) for part in residual]
    parts = [part.replace(sympy.DiracDelta, lambda *_: sympy.S.Zero) for part in parts]
    function = sympy.lambdify([sympy.Symbol(name, real=True) for name in names], parts, "numpy", cse=True)
    shape = (_COARSE + 1, _COARSE + 1)
    return lambda jets: np.stack([np.broadcast_to(part, shape) for part in function(*(jets[n] for n in names))])


def _limit_error(functional: Functional, residual: Callable[[Mapping[str, Array]], Array], cells: int) -> float:
    """Return the error at the nodes of the coarse grid, over the largest residual (or energy, if there is none).

    The median over the nodes counts, so that the few at a kink of abs() do not decide.
    """
    nodes, jets = _smooth_map(cells)
    every = cells // _COARSE
    energy, _, gradient = kernels(functional, backend="numpy").energy_gradient(nodes)
    found = gradient[:, ::every, ::every][:, 1:-1, 1:-1] / (4 * functional.corner_factor)
    expected = -residual({name: jet[::every, ::every] for name, jet in jets.items()})[:, 1:-1, 1:-1]
    scale = np.abs(expected).max()
    floor = 1e-9 * abs(energy) / nodes[0].size
    return float(np.median(np.abs(found - expected)) / max(scale, floor or 1.0))


def _smooth_map(cells: int) -> tuple[Array, dict[str, Array]]:
    """Return x = u + v/5 + sin(2u + v)/7, y = u/10 + 11v/10 + cos(u - 2v)/8 at the nodes, and its derivatives.

    They are taken in the coordinates in which cells are unit squares.
    """
    h = np.array([1.0, 0.8]) / cells
    u, v = np.meshgrid(h[0] * np.arange(cells + 1), h[1] * np.arange(cells + 1), indexing="ij")
    p, q = 2 * u + v, u - 2 * v
    jets = {
        "x_xi": 1 + 2 * np.cos(p) / 7, "x_eta": 0.2 + np.cos(p) / 7,
        "y_xi": 0.1 - np.sin(q) / 8, "y_eta": 1.1 + np.sin(q) / 4,
        "x_xixi": -4 * np.sin(p) / 7, "x_xieta": -2 * np.sin(p) / 7, "x_etaeta": -np.sin(p) / 7,
        "y_xixi": -np.cos(q) / 8, "y_xieta": np.cos(q) / 4, "y_etaeta": -np.cos(q) / 2,
    }  # fmt: skip
    for name in jets:
        jets[name] *= h[0] ** name.count("xi") * h[1] ** name.count("eta")
    nodes = np.stack([u + v / 5 + np.sin(p) / 7, u / 10 + 1.1 * v + np.cos(q) / 8])
    return nodes, jets
