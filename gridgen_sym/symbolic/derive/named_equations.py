"""The Euler–Lagrange residual and its slopes by the chain rule, with a name for every part that recurs.

Write F(u) for the density, u for what it names: the metric, first derivatives of the map, values. With K_u = d/dxi F_u
and L_u = d/deta F_u, a sum over all u,

    R_r = K_u u_(r_xi) + L_u u_(r_eta) + F_u (d/dxi u_(r_xi) + d/deta u_(r_eta)) - F_u u_r.

Its slopes follow by the product rule. F is differentiated in u alone, three times at most, and no expression is ever
written out in the derivatives of the map: these are the fewest operations, for SymPy and in kernels.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import sympy
from sympy import Expr, Symbol

from ...functionals.metric import RESERVED_NAMES
from ..coordinates import DEFINITIONS, FIRST_DERIVATIVES, SECOND_DERIVATIVES, differentiate, x, y
from ..values import Values

#: The derivatives along xi (0) and eta (1) of every first derivative, in the order of `FIRST_DERIVATIVES`.
_x_xixi, _x_xieta, _x_etaeta, _y_xixi, _y_xieta, _y_etaeta = SECOND_DERIVATIVES
SECOND_ALONG = ((_x_xixi, _y_xixi, _x_xieta, _y_xieta), (_x_xieta, _y_xieta, _x_etaeta, _y_etaeta))
_PLACE = (x, y)
_DIRECTIONS = (0, 1)


@dataclass(slots=True)
class NamedEquations:
    """The residual of a density and its slopes, as expressions in named parts.

    Attributes:
        density: in the metric symbols.
        values: the symbols beside the metric.
        definitions: what the names of the parts stand for, each after those that it is made of.
    """

    density: Expr
    values: Values
    definitions: dict[Symbol, Expr] = field(default_factory=dict)
    _known: dict[tuple[object, ...], Expr] = field(default_factory=dict)

    def residual(self) -> tuple[Expr, Expr]:
        """Return the two residuals."""
        first, second = (self._residual(component) for component in (0, 1))
        return first, second

    def residual_by_coefficients(self) -> tuple[Expr, Expr]:
        """Return the same as `coefficients` times second derivatives, and what is left of lower order."""
        coefficients = self.coefficients()
        first, second = (
            sympy.Add(self._rest(component), *(pair[component] * p for p, pair in coefficients.items()))
            for component in (0, 1)
        )
        return first, second

    def slopes(self) -> Mapping[Symbol, tuple[Expr, Expr]]:
        """Return the slopes of both residuals in first derivatives of the map and, where values move, in x and y.

        The third derivatives of values are left out: they would need many planes, and Newton's method converges
        without them, a little slower.
        """
        variables = (*FIRST_DERIVATIVES, *(_PLACE if self.values.moving else ()))
        return {p: (self._residual_slope(0, p), self._residual_slope(1, p)) for p in variables}

    def coefficients(self) -> Mapping[Symbol, tuple[Expr, Expr]]:
        """Return the coefficients of every second derivative in the two residuals."""
        return {second: (self._coefficient(0, second), self._coefficient(1, second)) for second in SECOND_DERIVATIVES}

    def _residual(self, component: int) -> Expr:
        total = sympy.S.Zero
        for u in self._atoms:
            for direction in _DIRECTIONS:
                total += self._slope_along(direction, u) * self._partial(u, _first(direction, component))
            total += self._slope(u) * (self._turn(u, component) - self._partial(u, _PLACE[component]))
        return total

    def _rest(self, component: int) -> Expr:
        """Return the residual where the second derivatives of the map vanish: through values alone."""
        total = sympy.S.Zero
        for u in self._atoms:
            outer = -self._partial(u, _PLACE[component])
            for direction in _DIRECTIONS:
                inner = self._partial(u, _first(direction, component))
                if inner != 0:
                    total += self._slope_through_values(direction, u) * inner
                    outer += self.values.differentiate_along(inner, direction)
            total += self._slope(u) * outer if outer != 0 else 0
        return total

    def _slope_through_values(self, direction: int, u: Symbol) -> Expr:
        """Return d/dxi or d/deta of F_u where the second derivatives of the map vanish, by name."""

        def meaning() -> Expr:
            moves = ((v, self.values.differentiate_along(v, direction)) for v in self._atoms)
            return sympy.Add(*(self._slope(u, v) * along for v, along in moves if along != 0))

        return self._named("KL"[direction], (u,), meaning, head="values_")

    def _residual_slope(self, component: int, p: Symbol) -> Expr:
        total = sympy.S.Zero
        for u in self._atoms:
            for direction in _DIRECTIONS:
                inner = self._partial(u, _first(direction, component))
                if inner != 0:
                    total += self._slope_along_slope(direction, u, p) * inner
                    total += self._slope_along(direction, u) * self._differentiate(inner, p)
            outer = self._turn(u, component) - self._partial(u, _PLACE[component])
            if outer != 0:
                total += self._slope_slope(u, p) * outer + self._slope(u) * self._differentiate(outer, p)
        return total

    def _coefficient(self, component: int, second: Symbol) -> Expr:
        total = sympy.S.Zero
        for direction in _DIRECTIONS:
            for k, along in enumerate(SECOND_ALONG[direction]):
                if along == second:
                    total += self._hessian(FIRST_DERIVATIVES.index(_first(direction, component)), k)
        return total

    @property
    def _atoms(self) -> tuple[Symbol, ...]:
        """What the density names that is not the same everywhere."""
        varies = {*DEFINITIONS, *FIRST_DERIVATIVES, *self.values.along}
        return tuple(sorted(self.density.free_symbols & varies, key=str))

    def _slope(self, *atoms: Symbol) -> Expr:
        """Return F_u, F_uv or F_uvw, by name."""
        ordered = tuple(sorted(atoms, key=str))
        return self._named("F", ordered, lambda: self._bare_slope(ordered))

    def _bare_slope(self, atoms: tuple[Symbol, ...]) -> Expr:
        *before, last = atoms
        return self._once(
            ("bare", *atoms), lambda: sympy.diff(self._bare_slope(tuple(before)) if before else self.density, last)
        )

    def _slope_along(self, direction: int, *atoms: Symbol) -> Expr:
        """Return d/dxi or d/deta of F_u or F_uv, by name."""
        ordered = tuple(sorted(atoms, key=str))

        def meaning() -> Expr:
            return sympy.Add(*(self._slope(*ordered, v) * self._along(direction, v) for v in self._atoms))

        return self._named("KL"[direction], ordered, meaning)

    def _slope_slope(self, u: Symbol, p: Symbol) -> Expr:
        """Return the derivative of F_u in p, by name."""

        def meaning() -> Expr:
            return sympy.Add(*(self._slope(u, v) * self._partial(v, p) for v in self._atoms))

        return self._named("F", (u, p), meaning, head="slope_of_")

    def _slope_along_slope(self, direction: int, u: Symbol, p: Symbol) -> Expr:
        """Return the derivative of d/dxi F_u or d/deta F_u in p, by name."""

        def meaning() -> Expr:
            total = sympy.S.Zero
            for v in self._atoms:
                total += self._slope_along(direction, u, v) * self._partial(v, p)
                total += self._slope(u, v) * self._differentiate(self._bare_along(direction, v), p)
            return total

        return self._named("KL"[direction], (u, p), meaning, head="slope_of_")

    def _hessian(self, row: int, column: int) -> Expr:
        """Return an entry of the second derivative of the density in the first derivatives of the map, by name."""
        row, column = sorted((row, column))
        p, q = FIRST_DERIVATIVES[row], FIRST_DERIVATIVES[column]

        def meaning() -> Expr:
            total = sympy.S.Zero
            for u in self._atoms:
                inner = self._partial(u, p)
                if inner != 0:
                    total += self._slope_slope(u, q) * inner + self._slope(u) * self._differentiate(inner, q)
            return total

        return self._named("H", (p, q), meaning)

    def _along(self, direction: int, u: Symbol) -> Expr:
        """Return d/dxi u or d/deta u, by name."""
        return self._named("D", (u,), lambda: self._bare_along(direction, u), tail=("xi", "eta")[direction])

    def _bare_along(self, direction: int, u: Symbol) -> Expr:
        return self._once(("along", direction, u), lambda: self._total(u, direction))

    def _turn(self, u: Symbol, component: int) -> Expr:
        """Return d/dxi u_(r_xi) + d/deta u_(r_eta)."""

        def meaning() -> Expr:
            parts = (self._total(self._partial(u, _first(direction, component)), direction) for direction in (0, 1))
            return sympy.expand(sympy.Add(*parts))

        return self._once(("turn", u, component), meaning)

    def _total(self, expression: Expr, direction: int) -> Expr:
        """Return the derivative along xi or eta, through the first derivatives of the map and the values."""
        if expression == 0:
            return expression
        terms = (
            differentiate(expression, p) * second
            for p, second in zip(FIRST_DERIVATIVES, SECOND_ALONG[direction], strict=True)
        )
        return sympy.Add(*terms, self.values.differentiate_along(expression, direction))

    def _partial(self, u: Symbol, p: Symbol) -> Expr:
        """Return the derivative of something that the density names in a first derivative, or in x or y."""
        return self._once(("partial", u, p), lambda: self._differentiate(u, p))

    def _differentiate(self, expression: Expr, p: Symbol) -> Expr:
        if p in _PLACE:
            return self.values.differentiate(expression, _PLACE.index(p))
        return differentiate(expression, p)

    def _named(
        self, kind: str, of: tuple[Symbol, ...], meaning: Callable[[], Expr], *, head: str = "", tail: str = ""
    ) -> Expr:
        """Return the name of a part, which `meaning` gives; what is a name or a number needs none."""

        def name() -> Expr:
            part = meaning()
            if part.is_Atom or (-part).is_Atom:
                return part
            symbol = sympy.Symbol("__".join((head + kind, *map(self._token, of), *([tail] if tail else []))), real=True)
            self.definitions[symbol] = part
            return symbol

        return self._once((head, kind, *of, tail), name)

    def _token(self, u: Symbol) -> str:
        """Return what stands for u in the name of a part: a number, where the name of u is a user's."""
        return u.name if u.name in RESERVED_NAMES or u in DEFINITIONS else f"value{self._atoms.index(u)}"

    def _once(self, key: tuple[object, ...], compute: Callable[[], Expr]) -> Expr:
        if key not in self._known:
            self._known[key] = compute()
        return self._known[key]


def _first(direction: int, component: int) -> Symbol:
    """Return r_xi or r_eta, of x (0) or y (1)."""
    return FIRST_DERIVATIVES[2 * direction + component]
