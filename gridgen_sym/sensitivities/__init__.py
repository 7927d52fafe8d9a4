"""The gradient of a grid: how it changes with its boundary, weight, fields, target, walls, curves and parameters."""

from .differentiate import jvp as jvp
from .differentiate import vjp as vjp
from .gradients import Gradients as Gradients
from .slides import CurveGradient as CurveGradient
from .wall_data import WallGradient as WallGradient
