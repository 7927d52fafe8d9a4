"""Which programs a functional's kernels need, made from its derived equations."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import partial

import sympy
from sympy import Expr, Symbol

from ..functionals.definition import Functional
from ..functionals.metric import RESERVED_NAMES
from ..functionals.variant import Modes
from ..symbolic.classify.classification import equation_type, is_null_lagrangian
from ..symbolic.classify.invariance import scaling_degree
from ..symbolic.coordinates import (
    DIRECTION,
    FIRST_DERIVATIVES,
    METRIC,
    POSITION_DIRECTION,
    SECOND_DERIVATIVES,
    Variant,
)
from ..symbolic.derive.continuous import EulerLagrange, euler_lagrange
from ..symbolic.derive.discrete import CornerModel, corner_model, has_barrier
from ..symbolic.derive.mixed import MixedModel, mixed_model
from ..symbolic.derive.solved_equations import solved_equations
from .facts import KernelFacts, definition_digest, kernel_name
from .interface import FUNCTIONS
from .kernel import Kernel, Program
from .lower import lower


def kernel(functional: Functional, variant: Variant = "plain") -> Kernel:
    """Derive and lower every program of a functional in one variant."""
    if Modes.read(variant).mixed:
        return _mixed_kernel(functional, variant)
    model = corner_model(functional, variant)
    programs = _corner_programs(model)
    if not Modes.read(variant).regularized:
        programs += _euler_lagrange_programs(euler_lagrange(functional, variant), model.parameters)
    named = {program.name: program for program in programs}
    facts = KernelFacts(
        name=kernel_name(functional.name, variant),
        functional=functional.name,
        variant=variant,
        density=str(functional.expression()),
        digest=definition_digest(functional),
        parameters=tuple(symbol.name for symbol in model.parameters),
        planes=tuple(symbol.name for symbol in model.values.planes),
        sloped=tuple(symbol.name for symbol in model.values.sloped),
        moving=model.values.moving,
        barrier=has_barrier(functional),
        equation_type=equation_type(functional),
        null_lagrangian=not model.values.planes and is_null_lagrangian(functional),
        polyconvex=model.splitting.holds,
        degree=_degree(model),
        functions=tuple(name for name, signature in FUNCTIONS.items() if signature.program in named),
        operations={name: dict(program.operations) for name, program in named.items()},
    )
    return Kernel(facts, named)


def _mixed_kernel(functional: Functional, variant: Variant) -> Kernel:
    """Derive and lower the mixed derivatives; what solvers ask of a kernel is not decided."""
    model = mixed_model(functional, variant)
    moving, planes = model.values.moving, model.values.planes
    inputs = (*FIRST_DERIVATIVES, *DIRECTION, *(POSITION_DIRECTION if moving else ()), *planes)
    outputs = {f"m{k}": entry for k, entry in enumerate(model.along.values())}
    program = lower("corner_mixed", inputs, model.parameters, outputs, fields=_of_user(planes))
    facts = KernelFacts(
        name=kernel_name(functional.name, variant),
        functional=functional.name,
        variant=variant,
        density=str(functional.expression()),
        digest=definition_digest(functional),
        parameters=tuple(symbol.name for symbol in model.parameters),
        planes=tuple(symbol.name for symbol in planes),
        sloped=(),
        moving=moving,
        barrier=False,
        equation_type="",
        null_lagrangian=False,
        polyconvex=False,
        degree=_degree(model),
        functions=("mixed",) if outputs else (),
        operations={program.name: dict(program.operations)},
    )
    return Kernel(facts, {program.name: program})


def _degree(model: CornerModel | MixedModel) -> float | None:
    """Return the degree of a corner's energy in its edge vectors; None where it is not known to be homogeneous."""
    known = {*FIRST_DERIVATIVES, *METRIC, *model.values.planes, *model.parameters}
    degree = scaling_degree(model.energy) if model.energy.free_symbols <= known else None
    return None if degree is None else float(degree)


def _corner_programs(model: CornerModel) -> list[Program]:
    moving, planes = model.values.moving, model.values.planes
    inputs = (*FIRST_DERIVATIVES, *planes)
    energy: dict[str, Expr] = {"energy": model.energy}
    position = {f"p{k}": entry for k, entry in enumerate(model.position_gradient)} if moving else {}
    # The chain rule from the metric to the nodes belongs to the templates, which share it among the corners of a cell.
    slopes = energy | {f"slope_{symbol}": slope for symbol, slope in model.slopes.items()} | position
    gradient = energy | {f"d{k}": entry for k, entry in enumerate(model.gradient)} | position
    direction = (*FIRST_DERIVATIVES, *DIRECTION, *(POSITION_DIRECTION if moving else ()), *planes)
    along = {f"d{k}": entry for k, entry in enumerate(model.hessian_vector)}
    if moving:
        along |= {f"p{k}": entry for k, entry in enumerate(model.position_hessian_vector)}
    make = partial(lower, fields=_of_user(planes))
    products = [make("corner_hessian_vector", direction, model.parameters, along)]
    if model.splitting.holds:
        semidefinite = {f"d{k}": entry for k, entry in enumerate(model.semidefinite_hessian_vector)}
        products.append(make("corner_semidefinite_vector", direction, model.parameters, semidefinite))
    return [
        *([make("moved", (*POSITION_DIRECTION, *planes), (), _moved(model))] if moving else []),
        make("corner_energy", inputs, model.parameters, energy),
        make("corner_slopes", inputs, model.parameters, slopes),
        make("corner_hessian", inputs, model.parameters, gradient | _hessian_entries(model, model.hessian)),
        make(
            "corner_semidefinite",
            inputs,
            model.parameters,
            _matrix_entries(model.semidefinite_hessian if model.splitting.holds else model.hessian),
        ),
        *products,
    ]


def _of_user(values: Iterable[Symbol]) -> tuple[Symbol, ...]:
    """Return the values whose names a user has chosen: the components of fields, and their derivatives."""
    return tuple(value for value in values if value.name not in RESERVED_NAMES)


def _moved(model: CornerModel) -> dict[str, Expr]:
    """Return the values at a node that has moved a little, to second order, by name."""
    v_x, v_y = POSITION_DIRECTION
    return {f"moved_{symbol}": value for symbol, value in model.values.moved((v_x, v_y)).items()}


def _matrix_entries(matrix: sympy.Matrix) -> dict[str, Expr]:
    """Return the 10 entries of a symmetric 4x4 matrix by name, row by row of the upper triangle."""
    return {f"h{row}{column}": matrix[row, column] for row in range(4) for column in range(row, 4)}


def _hessian_entries(model: CornerModel, matrix: sympy.Matrix) -> dict[str, Expr]:
    entries = _matrix_entries(matrix)
    if model.values.moving:
        entries |= {f"c{row}{k}": model.position_cross[row, k] for row in range(4) for k in range(2)}
        entries |= {f"q{row}{k}": model.position_hessian[row, k] for row, k in ((0, 0), (0, 1), (1, 1))}
    return entries


def _euler_lagrange_programs(equations: EulerLagrange, parameters: tuple[Symbol, ...]) -> list[Program]:
    """Return the programs of the residual, its slopes, and its frozen coefficients.

    Where the system has been reduced to a simpler one with the same solutions, that one is solved.
    """
    values = equations.values
    inputs = (*FIRST_DERIVATIVES, *SECOND_DERIVATIVES, *values.planes, *values.slopes)
    parts = solved_equations(equations)
    residual, with_coefficients = (
        dict(zip(("r_x", "r_y"), pair, strict=True)) for pair in (parts.residual, parts.residual_by_coefficients)
    )
    coefficients, slopes = _by_row(parts.coefficients), _by_row(parts.slopes)
    make = partial(lower, fields=_of_user((*values.planes, *values.slopes)), names=parts.definitions)
    return [
        make("residual", inputs, parameters, residual),
        make("residual_slopes", inputs, parameters, residual | slopes | coefficients),
        make("residual_coefficients", inputs, parameters, with_coefficients | coefficients),
    ]


def _by_row(slopes: Mapping[Symbol, tuple[Expr, Expr]]) -> dict[str, Expr]:
    """Return the slopes of the residuals by name, such as x_y_xi of that of x in y_xi."""
    return {f"{'xy'[row]}_{variable}": pair[row] for variable, pair in slopes.items() for row in (0, 1)}
