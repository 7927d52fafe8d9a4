"""Solvers: they hold kernels and grids, and no algebra of any functional."""

from .euler_lagrange import solve_euler_lagrange as solve_euler_lagrange
from .evaluate import energy as energy
from .evaluate import gradient as gradient
from .evaluate import hessian as hessian
from .optimize import optimize as optimize
from .optimize import untangle as untangle
from .result import Result as Result
from .result import Step as Step
from .sampled import SampledField as SampledField
from .sampled import grid_field as grid_field
from .sampled import raster_field as raster_field
from .sampled import scattered_field as scattered_field
from .weight import Weight as Weight
