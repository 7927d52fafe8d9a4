"""Classify a functional: everything is decided from its density, nothing from its name.

Parameters have their default values, but for polyconvexity, which is decided for all that are admissible. Claims
about the type hold where J > 0, that is on valid grids, and away from kinks.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import sympy
from sympy import Expr, Symbol

from ...functionals.definition import Functional
from ...functionals.field_kinds import typical_values
from ...functionals.metric import INVERSE_TARGET_NAMES, symbol
from ...functionals.variant import Modes
from ..admissible import admissible
from ..coordinates import (
    FIRST_DERIVATIVES,
    Variant,
    differentiate,
    epsilon,
    expand_metric,
    s,
    x_eta,
    x_xi,
    y_eta,
    y_xi,
)
from ..definiteness import Definiteness
from ..derive.continuous import euler_lagrange
from ..derive.discrete import corner_model, has_barrier, variant_density
from ..values import values_of
from .at_points import vanishes, varies
from .bounds import LowerBound, lower_bound
from .ellipticity import Ellipticity, ellipticity, proved_by_operator
from .invariance import (
    is_exchange_symmetric,
    is_logical_rotation_invariant,
    is_rotation_invariant,
    reparametrization_degrees,
    scaling_degree,
)
from .kinks import kinks
from .principal_symbol import determinant, principal_symbol
from .random_jets import Type, sampled_type


@dataclass(frozen=True, slots=True)
class Classification:
    """What kind of functional it is, and what kind of Euler–Lagrange equations it has.

    Attributes:
        functional: what was classified.
        variant: how the weight enters.
        linear: whether the Euler–Lagrange equations are linear in x and y; else they are quasilinear.
        coupled: whether the equation of x contains y, or vice versa.
        symbol: the 2x2 principal symbol A(k) in k1 and k2.
        determinant: of the principal symbol, in the metric symbols where it can be written in them.
        ellipticity: the type where J > 0, and how it is known.
        null_lagrangian: whether the Euler–Lagrange equations vanish identically.
        translation: whether the energy of a translated map is the same.
        rotation: whether that of a rotated map is.
        scaling_degree: k, if the map c·(x, y) has c^k times the density; None if there is no such k.
        exchange: whether exchanging xi and eta, with a reflection that keeps J's sign, changes nothing.
        reparametrization_degrees: the degrees of the density in g1 and in g2, None where it has none.
        lower_bound: a lower bound of the density where J > 0, the greatest one where that was proved.
        barrier: whether the density tends to infinity as J tends to zero from above.
        polyconvex: whether P(A, J) is convex where J > 0, at all admissible parameters, and how that is known.
        kinks: expressions at whose zeros the first derivatives of the density jump or do not exist, where J > 0; the
            equations, and their type, are those elsewhere.
    """

    functional: Functional
    variant: Variant
    linear: bool
    coupled: bool
    symbol: sympy.Matrix
    determinant: Expr
    ellipticity: Ellipticity
    null_lagrangian: bool
    translation: bool
    rotation: bool
    scaling_degree: Expr | None
    exchange: bool
    reparametrization_degrees: tuple[Expr | None, Expr | None]
    lower_bound: LowerBound
    barrier: bool
    polyconvex: Definiteness
    kinks: tuple[Expr, ...]

    def words(self) -> tuple[str, ...]:
        """Return the classification in the words of the field."""
        return _words(linear=self.linear, coupled=self.coupled, kind=self.ellipticity.type)


def equation_words(functional: Functional) -> tuple[str, ...]:
    """Return the same words as `Classification.words`, from the equations alone: quickly, since nothing is proved."""
    defaults = _defaults(functional)
    matrix = principal_symbol(variant_density(functional, "plain").subs(defaults))
    rest = _rest(functional, "plain", defaults)
    moves = values_of(functional, "plain").moving
    return _words(
        linear=not moves and _is_linear(matrix, rest),
        coupled=moves or _is_coupled(matrix, rest),
        kind=equation_type(functional),
    )


def _words(*, linear: bool, coupled: bool, kind: Type) -> tuple[str, ...]:
    return "linear" if linear else "quasilinear", "coupled" if coupled else "uncoupled", kind


def equation_type(functional: Functional) -> Type:
    """Return the type of the Euler–Lagrange equations as random points show it, at the default parameters."""
    density = variant_density(functional, "plain").subs(admissible(functional).of_fields(functional))
    return sampled_type(principal_symbol(density.subs(_defaults(functional))))


def is_null_lagrangian(functional: Functional) -> bool:
    """Return whether every grid with the same boundary has the same energy, whatever the parameters; without a weight.

    The Euler–Lagrange equations vanish then. Such a density is J and the first derivatives times constants, whose sum
    over the corners of a grid depends on the boundary nodes alone, as its integral does on the boundary.
    """
    density = variant_density(functional, "plain")
    # abs(J) is as good as J where J > 0, and there only.
    if values_of(functional, "plain").planes:  # Values differ from corner to corner.
        return False
    return bool(expand_metric(density).is_polynomial(*FIRST_DERIVATIVES)) and _is_zero(principal_symbol(density))


def _judged_at(functional: Functional) -> dict[Symbol, float]:
    """Return the numbers at which kinks are looked for: default parameters, typical fields and places, no target."""
    values = dict(functional.parameters) | typical_values(functional.fields)
    values |= dict(zip(INVERSE_TARGET_NAMES, (1.0, 0.0, 0.0, 1.0), strict=True))
    return {symbol(name): value for name, value in values.items()}


def _defaults(functional: Functional) -> dict[Symbol, Expr]:
    return {symbol(name): sympy.nsimplify(value, rational=True) for name, value in functional.parameters.items()}


@lru_cache(maxsize=64)
def classify(functional: Functional, variant: Variant = "plain") -> Classification:
    """Classify a functional, with its parameters at their defaults; once per process."""
    defaults = _defaults(functional)
    density = variant_density(functional, variant).subs(defaults)
    matrix = principal_symbol(density)
    rest = _rest(functional, variant, defaults)
    rotates, degree = is_rotation_invariant(density), scaling_degree(density)
    moves = values_of(functional, variant).moving
    allowed = admissible(functional).of_fields(functional)
    judged = density.subs(allowed).subs(defaults)
    positive = s, epsilon
    kind = ellipticity(
        principal_symbol(judged) if functional.fields else matrix,
        rotates=rotates,
        turns=is_logical_rotation_invariant(density),
        positive=positive,
    )
    kind = replace(kind, witness=_in_declared_names(kind.witness, allowed))
    operator = euler_lagrange(functional, variant).operator if functional.fields else None
    if operator is not None:
        signs = [part.subs(allowed).subs(defaults) for part in (operator.determinant, operator.discriminant)]
        kind = proved_by_operator(kind, signs[0], signs[1], positive)
    bends = kinks(variant_density(functional, variant), _judged_at(functional))
    return Classification(
        functional=functional,
        variant=variant,
        linear=not moves and _is_linear(matrix, rest),
        coupled=moves or _is_coupled(matrix, rest),
        symbol=matrix,
        determinant=determinant(matrix, rotates=rotates),
        ellipticity=kind,
        null_lagrangian=not bends and _is_zero(matrix) and _is_zero(rest),
        translation=not moves,
        rotation=rotates and not moves,
        scaling_degree=None if moves else degree,
        exchange=is_exchange_symmetric(density),
        reparametrization_degrees=reparametrization_degrees(density),
        lower_bound=lower_bound(judged, rotates=rotates, degree=degree),
        barrier=has_barrier(functional) and not Modes.read(variant).regularized,
        polyconvex=corner_model(functional, variant).splitting,
        kinks=bends,
    )


def _in_declared_names(
    witness: tuple[tuple[Symbol, Expr], ...], allowed: dict[Symbol, Expr]
) -> tuple[tuple[Symbol, Expr], ...]:
    """Return a witness with the components of fields instead of the symbols that stood for them."""
    values = dict(witness)
    used = {one for meaning in allowed.values() for one in meaning.free_symbols} - allowed.keys()
    own = [
        (name, meaning.xreplace(values).xreplace(dict.fromkeys(used, sympy.S.One)))
        for name, meaning in sorted(allowed.items(), key=lambda item: str(item[0]))
        if witness
    ]
    return (*own, *((name, value) for name, value in witness if name not in used))


def _rest(functional: Functional, variant: Variant, defaults: dict[sympy.Symbol, Expr]) -> sympy.Matrix:
    """Return what is of lower order in the Euler–Lagrange equations; nothing, where there are no values."""
    if not values_of(functional, variant).planes:
        return sympy.zeros(2, 1)
    return sympy.Matrix(euler_lagrange(functional, variant).rest).subs(defaults)


def _is_zero(matrix: sympy.Matrix) -> bool:
    """Return whether a matrix vanishes for all jets."""
    return all(entry == 0 or (vanishes(entry) and sympy.expand(expand_metric(entry)) == 0) for entry in matrix)


def _is_linear(matrix: sympy.Matrix, rest: sympy.Matrix) -> bool:
    """Return whether the coefficients are free of x and y, and the rest linear in their derivatives."""
    entries = [*matrix, *(differentiate(part, p) for part in rest for p in FIRST_DERIVATIVES)]
    return not varies(entries, FIRST_DERIVATIVES)


def _is_coupled(matrix: sympy.Matrix, rest: sympy.Matrix) -> bool:
    """Return whether either equation contains the other unknown."""
    if not _is_zero(sympy.Matrix([matrix[0, 1]])):
        return True
    return varies((matrix[0, 0], rest[0]), (y_xi, y_eta)) or varies((matrix[1, 1], rest[1]), (x_xi, x_eta))
