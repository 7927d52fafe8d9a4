"""The values that a functional allows its parameters, fields, and xi and eta: at these, and no others, it is judged."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import sympy
from sympy import Expr, Symbol

from ..arrays import Array
from ..functionals.definition import Functional
from ..functionals.expression import comparisons
from ..functionals.field_kinds import TYPICAL, components
from ..functionals.metric import LOGICAL_NAMES, symbol

#: A random value that is not admissible is moved toward the default, half of the way each time, so often.
_HALVINGS = 20


@dataclass(frozen=True, slots=True)
class Admissible:
    """The admissible values of parameters, among them the defaults, and those of the components of fields.

    Attributes:
        defaults: the default value of every parameter; a typical one of the components of scalars and vectors, and of
            xi and eta, where they are named.
        inequalities: expressions that must not be negative, and whether they must be positive.
        equalities: expressions that must be zero.
        matrices: the components of matrices, in symbols in which they may take all their values, and no others.
    """

    defaults: dict[Symbol, float]
    inequalities: tuple[tuple[Expr, bool], ...] = ()
    equalities: tuple[Expr, ...] = ()
    matrices: dict[Symbol, Expr] = field(default_factory=dict)

    def sample(self, random: np.random.Generator, count: int) -> dict[Symbol, Array]:
        """Return `count` random admissible values of every parameter and component, of many sizes.

        A parameter of an equality that cannot be solved keeps its default.
        """
        return self._sample_defaults(random, count) | self._sample_matrices(random, count)

    def _sample_matrices(self, random: np.random.Generator, count: int) -> dict[Symbol, Array]:
        inner = sorted({t for e in self.matrices.values() for t in e.free_symbols}, key=sympy.default_sort_key)
        values = random.normal(size=(len(inner), count))
        for row, variable in zip(values, inner, strict=True):
            if variable.is_positive:
                np.abs(row, out=row)
        return {m: sympy.lambdify(inner, e, "numpy")(*values) for m, e in self.matrices.items()}

    def _sample_defaults(self, random: np.random.Generator, count: int) -> dict[Symbol, Array]:
        given, frozen = self._eliminated()
        free = [p for p in self.defaults if p not in given and p not in frozen]
        start = np.array([self.defaults[p] for p in free]).reshape(-1, 1)
        sizes = np.exp(2 * random.normal(size=(len(free), count)))
        way = np.where(random.random(size=sizes.shape) < 0.5, -1, 1) * sizes - start
        step = np.ones(count)
        for _ in range(_HALVINGS):
            values = self._complete(dict(zip(free, start + step * way, strict=True)), given, count)
            allowed = self._holds(values, count)
            if allowed.all():
                return values
            step = np.where(allowed, step, step / 2)
        return self._complete(dict(zip(free, start + np.where(allowed, step, 0) * way, strict=True)), given, count)

    def substitution(self) -> dict[Symbol, Expr]:
        """Return what may stand for parameters, in symbols that are nowhere negative, as far as constraints are linear.

        All admissible values are met, and perhaps others: what is proved for these symbols is proved for the
        parameters. `k > 2` gives k = 2 + t; `0 < k < 1` gives k = t/(1 + t); `a + b == 1` gives a = 1 - b. The
        components of a positive definite matrix are those of a product of triangular ones.
        """
        replaced, _ = self._eliminated()
        symbols: list[Symbol] = []
        for expression, strict in self.inequalities:
            rest = sympy.expand(expression.subs(replaced))
            found = _solved(rest, [p for p in self.defaults if p in rest.free_symbols])
            if found is not None:  # slope p + offset = t
                parameter, slope, offset = found
                bound = sympy.Dummy("t", positive=True) if strict else sympy.Dummy("t", nonnegative=True)
                change = {parameter: (bound - offset) / slope}
            else:
                change = _below(rest, symbols)
            replaced = {p: e.subs(change) for p, e in replaced.items()}
            replaced |= {p: e for p, e in change.items() if p in self.defaults}
            new = {t for e in change.values() for t in e.free_symbols if t not in self.defaults}
            symbols = [*(t for t in symbols if t not in change), *(new - set(symbols))]
        return replaced | self.matrices

    def of_fields(self, functional: Functional) -> dict[Symbol, Expr]:
        """Return what may stand for the components of fields, as `substitution` does."""
        names = {*functional.components}
        return {p: e for p, e in self.substitution().items() if str(p) in names}

    def _eliminated(self) -> tuple[dict[Symbol, Expr], set[Symbol]]:
        """Return parameters that equalities give by the others, and those of equalities that cannot be solved."""
        given: dict[Symbol, Expr] = {}
        frozen: set[Symbol] = set()
        for expression in self.equalities:
            rest = sympy.expand(expression.subs(given))
            found = _solved(rest, [p for p in self.defaults if p in rest.free_symbols], numbers_only=False)
            if found is None:
                frozen |= rest.free_symbols
                continue
            parameter, slope, offset = found
            given = {p: e.subs(parameter, -offset / slope) for p, e in given.items()} | {parameter: -offset / slope}
        return given, frozen

    def _complete(self, free: dict[Symbol, Array], given: dict[Symbol, Expr], count: int) -> dict[Symbol, Array]:
        """Return the values of all parameters from those that are free."""
        values = {p: free.get(p, np.full(count, default)) for p, default in self.defaults.items()}
        for parameter, expression in given.items():
            values[parameter] = _function(expression, self.defaults)(*values.values()) + np.zeros(count)
        return values

    def _holds(self, values: dict[Symbol, Array], count: int) -> Any:  # noqa: ANN401 - an array of booleans
        """Return whether the inequalities hold, for each sample."""
        allowed = np.all(np.isfinite(list(values.values())), axis=0) if values else np.ones(count, dtype=bool)
        for expression, strict in self.inequalities:
            value = _function(expression, self.defaults)(*values.values())
            allowed = allowed & (value > 0 if strict else value >= 0)
        return allowed


def admissible(functional: Functional) -> Admissible:
    """Return what the constraints of a functional allow.

    Raises:
        GridgenError: if a constraint is not a comparison of arithmetic in the parameters.
    """
    values: dict[str, float] = dict(functional.parameters)
    matrices: dict[Symbol, Expr] = {}
    for name, kind in functional.fields.items():
        own = components(name, kind)
        if kind in ("scalar", "vector"):
            values |= dict(zip(own, TYPICAL[kind], strict=True))
        else:
            matrices |= dict(zip(map(symbol, own), _MATRICES[kind](), strict=True))
    names = {name: symbol(name) for name in values}
    signed = [*_signed(functional, names), *_in_the_logical_square(functional)]
    values |= {str(place): 0.5 for place in _logical(functional)}
    names |= {str(place): place for place in _logical(functional)}
    return Admissible(
        {names[name]: float(value) for name, value in values.items()},
        tuple((expression, sign == ">") for expression, sign in signed if sign != "=="),
        tuple(expression for expression, sign in signed if sign == "=="),
        matrices,
    )


def _logical(functional: Functional) -> list[Symbol]:
    """Return those of xi and eta that the density names."""
    named = functional.expression().free_symbols
    return [place for place in map(symbol, LOGICAL_NAMES) if place in named]


def _in_the_logical_square(functional: Functional) -> Iterator[tuple[Expr, str]]:
    """Yield xi >= 0 and xi <= 1, and the same of eta, where the density names them."""
    for place in _logical(functional):
        yield from ((place, ">="), (1 - place, ">="))


def _positive_definite() -> tuple[Expr, ...]:
    """Return the components 11, 12, 22 of L Lᵗ, with L a triangular matrix with a positive diagonal."""
    a, d = sympy.Dummy("a", positive=True), sympy.Dummy("d", positive=True)
    b = sympy.Dummy("b", real=True)
    return a**2, a * b, b**2 + d**2


def _any_matrix() -> tuple[Expr, ...]:
    return tuple(sympy.Dummy(name, real=True) for name in "abcd")


_MATRICES: Mapping[str, Callable[[], tuple[Expr, ...]]] = {"symmetric": _positive_definite, "matrix": _any_matrix}


def _signed(functional: Functional, names: dict[str, Symbol]) -> Iterator[tuple[Expr, str]]:
    """Yield the constraints as expressions that must be > 0, >= 0 or == 0."""
    for constraint in functional.constraints:
        for one in comparisons(constraint, names, sympy.Rational):
            turned = one.sign in ("<", "<=")
            difference = sympy.sympify(one.right - one.left if turned else one.left - one.right)
            yield difference, one.sign.replace("<", ">")


def _solved(
    expression: Expr, parameters: list[Symbol], *, numbers_only: bool = True
) -> tuple[Symbol, Expr, Expr] | None:
    """Return (p, slope, offset) of an expression slope p + offset, for the first parameter p in which it is linear."""
    for parameter in parameters:
        if not expression.is_polynomial(parameter) or sympy.degree(expression, parameter) != 1:
            continue
        slope = expression.coeff(parameter, 1)
        if slope.is_number or not numbers_only:
            return parameter, slope, expression.coeff(parameter, 0)
    return None


def _below(expression: Expr, symbols: list[Symbol]) -> dict[Symbol, Expr]:
    """Return how symbols that are not negative stay in the simplex where `expression`, linear in them, is positive.

    Where it is not a positive number minus positive multiples of some of them, nothing is returned.
    """
    inner = sorted(expression.free_symbols, key=sympy.default_sort_key)
    if not inner or not set(inner) <= set(symbols) or sympy.Poly(expression, *inner).total_degree() != 1:
        return {}
    slopes, offset = [expression.coeff(t) for t in inner], expression.subs(dict.fromkeys(inner, 0))
    if not (offset.is_positive and all(slope.is_negative for slope in slopes)):
        return {}
    free = [sympy.Dummy("t", nonnegative=True) for _ in inner]
    return {t: -offset / slope * u / (1 + sympy.Add(*free)) for t, slope, u in zip(inner, slopes, free, strict=True)}


def _function(expression: Expr, parameters: dict[Symbol, float]) -> Callable[..., Any]:
    function = sympy.lambdify(list(parameters), expression, "numpy")

    def quiet(*values: Array) -> Any:  # noqa: ANN401
        with np.errstate(all="ignore"):
            return function(*values)

    return quiet
