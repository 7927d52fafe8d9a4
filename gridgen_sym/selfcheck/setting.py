"""What a functional is given where it is checked: smooth fields, a target, and places; the weight is 1.

They are formulas, so that their derivatives are exact, in doubles and in many digits.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array
from ..fields import Field, Target
from ..functionals import Functional
from ..functionals.expression import holds, names_in
from ..functionals.field_kinds import all_components, components, typical_values
from ..functionals.metric import INVERSE_TARGET_NAMES, LOGICAL_NAMES, POSITION_NAMES, TARGET_NAMES, symbol
from ..functionals.variant import Modes, Variant
from .derived import FIRST

if TYPE_CHECKING:
    from sympy import Expr

Numbers = Mapping[str, Any]

#: Where a corner is: x and y over its size, and xi and eta.
CORNER = {"x": 0.3, "y": 0.45, "xi": 0.4, "eta": 0.65}
#: A target W⁻¹ about which the one of the checks varies, and by how much of a component fields vary.
_INVERSE_TARGET = (1.1, 0.2, -0.1, 0.9)
_AMPLITUDE = 0.2
_METRIC = ("g11", "g22", "g12", "J")


def variants(functional: Functional) -> Iterator[Variant]:
    """Yield the variants in which a functional is checked: fields held, all moving, and with a target it names."""
    yield "plain"
    if functional.fields:
        yield Modes(differentiated=tuple(sorted(functional.fields))).variant
    if functional.expression().free_symbols & {*map(symbol, TARGET_NAMES)}:
        yield Modes(target=True).variant


def metric(a: Any, b: Any, c: Any, d: Any, names: tuple[str, ...] = _METRIC) -> dict[str, Any]:  # noqa: ANN401
    """Return g11, g22, g12 and J of the edge vectors (a, b) and (c, d) by their definition."""
    return dict(zip(names, (a * a + b * b, c * c + d * d, a * c + b * d, a * d - b * c), strict=True))


@dataclass(frozen=True, eq=False)
class Setting:
    """Fields and a target in one variant.

    Attributes:
        functional: what is checked.
        variant: how its fields enter.
    """

    functional: Functional
    variant: Variant

    @property
    def words(self) -> str:
        """What distinguishes the variant, with a leading blank; nothing where there is nothing to say."""
        modes = Modes.read(self.variant)
        said = [f"{name} differentiated" for name in modes.differentiated]
        said += ["fields held"] if self.functional.fields and not said else []
        said += ["with a target"] if modes.target else []
        return f" ({', '.join(said)})" if said else ""

    @property
    def moves(self) -> bool:
        """Whether what the density names moves with the position."""
        from ..symbolic.values import values_of

        return values_of(self.functional, self.variant).moving

    def bare(self, values: Numbers) -> dict[str, Any]:
        """Return what the density names beside edges, places and parameters: metrics, fields, and the weight 1.

        Args:
            values: the edges, `x`, `y`, `xi`, `eta`, and the `size` of the map.
        """
        a, b, c, d = (values[name] for name in FIRST)
        known = metric(a, b, c, d) | metric(a, b, c, d, TARGET_NAMES) | {"s": 1} | self._evaluate(values, False)
        if Modes.read(self.variant).target:
            v11, v12, v21, v22 = (known[name] for name in INVERSE_TARGET_NAMES)
            first, second = (v11 * a + v21 * c, v11 * b + v21 * d), (v12 * a + v22 * c, v12 * b + v22 * d)
            known |= metric(*first, *second, TARGET_NAMES)
        return known

    def given(self, values: Numbers) -> dict[str, Any]:
        """Return the numbers of all planes, of their slopes, and of the places, by name."""
        return {name: values[name] for name in (*POSITION_NAMES, *LOGICAL_NAMES)} | self._evaluate(values, True)

    def planes(self, names: tuple[str, ...], values: Numbers, shape: tuple[int, int]) -> Array:
        """Return the planes that a kernel reads, (n, ni, nj)."""
        given = self.given(values)
        planes = [np.broadcast_to(given[name], shape) for name in names]
        return np.array(planes, dtype=float).reshape(len(names), *shape)

    def fields(self, size: float) -> dict[str, Field]:
        """Return the fields as solvers take them."""
        modes = Modes.read(self.variant)
        found = {}
        for name, kind in self.functional.fields.items():
            source = tuple(self._formulas[part].subs(symbol("size"), size) for part in components(name, kind))
            moving = name in modes.differentiated
            logical = Field(source if len(source) > 1 else source[0], "logical")
            found[name] = Field(logical.source, mode="differentiated") if moving else logical
        return found

    def target(self) -> Target | None:
        """Return the target as solvers take it."""
        if not Modes.read(self.variant).target:
            return None
        v11, v12, v21, v22 = (self._formulas[name] for name in INVERSE_TARGET_NAMES)
        determinant = v11 * v22 - v12 * v21
        return Target.matrix((v22 / determinant, -v12 / determinant, -v21 / determinant, v11 / determinant))

    @property
    def _formulas(self) -> dict[str, Expr]:
        return _formulas(self.functional, self.variant)

    def _evaluate(self, values: Numbers, derivatives: bool) -> dict[str, Any]:
        is_array = isinstance(values["x"], (float, np.ndarray))
        names, function = _function(self.functional, self.variant, derivatives, "numpy" if is_array else "mpmath")
        places = (values[name] for name in ("size", *POSITION_NAMES, *LOGICAL_NAMES))
        return dict(zip(names, function(*places), strict=True))


@lru_cache(maxsize=32)
def _formulas(functional: Functional, variant: Variant) -> dict[str, Expr]:
    """Return fields as functions of x and y over the size of the map, or of xi and eta: waves about a value."""
    import sympy

    modes = Modes.read(variant)
    base = _admissible_values(functional)
    moving = {part for name in modes.differentiated for part in components(name, functional.fields[name])}
    if modes.target:
        base |= dict(zip(INVERSE_TARGET_NAMES, _INVERSE_TARGET, strict=True))
    formulas = {}
    for k, (name, value) in enumerate(base.items()):
        u, v = (symbol(place) for place in (POSITION_NAMES if name in moving else LOGICAL_NAMES))
        u, v = (u / symbol("size"), v / symbol("size")) if name in moving else (u, v)
        wave = sympy.sin((1 + sympy.Rational(k, 5)) * u + (2 - sympy.Rational(k, 3)) * v + sympy.Rational(k, 2))
        formulas[name] = sympy.Rational(repr(value)) * (1 + sympy.Rational(repr(_AMPLITUDE)) * wave)
    return formulas


def _admissible_values(functional: Functional) -> dict[str, float]:
    """Return values of the components of fields that meet the constraints; not too near to where they do not."""
    from ..symbolic.admissible import admissible

    own = all_components(functional.fields)
    typical = {name: value for name, value in typical_values(functional.fields).items() if name in own}
    rules = [rule for rule in functional.constraints if names_in(rule) & {*own}]

    def allowed(values: Mapping[str, float]) -> bool:
        return all(
            holds(rule, {**functional.parameters, **{name: change * value for name, value in values.items()}})
            for rule in rules
            for change in (1 - _AMPLITUDE, 1.0, 1 + _AMPLITUDE)
        )

    if allowed(typical):
        return typical
    samples = admissible(functional).sample(np.random.default_rng(0), 200)
    for k in range(200):
        values = {name: float(np.broadcast_to(samples[symbol(name)], 200)[k]) for name in own}
        if allowed(values):
            return values
    return typical


@lru_cache(maxsize=64)
def _function(
    functional: Functional, variant: Variant, derivatives: bool, module: str
) -> tuple[tuple[str, ...], Callable[..., list[Any]]]:
    """Return the names of values, with their derivatives if asked, and a function of the size and the places."""
    import sympy

    places = [symbol(name) for name in (*POSITION_NAMES, *LOGICAL_NAMES)]
    found: dict[str, Expr] = {}
    for name, formula in _formulas(functional, variant).items():
        found[name] = formula
        pair = places[:2] if formula.has(*places[:2]) else places[2:]
        for first in pair if derivatives else ():
            found[f"{name}_{first}"] = slope = sympy.diff(formula, first)
            if pair == places[:2]:
                found |= {f"{name}_{''.join(sorted(f'{first}{other}'))}": sympy.diff(slope, other) for other in pair}
    return tuple(found), sympy.lambdify([symbol("size"), *places], list(found.values()), module)
