"""Adaptation: from a solution to monitors and error indicators, from those to a weight, and to a better grid."""

from .adapt import adapt as adapt
from .equidistribution import Equidistribution as Equidistribution
from .equidistribution import Spread as Spread
from .equidistribution import equidistribution as equidistribution
from .error_estimate import hierarchical_error as hierarchical_error
from .error_estimate import recovery_error as recovery_error
from .error_estimate import richardson_error as richardson_error
from .interpolation_error import interpolation_error as interpolation_error
from .monitor import Monitor as Monitor
from .recovery import recover_gradient as recover_gradient
from .recovery import recover_hessian as recover_hessian
from .result import AdaptResult as AdaptResult
from .result import AdaptStep as AdaptStep
from .result import LayoutAdaptResult as LayoutAdaptResult
from .transfer import transfer as transfer
