"""Solvers: they hold kernels and grids, and no algebra of any functional."""

from .euler_lagrange import solve_euler_lagrange as solve_euler_lagrange
from .optimize import energy as energy
from .optimize import gradient as gradient
from .optimize import hessian as hessian
from .optimize import optimize as optimize
from .optimize import untangle as untangle
from .result import Result as Result
from .result import Step as Step
from .weight import Weight as Weight
