"""Solvers: they hold kernels and grids, and no algebra of any functional.

`newton` minimizes over all nodes at once, `local` over one at a time, and `equations` solves the Euler–Lagrange
equations; `multilevel` gives them their starts, `untangling` makes these valid, and `linear` solves their linear
systems. `layout` does the same for several blocks. `run` holds what all share: deadline, progress, result.
"""

from .airfoil import airfoil_grid as airfoil_grid
from .continuation import ContinuationResult as ContinuationResult
from .continuation import continuation as continuation
from .equations.euler_lagrange import solve_euler_lagrange as solve_euler_lagrange
from .evaluate import energy as energy
from .evaluate import gradient as gradient
from .evaluate import hessian as hessian
from .layout.result import LayoutResult as LayoutResult
from .optimize import optimize as optimize
from .optimize import untangle as untangle
from .run.result import Result as Result
from .run.result import Step as Step
from .run.status import Status as Status
from .run.status import StopReason as StopReason
