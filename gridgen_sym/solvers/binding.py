"""Bind a functional to a grid: kernels, what the density is given, fixed and sliding nodes, all checked."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from ..boundary.sides import Sides
from ..boundary.wall import Wall, check_heights, walls_by_side
from ..errors import GridgenError
from ..fields.inputs import density_inputs
from ..fields.target import Target, as_target
from ..fields.wall_cells import wall_cells
from ..fields.weight import Source, Weight, as_weight
from ..functionals.definition import Functional
from ..functionals.registry import functional as find_functional
from ..grids import Grid, corner_jacobians
from ..grids.grid import check_grid
from ..runtime import kernels
from .logical import LogicalRectangle, Spacing
from .problem import Problem
from .run.checks import check_size, fixed_mask
from .sliding.choice import make_slide


def make_problem(
    grid: Grid,
    functional: str | Functional,
    *,
    weight: Weight | Source | None = None,
    fields: Mapping[str, object] | None = None,
    target: Target | Grid | None = None,
    walls: Mapping[str, Wall] | Sides[Wall | None] | None = None,
    slide: object = None,
    fixed: npt.ArrayLike | None = None,
    parameters: Mapping[str, float] | None = None,
    interior_only: bool = False,
    guard_summed_only: bool = False,
    arrays_of: tuple[int, int] | None = None,
    spacing: Spacing | LogicalRectangle = "unit",
    backend: str | None = None,
) -> Problem:
    """Bind a functional to a grid's shape, with checked input.

    `arrays_of` is the shape of the grid that arrays of values belong to, where it is a finer one.

    Raises:
        GridgenError: for an unknown functional, bad parameters, values or spacing, or a mask of the wrong shape.
    """
    check_grid(grid)
    check_size(grid)
    definition = find_functional(functional)
    home = grid.shape if arrays_of is None else arrays_of
    asked = as_target(target, home) if walls is None else _target_of(grid, target, walls, home)
    inputs = density_inputs(
        definition, home, parameters=parameters, weight=as_weight(weight), fields=fields, target=asked
    )
    kernel_set = kernels(definition, inputs.variant, parameters, backend)
    given = inputs if kernel_set.planes else None
    steps = LogicalRectangle.of(spacing, grid.shape).steps(grid.shape)
    problem = Problem(kernel_set, fixed_mask(grid, fixed), given, bool(interior_only), guard_summed_only, steps)
    if slide is not None:
        problem.slide = make_slide(grid, slide)
    if given is not None and grid.shape == home:  # Coarser grids are only on the way.
        problem.check_samples(grid.planes, folded=not corner_jacobians(grid.x, grid.y).min() > 0)
    problem.refresh(np.ascontiguousarray(grid.planes))
    return problem


def _target_of(
    grid: Grid,
    target: Target | Grid | None,
    walls: Mapping[str, Wall] | Sides[Wall | None],
    home: tuple[int, int],
) -> Target:
    """Return the target of the cells that walls ask for."""
    if target is not None:
        raise GridgenError("walls become a target: give walls or a target, not both")
    sides = walls if isinstance(walls, Sides) else walls_by_side(walls)
    check_heights(sides, grid)
    return Target.of_cells(wall_cells(sides, grid.planes, home))
