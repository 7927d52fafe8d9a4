"""Find the equidistribution law of a weighted functional: the quantity that its extremals keep constant.

Where the density depends on J and s alone, the residual R is the cofactor matrix of the Jacobian matrix A times
a vector v: v = A^t R/J. If v is a multiple of the gradient of s^a J for some number a, the equations say that
s^a J is constant.
"""

from __future__ import annotations

from dataclasses import dataclass

import sympy
from sympy import Expr

from ...functionals.definition import Functional
from ...functionals.variant import Modes
from ..coordinates import J, Variant, expand_metric, s, x_eta, x_xi, y_eta, y_xi
from ..derive.continuous import euler_lagrange, total_derivative
from ..derive.discrete import variant_density


@dataclass(frozen=True, slots=True)
class EquidistributionLaw:
    """A^t R/J = multiplier * gradient(law) in (xi, eta), so that the extremals keep `law` constant.

    Attributes:
        law: for example s*J.
        multiplier: never zero where s > 0 and J > 0.
    """

    law: Expr
    multiplier: Expr


def equidistribution(functional: Functional, variant: Variant) -> EquidistributionLaw | None:
    """Find the law of a weighted variant, and prove it; None where there is none of the form s^a J."""
    density = variant_density(functional, variant)
    if density.free_symbols - {J, s} or not Modes.read(variant).weight:
        return None
    along_j = sympy.diff(density, J, 2)
    along_s = sympy.diff(density, J, s)
    if Modes.read(variant).weight == "differentiated":
        along_s -= sympy.diff(density, s) / J
    if along_j == 0:
        return None
    power = sympy.simplify(along_s * s / (along_j * J))
    if not power.is_number:
        return None
    law = s**power * J
    multiplier = sympy.powsimp(along_j / s**power)
    return EquidistributionLaw(law, multiplier) if _is_gradient(functional, variant, law, multiplier) else None


def _is_gradient(functional: Functional, variant: Variant, law: Expr, multiplier: Expr) -> bool:
    """Return whether A^t R/J - multiplier * gradient(law) vanishes, for both equations."""
    equations = euler_lagrange(functional, variant)
    residual = sympy.Matrix(equations.residual)
    transposed = sympy.Matrix([[x_xi, y_xi], [x_eta, y_eta]])
    for along, left in zip(("xi", "eta"), transposed * residual, strict=True):
        slope = multiplier * total_derivative(law, along, equations.values)
        positive = sympy.Symbol("s", positive=True)
        if sympy.simplify(expand_metric(left - J * slope).subs(s, positive)) != 0:
            return False
    return True
