"""Refuse densities that cannot be derived or evaluated, with what is wrong and how to repair it."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import Array
from ..errors import GridgenError, shortened
from .expression import FUNCTIONS_OF_ONE, LARGEST_EXPONENT
from .field_kinds import components, typical_values
from .metric import DENSITY_NAMES, SHAPE_NAMES, function_types, symbol, sympy_functions
from .smoothness import rough_part

if TYPE_CHECKING:
    import sympy

    from .definition import Functional

# Edge vectors (x_xi, y_xi, x_eta, y_eta) of corners with J > 0 on which every density must be real and finite.
_VALID_CORNERS = ((1, 0, 0, 1), (2, 1, -1, 1), (1, -1, 1, 3), (3, 0, 2, 1))
#: Sizes of the corners on which derivatives must exist: cells of coarse and of fine grids.
_SIZES = (1e-3, 1e-2, 0.1, 1.0, 10.0)
_COMPLEX_FUNCTIONS = {name: getattr(cmath, name) for name in FUNCTIONS_OF_ONE if name not in ("abs", "sign")} | {
    "abs": abs,
    "sign": lambda z: (z.real > 0) - (z.real < 0),
    "atan2": lambda y, x: math.atan2(y.real, x.real),
}


def check_density(functional: Functional) -> None:
    """Check that the density is a real, finite, printable expression in known symbols.

    Raises:
        GridgenError: naming the functional, the offending part and the repair.
    """
    density = functional.expression()
    _check_functions(functional, density)
    _check_powers(functional, density)
    _check_symbols(functional, density)
    for corner in _VALID_CORNERS:
        _check_value(functional, density, corner)
    _check_derivatives(functional, density)


def _check_symbols(functional: Functional, density: sympy.Expr) -> None:
    known = {symbol(name) for name in (*DENSITY_NAMES, *functional.components, *functional.parameters)}
    unknown = sorted(str(s) for s in density.free_symbols - known)
    if unknown:
        raise GridgenError(
            f"the density of functional {functional.name!r} uses the unknown symbol {unknown[0]!r}: write it in "
            f"{', '.join((*DENSITY_NAMES, *functional.components))}, or declare it as a parameter with a default "
            "value, or as a field"
        )
    unused = [name for name in functional.parameters if symbol(name) not in density.free_symbols]
    if unused:
        raise GridgenError(
            f"parameter {unused[0]!r} of functional {functional.name!r} is never used: drop it or use it"
        )
    used = {str(one) for one in density.free_symbols}
    for name, kind in functional.fields.items():
        if used.isdisjoint(components(name, kind)):
            raise GridgenError(f"field {name!r} of functional {functional.name!r} is never used: drop it or use it")
    if used.isdisjoint(SHAPE_NAMES):
        raise GridgenError(
            f"the density of functional {functional.name!r} is {density}: it does not depend on the shape of cells; "
            "name the metric, such as J"
        )


def _check_functions(functional: Functional, density: sympy.Expr) -> None:
    import sympy

    if density.has(sympy.I) or density.has(sympy.nan, sympy.oo, sympy.zoo):
        raise GridgenError(f"the density of functional {functional.name!r} is not real and finite: {density}")
    arithmetic = (sympy.Symbol, sympy.Rational, sympy.Add, sympy.Mul, sympy.Pow, type(sympy.pi), type(sympy.E))
    allowed = (*arithmetic, *function_types())
    for part in sympy.preorder_traversal(density):
        if not isinstance(part, allowed):
            raise GridgenError(
                f"the density of functional {functional.name!r} uses {type(part).__name__}, for which there is no "
                f"kernel: use + - * / **, {', '.join(sorted(sympy_functions()))}"
            )


def _check_powers(functional: Functional, density: sympy.Expr) -> None:
    import sympy

    for power in density.atoms(sympy.Pow):
        if power.exp.is_Rational and abs(power.exp) > LARGEST_EXPONENT:
            raise GridgenError(
                f"the density of functional {functional.name!r} contains a power with an exponent of more than "
                f"{LARGEST_EXPONENT} in size: lower it"
            )


def _check_value(functional: Functional, density: sympy.Expr, corner: tuple[int, int, int, int]) -> None:
    """Evaluate in complex floats, in which every density takes a moment; exact numbers may grow without bound."""
    import sympy

    values = {name: complex(value) for name, value in sample_values(corner)}
    values |= {symbol(name): complex(value) for name, value in typical_values(functional.fields).items()}
    values |= {symbol(name): complex(default) for name, default in functional.parameters.items()}
    try:
        signed = density.replace(sympy.sign, sympy.Function("sign"))  # SymPy prints its own for real numbers only.
        number = complex(sympy.lambdify(list(values), signed, [_COMPLEX_FUNCTIONS])(*values.values()))
        came = f"{number.real if number.imag == 0 else number:.6g}"
    except (ArithmeticError, ValueError) as error:
        number, came = complex("nan"), f"without a value ({error})"
    if abs(number.imag) > 1e-12 * abs(number) or not abs(number) < float("inf"):
        raise GridgenError(
            f"the density of functional {functional.name!r} is {came} on the valid corner with edge vectors "
            f"g1 = {corner[:2]}, g2 = {corner[2:]}{_at(functional)}: it must be real and finite wherever J > 0"
        )


def _at(functional: Functional) -> str:
    """Return the values of what else the density names, for a message."""
    used = functional.expression().free_symbols
    values = typical_values(functional.fields)
    return "".join(f", {name} = {value:g}" for name, value in values.items() if symbol(name) in used)


def _check_derivatives(functional: Functional, density: sympy.Expr) -> None:
    """Refuse a density without derivatives in a whole region, such as the root of max(0, .); a kink is allowed."""
    corners = _random_corners()
    rough = rough_part(density, corners, dict(functional.parameters) | typical_values(functional.fields))
    if rough is None:
        return
    a, b, c, d = corners[:, rough.corners.argmax()]
    what = "first" if rough.order == 1 else "second"
    raise GridgenError(
        f"the density of functional {functional.name!r} has no {what} derivative on the valid corner with edge vectors "
        f"g1 = ({a:.3g}, {b:.3g}), g2 = ({c:.3g}, {d:.3g}), nor near it, because of the term {shortened(rough.part)}: "
        "keep what stands under a root or a broken power above 0, for example by adding 1e-12 to it, or square it, "
        "or choose: where(u > 0, sqrt(u), 0)"
    )


def _random_corners() -> Array:
    """Return edge vectors of corners with J > 0, (4, n): of many sizes, and on no kink but by chance."""
    random = np.random.default_rng(11)
    corners = random.normal(size=(4, 25 * len(_SIZES)))
    corners[2:] *= np.where(corners[0] * corners[3] < corners[1] * corners[2], -1, 1)
    corners *= np.repeat(_SIZES, 25)
    return corners


def sample_values(corner: tuple[int, int, int, int]) -> Iterator[tuple[Any, Any]]:
    """Yield (symbol, exact value) of every name of the metric for a corner's edge vectors, with s = 1."""
    import sympy

    x_xi, y_xi, x_eta, y_eta = (sympy.Integer(value) for value in corner)
    values = {
        "x_xi": x_xi, "y_xi": y_xi, "x_eta": x_eta, "y_eta": y_eta, "s": sympy.Integer(1),
        "g11": x_xi**2 + y_xi**2, "g22": x_eta**2 + y_eta**2, "g12": x_xi * x_eta + y_xi * y_eta,
        "J": x_xi * y_eta - x_eta * y_xi,
    }  # fmt: skip
    values |= {"t11": values["g11"], "t22": values["g22"], "t12": values["g12"], "tau": values["J"]}
    for name, value in values.items():
        yield symbol(name), value
