"""What the project derives in the place of a printed equation of the paper, as an item of a report."""

from __future__ import annotations

import sympy

from ...functionals import functional
from ...functionals.paper import PrintedEquation
from ..coordinates import METRIC, J, s
from ..derive.continuous import euler_lagrange
from ..derive.discrete import corner_model, variant_density
from ..report.sections import Divergence, Quasilinear, divergence_form, expanded_form
from ..report.tidy import tidy
from .notation import read

Counterpart = Divergence | Quasilinear | tuple[str, "sympy.Expr | sympy.Matrix"]


def counterpart(printed: PrintedEquation) -> Counterpart | None:
    """Return the derived equation that a printed one is compared with; None for a claim in words."""
    name = printed.functional
    match printed.kind:
        case "equation" if name:
            derived = euler_lagrange(functional(name), "plain")
            form = divergence_form if "D_xi" in printed.expressions[0] else expanded_form
            return form(derived, printed.component)
        case "sum" if name:
            weighted = read(printed.expressions[0]).has(s)
            return ("E", corner_model(functional(name), "frozen" if weighted else "plain").energy)
        case "integral" | "parameters" if name:
            return ("F", variant_density(functional(name), "plain"))
        case "jacobian":
            return (J.name, METRIC[J])
        case "equality":
            return _left_side(printed)
    return None


def _left_side(printed: PrintedEquation) -> Counterpart | None:
    """Return the left side of an equality in the derivatives of the map, where it can be written on one line."""
    left = read(printed.expressions[0])
    if isinstance(left, sympy.MatrixBase) or sympy.count_ops(left) > 20:
        return None
    return ("left", tidy(left).subs(METRIC) if left.is_Symbol else tidy(left))
