"""gridgen_sym: structured quadrilateral grids from variational functionals.

A functional is written once, as a formula; its equations, kernels and solvers are derived, printed, compiled
or solved from it:

    functionals -> symbolic -> codegen -> generated/ -> runtime -> solvers -> files, pictures
    one formula    exact       kernels    committed     compiled   grids
                   derivatives as data    source        or NumPy

Public names are loaded when they are first used (PEP 562), so that the import is quick.

Example:
    >>> import gridgen_sym as gg
    >>> result = gg.optimize(gg.domain("swan", 41, 41), "winslow")
    >>> result.converged, result.quality.folded_cells
    (True, 0)
"""

from __future__ import annotations

from . import startup  # noqa: F401 - before anything else: it listens to Ctrl-C

# isort: split

import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any

from .errors import GridgenError as GridgenError
from .errors import MissingExtraError as MissingExtraError
from .grids.grid import show_grids_with
from .io import read as read
from .io import read_masks as read_masks
from .io import write as write
from .later import provide
from .version import __version__ as __version__

if TYPE_CHECKING:
    from .adaptation import AdaptResult as AdaptResult
    from .adaptation import AdaptStep as AdaptStep
    from .adaptation import Equidistribution as Equidistribution
    from .adaptation import LayoutAdaptResult as LayoutAdaptResult
    from .adaptation import Monitor as Monitor
    from .adaptation import Spread as Spread
    from .adaptation import hierarchical_error as hierarchical_error
    from .adaptation import recover_gradient as recover_gradient
    from .adaptation import recover_hessian as recover_hessian
    from .adaptation import recovery_error as recovery_error
    from .adaptation import richardson_error as richardson_error
    from .adaptation.adapt import adapt as adapt
    from .adaptation.equidistribution import equidistribution as equidistribution
    from .adaptation.interpolation_error import interpolation_error as interpolation_error
    from .adaptation.transfer import transfer as transfer
    from .boundary import CornerChoice as CornerChoice
    from .boundary import Outline as Outline
    from .boundary import Wall as Wall
    from .boundary import domain as domain
    from .boundary import domain_names as domain_names
    from .boundary import first_height as first_height
    from .certificates import Certificate as Certificate
    from .certificates import certificates as certificates
    from .certificates import sliver_certificate as sliver_certificate
    from .codegen.backend import Backend as Backend
    from .codegen.backend import register_backend as register_backend
    from .fields import Field as Field
    from .fields import SampledField as SampledField
    from .fields import Target as Target
    from .fields import WallRemark as WallRemark
    from .fields import Weight as Weight
    from .fields import raster_field as raster_field
    from .fields import scattered_field as scattered_field
    from .functionals import Functional as Functional
    from .functionals import define as define
    from .functionals import functional as functional
    from .functionals import functionals as functionals
    from .geography import Projection as Projection
    from .geography import project as project
    from .grids import Change as Change
    from .grids import Deviation as Deviation
    from .grids import Grid as Grid
    from .grids import Measures as Measures
    from .grids import Quality as Quality
    from .grids import SideQuality as SideQuality
    from .grids import corner_jacobians as corner_jacobians
    from .grids import transfinite as transfinite
    from .layouts import read_layout as read_layout
    from .layouts import read_walls as read_walls
    from .ocean import OceanGrid as OceanGrid
    from .ocean import ocean_grid as ocean_grid
    from .plotting import plot_certificates as plot_certificates
    from .plotting import plot_grid as plot_grid
    from .plotting import plot_grids as plot_grids
    from .plotting import view_grid as view_grid
    from .sensitivities import CurveGradient as CurveGradient
    from .sensitivities import Gradients as Gradients
    from .sensitivities import WallGradient as WallGradient
    from .solvers import ContinuationResult as ContinuationResult
    from .solvers import LayoutResult as LayoutResult
    from .solvers import Result as Result
    from .solvers import Status as Status
    from .solvers import Step as Step
    from .solvers import StopReason as StopReason
    from .solvers import airfoil_grid as airfoil_grid
    from .solvers import energy as energy
    from .solvers import gradient as gradient
    from .solvers import hessian as hessian
    from .solvers import solve_euler_lagrange as solve_euler_lagrange
    from .solvers import untangle as untangle
    from .solvers.continuation import continuation as continuation
    from .solvers.optimize import optimize as optimize
    from .topology import Connection as Connection
    from .topology import LayoutQuality as LayoutQuality
    from .topology import MultiBlock as MultiBlock
    from .topology import quality as quality
    from .topology.shapes import layout as layout
    from .topology.shapes import layout_names as layout_names

#: The packages of the public names that are loaded when they are used.
_PACKAGES = {
    "adaptation": (
        "AdaptResult AdaptStep Equidistribution LayoutAdaptResult Monitor Spread adapt equidistribution "
        "hierarchical_error interpolation_error recover_gradient recover_hessian recovery_error richardson_error "
        "transfer"
    ),
    "boundary": "CornerChoice Outline Wall domain domain_names first_height",
    "certificates": "Certificate certificates sliver_certificate",
    "codegen.backend": "Backend register_backend",
    "fields": "Field SampledField Target WallRemark Weight raster_field scattered_field",
    "functionals": "Functional define functional functionals",
    "geography": "Projection project",
    "grids": "Change Deviation Grid Measures Quality SideQuality corner_jacobians transfinite",
    "layouts": "read_layout read_walls",
    "ocean": "OceanGrid ocean_grid",
    "plotting": "plot_certificates plot_grid plot_grids view_grid",
    "sensitivities": "CurveGradient Gradients WallGradient",
    "topology": "Connection LayoutQuality MultiBlock quality",
    "topology.shapes": "layout layout_names",
    "solvers": (
        "ContinuationResult LayoutResult Result Status Step StopReason airfoil_grid continuation energy gradient "
        "hessian optimize solve_euler_lagrange untangle"
    ),
}
_HOMES = {name: package for package, names in _PACKAGES.items() for name in names.split()}


__all__ = ["GridgenError", "MissingExtraError", "__version__", "read", "read_masks", "write", *_HOMES]


def __getattr__(name: str) -> Any:  # noqa: ANN401
    """Load a public name from its package."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(f".{_HOMES[name]}", __name__), name)


def _sensitivities() -> ModuleType:
    """Return the package that differentiates results, which call it."""
    from . import sensitivities

    return sensitivities


provide("sensitivities", _sensitivities)


def __dir__() -> list[str]:
    """Return all public names, loaded or not."""
    return sorted({*globals(), *__all__})


def _html_of(made: Any) -> str:  # noqa: ANN401
    """Return what a notebook shows of a grid; what writes it is loaded with the first one."""
    from .plotting.notebook import html_of

    return html_of(made)


show_grids_with(_html_of)


def _function(name: str) -> property:
    """Return the attribute for a function that has the name of its package, which does not take its place when loaded.

    So `import gridgen_sym.certificates as c` gives the function; `from gridgen_sym.certificates import ...` works.
    """

    def get(face: ModuleType) -> Any:  # noqa: ANN401
        return face.__dict__.get(f"_{name}") or __getattr__(name)

    def replace(face: ModuleType, value: object) -> None:
        if not isinstance(value, ModuleType):
            face.__dict__[f"_{name}"] = value

    def restore(face: ModuleType) -> None:
        face.__dict__.pop(f"_{name}", None)

    return property(get, replace, restore)


class _Face(ModuleType):
    """This package as an object."""

    certificates = _function("certificates")
    functionals = _function("functionals")


sys.modules[__name__].__class__ = _Face
