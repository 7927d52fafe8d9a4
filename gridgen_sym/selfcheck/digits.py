"""The derived derivatives and equations against differences of the bare formula, in many digits."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from ..functionals import Functional
from ..functionals.variant import Variant
from .check import Check, both_zero, difference, failure
from .derived import FIRST, written_out
from .samples import SIZES, random_jets
from .setting import CORNER, Setting

_DIGITS = 80
#: Step of the differences over the size of the corner, in arithmetic with so many digits.
_STEP = "1e-24"
#: Corners of each size.
_CORNERS = 3
_LIMIT = 1e-20

Numbers = Mapping[str, Any]
Formula = Callable[[Numbers], Any]


def _density(functional: Functional, variant: Variant = "plain") -> Formula:
    """Return the bare density as a function of numbers by name; the metric is computed from its definition."""
    import sympy

    expression = functional.expression()
    names = sorted(str(name) for name in expression.free_symbols)
    evaluate = sympy.lambdify([sympy.Symbol(name, real=True) for name in names], expression, "mpmath")

    setting = Setting(functional, variant)

    def density(values: Numbers) -> Any:  # noqa: ANN401
        known = {**_parameters(functional), **values, **setting.bare(values)}
        return evaluate(*(known[name] for name in names))

    return density


def _derived(expressions: list[Any], functional: Functional, variant: Variant) -> Formula:
    """Return derived expressions as a function of numbers by name."""
    import sympy

    setting = Setting(functional, variant)
    parts = [written_out(part) for part in expressions]
    names = sorted({str(name) for part in parts for name in part.free_symbols})
    evaluate = sympy.lambdify([sympy.Symbol(name, real=True) for name in names], parts, "mpmath")

    def derived(values: Numbers) -> Any:  # noqa: ANN401
        known = {**_parameters(functional), **values, **setting.given(values)}
        return evaluate(*(known[name] for name in names))

    return derived


def _parameters(functional: Functional) -> dict[str, Any]:
    """Return the default values with all digits; products of floats would be rounded."""
    from mpmath import mpf  # type: ignore[import-untyped]

    return {name: mpf(value) for name, value in functional.parameters.items()}


def _jets(density: Formula) -> list[dict[str, Any]]:
    """Return the derivatives of maps of all sizes at which the density has a real and finite value."""
    from mpmath import mpf

    jets = [
        {name: mpf(value) for name, value in (jet | _place(size)).items()} | {"size": mpf(size)}
        for size in SIZES
        for jet in random_jets(_CORNERS, size)
    ]
    return [jet for jet in jets if _finite(lambda jet=jet: [density(jet)])]  # type: ignore[misc]


def _place(size: float) -> dict[str, float]:
    return {name: value * size if name in ("x", "y") else value for name, value in CORNER.items()}


def _finite(function: Callable[[], list[Any]]) -> list[Any] | None:
    """Return the numbers of a function, or None where one of them does not exist, is infinite or is not real."""
    import mpmath

    try:
        numbers = function()
    except (ArithmeticError, ValueError):  # A division by zero; a logarithm of zero.
        return None
    return numbers if all(mpmath.isfinite(number) and mpmath.im(number) == 0 for number in numbers) else None


def _slope(function: Formula, values: Numbers, move: Numbers) -> Any:  # noqa: ANN401
    """Return the central difference of a function along a move, given as changes of numbers by name."""
    from mpmath import mpf

    h = mpf(_STEP) * values["size"]
    ahead, behind = ({**values, **{k: values[k] + sign * h * change for k, change in move.items()}} for sign in (1, -1))
    return (function(ahead) - function(behind)) / (2 * h)


def _compare(name: str, jets: list[dict[str, Any]], found: Formula, expected: Formula) -> Check:
    """Compare numbers at all jets: the largest difference over the size of what is expected there.

    Args:
        name: what is compared.
        jets: where.
        found: returns the derived numbers.
        expected: returns the numbers by differences, and the size beside which an error counts.
    """
    if not jets:
        return failure(name, _LIMIT, "the density is not finite at any corner that was tried")
    errors, nonzero = [], False
    for jet in jets:
        numbers = _finite(lambda jet=jet: list(found(jet)))  # type: ignore[misc]
        both = _finite(lambda jet=jet: [*expected(jet)])  # type: ignore[misc]
        if numbers is None or both is None:
            where = ", ".join(f"{key} = {float(jet[key]):.3g}" for key in FIRST)
            return failure(name, _LIMIT, f"not finite at the corner {where}")
        *values, scale = both
        error = max(abs(a - b) for a, b in zip(numbers, values, strict=True))
        nonzero = nonzero or bool(scale or error)
        errors.append(float(error / scale if scale else error))
    return difference(name, max(errors), _LIMIT) if nonzero else both_zero(name, _LIMIT)


def corner_derivatives(functional: Functional, variant: Variant = "plain") -> Iterator[Check]:
    """Compare the derived gradient and Hessian of a corner, also in a position that values move with, with differences.

    Args:
        functional: what is checked.
        variant: how its fields enter.
    """
    import mpmath
    import sympy

    from ..symbolic import corner_model

    setting = Setting(functional, variant)
    model, density = corner_model(functional, variant), _density(functional, variant)
    names, slopes_of, bends = list(FIRST), list(model.gradient), model.hessian
    if setting.moves:
        names, slopes_of = [*names, "x", "y"], [*slopes_of, *model.position_gradient]
        cross = model.position_cross
        bends = sympy.Matrix([[bends, cross], [cross.T, model.position_hessian]])
    gradient, hessian = (_derived(list(part), functional, variant) for part in (slopes_of, bends))

    def energy(values: Numbers) -> Any:  # noqa: ANN401
        return functional.corner_factor * density(values)

    def slopes(jet: Numbers) -> list[Any]:
        return _scaled([_slope(energy, jet, {name: 1}) for name in names])

    def curves(jet: Numbers) -> list[Any]:
        second = [lambda at, q=q: _slope(energy, at, {q: 1}) for q in names]
        return _scaled([_slope(along, jet, {p: 1}) for p in names for along in second])

    name = f"derived {{}} of a corner{setting.words} against differences in {_DIGITS} digits"
    with mpmath.workdps(_DIGITS):
        jets = _jets(density)
        yield _compare(name.format("gradient"), jets, gradient, slopes)
        yield _compare(name.format("Hessian"), jets, hessian, curves)


def _scaled(values: list[Any]) -> list[Any]:
    """Return the values and the largest size of one."""
    return [*values, max(abs(value) for value in values)]


def equations(functional: Functional, variant: Variant = "plain") -> Check:
    """Compare the derived residual d/dxi F_(r_xi) + d/deta F_(r_eta) - F_r, r = x or y, with differences."""
    import mpmath

    from ..symbolic import euler_lagrange

    setting, density = Setting(functional, variant), _density(functional, variant)
    residual = _derived(list(euler_lagrange(functional, variant).residual), functional, variant)

    def terms(jet: Numbers) -> list[Any]:
        # How everything moves along xi, and along eta, over the size.
        along = {
            "xi": {f"{r}_{d}": jet[f"{r}_xi{d}"] for r in "xy" for d in ("xi", "eta")},
            "eta": {f"{r}_{d}": jet[f"{r}_{d}eta"] for r in "xy" for d in ("xi", "eta")},
        }
        for d, moves in along.items():
            moves |= {d: 1, "x": jet[f"x_{d}"], "y": jet[f"y_{d}"]}
            along[d] = {name: move / jet["size"] for name, move in moves.items()}
        found = [
            _slope(lambda at, p=f"{r}_{d}": _slope(density, at, {p: 1}), jet, along[d])  # type: ignore[misc]
            * jet["size"]
            for r in "xy"
            for d in ("xi", "eta")
        ]
        sources = [_slope(density, jet, {r: 1}) if setting.moves else 0 for r in "xy"]
        scale = max(abs(term) for term in (*found, *sources))
        return [found[0] + found[1] - sources[0], found[2] + found[3] - sources[1], scale]

    name = f"derived Euler–Lagrange residual{setting.words} against differences in {_DIGITS} digits"
    with mpmath.workdps(_DIGITS):
        return _compare(name, _jets(density), residual, terms)
