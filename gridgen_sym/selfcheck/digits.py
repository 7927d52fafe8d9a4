"""The derived derivatives and equations against differences of the bare formula, in many digits."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from ..functionals import Functional
from .check import Check, difference
from .derived import FIRST, SECOND, written_out

_DIGITS = 80
#: Step of the differences, in arithmetic with so many digits.
_STEP = "1e-16"
_CORNERS = 5

Numbers = Mapping[str, Any]
Formula = Callable[[Numbers], Any]


def _density(functional: Functional) -> Formula:
    """Return the bare density as a function of numbers by name; the metric is computed from its definition."""
    import sympy

    expression = functional.expression()
    names = sorted(str(name) for name in expression.free_symbols)
    evaluate = sympy.lambdify([sympy.Symbol(name, real=True) for name in names], expression, "mpmath")

    def density(values: Numbers) -> Any:  # noqa: ANN401
        a, b, c, d = (values[name] for name in FIRST)
        metric = {"g11": a * a + b * b, "g22": c * c + d * d, "g12": a * c + b * d, "J": a * d - b * c, "s": 1}
        known = {**_parameters(functional), **values, **metric}
        return evaluate(*(known[name] for name in names))

    return density


def _derived(expressions: list[Any], functional: Functional) -> Formula:
    """Return derived expressions as a function of numbers by name."""
    import sympy

    names = [*FIRST, *SECOND, *functional.parameters]
    parts = [written_out(part) for part in expressions]
    evaluate = sympy.lambdify([sympy.Symbol(name, real=True) for name in names], parts, "mpmath")
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
        values = zip((*FIRST, *SECOND), (*first, *generator.uniform(-1, 1, 6)), strict=True)
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


def corner_derivatives(functional: Functional) -> Iterator[Check]:
    """Compare the derived gradient and Hessian of a corner with differences."""
    import mpmath

    from ..symbolic import corner_model

    model, density = corner_model(functional), _density(functional)
    gradient, hessian = (_derived(list(part), functional) for part in (model.gradient, model.hessian))

    def energy(values: Numbers) -> Any:  # noqa: ANN401
        return functional.corner_factor * density(values)

    errors: dict[str, list[float]] = {"gradient": [], "Hessian": []}
    with mpmath.workdps(_DIGITS):
        for jet in _random_jets(_CORNERS):
            slopes = [_slope(energy, jet, {name: 1}) for name in FIRST]
            errors["gradient"].append(_relative(gradient(jet), slopes))
            curves = [
                _slope(lambda at, q=q: _slope(energy, at, {q: 1}), jet, {p: 1})  # type: ignore[misc]
                for p in FIRST
                for q in FIRST
            ]
            errors["Hessian"].append(_relative(hessian(jet), curves))
    for name, values in errors.items():
        yield difference(f"derived {name} of a corner against differences in {_DIGITS} digits", max(values), 1e-20)


def equations(functional: Functional) -> Check:
    """Compare the derived residual d/dxi F_(r_xi) + d/deta F_(r_eta), r = x or y, with differences."""
    import mpmath

    from ..symbolic import euler_lagrange

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
    return difference(name, max(errors), 1e-20)
