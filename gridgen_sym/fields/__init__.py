"""Fields: numbers over the grid that a density may name, from formulas, functions, arrays or samples."""

from .field import Field as Field
from .inputs import DensityInputs as DensityInputs
from .inputs import density_inputs as density_inputs
from .sampled import SampledField as SampledField
from .sampled import grid_field as grid_field
from .sampled import raster_field as raster_field
from .sampled import scattered_field as scattered_field
from .scalar import ScalarField as ScalarField
from .scalar import as_scalar as as_scalar
from .target import Target as Target
from .wall_growth import WallRemark as WallRemark
from .weight import Weight as Weight
