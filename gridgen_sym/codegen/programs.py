"""Which programs a functional's kernels need, made from its derived equations."""

from __future__ import annotations

from collections.abc import Mapping

import sympy
from sympy import Expr, Symbol

from ..functionals.definition import Functional
from ..symbolic.classify.classification import equation_type, is_null_lagrangian
from ..symbolic.coordinates import (
    DIRECTION,
    FIRST_DERIVATIVES,
    POSITION_DIRECTION,
    SECOND_DERIVATIVES,
    J,
    Variant,
    s,
    s_eta,
    s_x,
    s_xi,
    s_xx,
    s_xy,
    s_y,
    s_yy,
)
from ..symbolic.derive.continuous import EulerLagrange, euler_lagrange, residual_slopes
from ..symbolic.derive.discrete import CornerModel, corner_model, has_barrier
from .facts import KernelFacts, definition_digest, kernel_name
from .interface import FUNCTIONS
from .kernel import Kernel, Program
from .lower import lower

#: Planes of values, by variant: the weight, and its derivatives where it is differentiated through.
PLANES: Mapping[Variant, tuple[Symbol, ...]] = {
    "plain": (),
    "frozen": (s,),
    "differentiated": (s, s_x, s_y, s_xx, s_xy, s_yy),
    "regularized": (),
}


def kernel(functional: Functional, variant: Variant = "plain") -> Kernel:
    """Derive and lower every program of a functional in one variant."""
    model = corner_model(functional, variant)
    programs = _corner_programs(model)
    if variant != "regularized":
        programs += _euler_lagrange_programs(euler_lagrange(functional, variant), model.parameters)
    named = {program.name: program for program in programs}
    facts = KernelFacts(
        name=kernel_name(functional.name, variant),
        functional=functional.name,
        variant=variant,
        density=str(functional.expression()),
        digest=definition_digest(functional),
        parameters=tuple(symbol.name for symbol in model.parameters),
        planes=tuple(symbol.name for symbol in PLANES[variant]),
        sloped=("s",) if variant == "frozen" else (),
        moving=variant == "differentiated",
        barrier=has_barrier(functional),
        equation_type=equation_type(functional),
        null_lagrangian=variant == "plain" and is_null_lagrangian(functional),
        polyconvex=model.splitting.holds,
        functions=tuple(name for name, signature in FUNCTIONS.items() if signature.program in named),
        operations={name: dict(program.operations) for name, program in named.items()},
    )
    return Kernel(facts, named)


def _corner_programs(model: CornerModel) -> list[Program]:
    inputs = (*FIRST_DERIVATIVES, *PLANES[model.variant])
    energy: dict[str, Expr] = {"energy": model.energy, "jacobian": J}
    moving = model.variant == "differentiated"
    position = {f"p{k}": entry for k, entry in enumerate(model.position_gradient)} if moving else {}
    # The chain rule from the metric to the nodes belongs to the templates, which share it among the corners of a cell.
    slopes = energy | {f"slope_{symbol}": slope for symbol, slope in model.slopes.items()} | position
    gradient = energy | {f"d{k}": entry for k, entry in enumerate(model.gradient)} | position
    direction = (*FIRST_DERIVATIVES, *DIRECTION, *(POSITION_DIRECTION if moving else ()), *PLANES[model.variant])
    along = {f"d{k}": entry for k, entry in enumerate(model.hessian_vector)}
    if moving:
        along |= {f"p{k}": entry for k, entry in enumerate(model.position_hessian_vector)}
    products = [lower("corner_hessian_vector", direction, model.parameters, along)]
    if model.splitting.holds:
        semidefinite = {f"d{k}": entry for k, entry in enumerate(model.semidefinite_hessian_vector)}
        products.append(lower("corner_semidefinite_vector", direction, model.parameters, semidefinite))
    return [
        *([lower("moved", (*POSITION_DIRECTION, *PLANES[model.variant]), (), _moved(model))] if moving else []),
        lower("corner_energy", inputs, model.parameters, energy),
        lower("corner_slopes", inputs, model.parameters, slopes),
        lower("corner_hessian", inputs, model.parameters, gradient | _hessian_entries(model, model.hessian)),
        lower(
            "corner_semidefinite",
            inputs,
            model.parameters,
            _matrix_entries(model.semidefinite_hessian if model.splitting.holds else model.hessian),
        ),
        *products,
    ]


def _moved(model: CornerModel) -> dict[str, Expr]:
    """Return the values at a node that has moved a little, to second order, by name."""
    v_x, v_y = POSITION_DIRECTION
    moved = {symbol: symbol for symbol in PLANES[model.variant]}
    moved[s] = s + s_x * v_x + s_y * v_y + (s_xx * v_x**2 + 2 * s_xy * v_x * v_y + s_yy * v_y**2) / 2
    return {f"moved_{symbol}": value for symbol, value in moved.items()}


def _matrix_entries(matrix: sympy.Matrix) -> dict[str, Expr]:
    """Return the 10 entries of a symmetric 4x4 matrix by name, row by row of the upper triangle."""
    return {f"h{row}{column}": matrix[row, column] for row in range(4) for column in range(row, 4)}


def _hessian_entries(model: CornerModel, matrix: sympy.Matrix) -> dict[str, Expr]:
    entries = _matrix_entries(matrix)
    if model.variant == "differentiated":
        entries |= {f"c{row}{k}": model.position_cross[row, k] for row in range(4) for k in range(2)}
        entries |= {f"q{row}{k}": model.position_hessian[row, k] for row, k in ((0, 0), (0, 1), (1, 1))}
    return entries


def _euler_lagrange_programs(equations: EulerLagrange, parameters: tuple[Symbol, ...]) -> list[Program]:
    """Return the programs of the residual, its slopes, and its frozen coefficients.

    Where the system has been reduced to a simpler one with the same solutions, that one is solved.
    """
    weight = PLANES[equations.variant] + ((s_xi, s_eta) if equations.variant == "frozen" else ())
    inputs = (*FIRST_DERIVATIVES, *SECOND_DERIVATIVES, *weight)
    system = equations.reduction.system if equations.reduction else equations.residual
    residual = {"r_x": system[0], "r_y": system[1]}
    slopes = {
        f"{component}_{variable}": pair[row]
        for variable, pair in residual_slopes(system).items()
        for row, component in enumerate("xy")
    }
    second = {
        key: value for key, value in slopes.items() if key[2:] in {str(variable) for variable in SECOND_DERIVATIVES}
    }
    position = _position_slopes(system) if equations.variant == "differentiated" else {}
    return [
        lower("residual", inputs, parameters, residual),
        lower("residual_slopes", inputs, parameters, residual | slopes | position),
        lower("residual_coefficients", inputs, parameters, residual | second),
    ]


def _position_slopes(system: tuple[Expr, Expr]) -> dict[str, Expr]:
    """Return the derivatives of the residual in the node's own position, through the weight.

    The third derivatives of the weight are left out: they would need ten planes of it, and Newton's method
    converges without them, a little slower.
    """
    along = {"x": {s: s_x, s_x: s_xx, s_y: s_xy}, "y": {s: s_y, s_x: s_xy, s_y: s_yy}}
    return {
        f"{component}_{direction}": sum(
            (sympy.diff(part, variable) * slope for variable, slope in chain.items()), sympy.S.Zero
        )
        for direction, chain in along.items()
        for component, part in zip("xy", system, strict=True)
    }
