"""gridgen_sym: structured quadrilateral grids from variational functionals.

A functional is written once, as a formula; its equations, kernels and solvers are derived, printed, compiled
or solved from it:

    functionals -> symbolic -> codegen -> generated/ -> runtime -> solvers -> files, pictures
    one formula    exact       kernels    committed     compiled   grids
                   derivatives as data    source        or NumPy

Example:
    >>> import gridgen_sym as gg
    >>> result = gg.optimize(gg.domain("swan", 41, 41), "winslow")
    >>> result.converged, result.quality.folded_cells
    (True, 0)
"""

__version__ = "0.1.0"

from .adaptation import AdaptResult as AdaptResult
from .adaptation import AdaptStep as AdaptStep
from .adaptation import Equidistribution as Equidistribution
from .adaptation import Monitor as Monitor
from .adaptation import adapt as adapt
from .adaptation import equidistribution as equidistribution
from .adaptation import hierarchical_error as hierarchical_error
from .adaptation import interpolation_error as interpolation_error
from .adaptation import recover_gradient as recover_gradient
from .adaptation import recover_hessian as recover_hessian
from .adaptation import recovery_error as recovery_error
from .adaptation import richardson_error as richardson_error
from .adaptation import transfer as transfer
from .errors import GridgenError as GridgenError
from .functionals import Functional as Functional
from .functionals import define as define
from .functionals import functional as functional
from .functionals import functionals as functionals
from .grids import Certificate as Certificate
from .grids import Grid as Grid
from .grids import Outline as Outline
from .grids import Quality as Quality
from .grids import certificates as certificates
from .grids import domain as domain
from .grids import domain_names as domain_names
from .grids import plot_certificates as plot_certificates
from .grids import plot_grid as plot_grid
from .grids import plot_grids as plot_grids
from .grids import quality as quality
from .grids import read as read
from .grids import sliver_certificate as sliver_certificate
from .grids import transfinite as transfinite
from .grids import write as write
from .solvers import Result as Result
from .solvers import Step as Step
from .solvers import Weight as Weight
from .solvers import energy as energy
from .solvers import gradient as gradient
from .solvers import hessian as hessian
from .solvers import optimize as optimize
from .solvers import raster_field as raster_field
from .solvers import scattered_field as scattered_field
from .solvers import solve_euler_lagrange as solve_euler_lagrange
from .solvers import untangle as untangle
