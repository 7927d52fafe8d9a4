"""What a density names beside the metric, in one variant: the symbols that kernels are given, and how they change.

The values of a node may move with it: those of a weight or field that is differentiated through, with its derivatives
in x and y, and the place itself. All others are held, as functions of (xi, eta).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache

import sympy
from sympy import Expr, Symbol

from ..errors import GridgenError
from ..functionals.definition import Functional
from ..functionals.field_kinds import PHYSICAL_SUFFIXES, components
from ..functionals.metric import CONTROL_NAMES, INVERSE_TARGET_NAMES, LOGICAL_NAMES, POSITION_NAMES, WEIGHT_NAME, symbol
from ..functionals.variant import Modes, Variant
from .coordinates import differentiate, eta, x, x_eta, x_xi, xi, y, y_eta, y_xi


@dataclass(frozen=True, slots=True)
class Values:
    """The symbols beside the metric, and how they change.

    Attributes:
        planes: in the order in which kernels are given them.
        in_plane: the derivatives in x and y of those that move with a node; of the first derivatives of a field, too.
        along: the derivatives along xi and eta of the values themselves.
        sloped: those whose slopes along xi and eta are given to the equations, as symbols.
    """

    planes: tuple[Symbol, ...]
    in_plane: Mapping[Symbol, tuple[Expr, Expr]]
    along: Mapping[Symbol, tuple[Expr, Expr]]
    sloped: tuple[Symbol, ...]

    @property
    def moving(self) -> bool:
        """Whether any value moves with the nodes."""
        return bool(self.in_plane)

    @property
    def slopes(self) -> tuple[Symbol, ...]:
        """The slopes along xi and eta of those in `sloped`."""
        return tuple(slope for value in self.sloped for slope in _named(value.name, "xi", "eta"))

    @property
    def derivatives(self) -> tuple[Symbol, ...]:
        """The first derivatives of values that are symbols, along xi and eta or in x and y."""
        pairs = (self.in_plane.get(value, pair) for value, pair in self.along.items())
        return tuple(dict.fromkeys(part for pair in pairs for part in pair if part.is_Symbol))

    def differentiate(self, expression: Expr, direction: int) -> Expr:
        """Differentiate in x (0) or y (1) of the node's own position, through the values that move with it."""
        return _chain(expression, {value: pair[direction] for value, pair in self.in_plane.items()})

    def differentiate_along(self, expression: Expr, direction: int) -> Expr:
        """Differentiate along xi (0) or eta (1), through all values."""
        return _chain(expression, {value: pair[direction] for value, pair in self.along.items()})

    def moved(self, step: tuple[Symbol, Symbol]) -> dict[Symbol, Expr]:
        """Return every plane where the node has moved by a small step: values to second order, derivatives as is."""
        result: dict[Symbol, Expr] = {}
        for value in self.planes:
            result[value] = value
            if value in self.along:
                for k, first in enumerate(self.in_plane.get(value, ())):
                    result[value] += first * step[k]
                    for j, second in enumerate(self.in_plane.get(first, (0, 0))):
                        result[value] += second * step[k] * step[j] / 2
        return result


def _chain(expression: Expr, slopes: Mapping[Symbol, Expr]) -> Expr:
    """Return the sum of the partial derivatives times the slopes."""
    terms = (differentiate(expression, value) * slope for value, slope in slopes.items() if slope != 0)
    return sum(terms, sympy.S.Zero)


@lru_cache(maxsize=128)
def values_of(functional: Functional, variant: Variant) -> Values:
    """Return the values that a functional names in a variant.

    The weight comes first, then the place in the plane and in the logical square, the components of declared fields,
    and those of the inverse target.
    """
    modes = Modes.read(variant)
    for name in modes.differentiated:
        if name not in functional.fields:
            raise GridgenError(
                f"functional {functional.name!r} has no field {name!r}, which the variant {variant!r} names"
            )
    named = functional.expression().free_symbols
    planes: list[Symbol] = []
    in_plane: dict[Symbol, tuple[Expr, Expr]] = {}
    along: dict[Symbol, tuple[Expr, Expr]] = {}
    sloped: list[Symbol] = []

    def add(names: Iterable[str], *, moves: bool) -> None:
        for value in map(symbol, names):
            planes.append(value)
            if not moves:
                sloped.append(value)
                first, second = _named(value.name, "xi", "eta")
                along[value] = first, second
                continue
            v_x, v_y, v_xx, v_xy, v_yy = map(symbol, (value.name + suffix for suffix in PHYSICAL_SUFFIXES))
            planes.extend((v_x, v_y, v_xx, v_xy, v_yy))
            in_plane.update({value: (v_x, v_y), v_x: (v_xx, v_xy), v_y: (v_xy, v_yy)})
            along[value] = v_x * x_xi + v_y * y_xi, v_x * x_eta + v_y * y_eta

    if modes.weight:
        add((WEIGHT_NAME,), moves=modes.weight == "differentiated")
    place = ((x, (1, 0), (x_xi, x_eta)), (y, (0, 1), (y_xi, y_eta)))
    for value, slopes, logical in place if named & {*map(symbol, POSITION_NAMES)} else ():
        planes.append(value)
        in_plane[value] = sympy.Integer(slopes[0]), sympy.Integer(slopes[1])
        along[value] = logical
    for value, unit in ((xi, (1, 0)), (eta, (0, 1))) if named & {*map(symbol, LOGICAL_NAMES)} else ():
        planes.append(value)
        along[value] = sympy.Integer(unit[0]), sympy.Integer(unit[1])
    for name, kind in functional.fields.items():
        add(components(name, kind), moves=name in modes.differentiated)
    if modes.target:
        add(INVERSE_TARGET_NAMES, moves=False)
    if modes.control:
        planes.extend(map(symbol, CONTROL_NAMES))  # In no density, so that their slopes matter nowhere.
    return Values(tuple(planes), in_plane, along, tuple(sloped))


def _named(name: str, *suffixes: str) -> tuple[Symbol, ...]:
    return tuple(symbol(f"{name}_{suffix}") for suffix in suffixes)
