"""Fields: numbers over the grid that a density may name, from formulas, functions, arrays or samples."""

from .field import Field as Field
from .field import as_field as as_field
from .sampled import SampledField as SampledField
from .sampled import grid_field as grid_field
from .sampled import raster_field as raster_field
from .sampled import scattered_field as scattered_field
from .weight import Weight as Weight
