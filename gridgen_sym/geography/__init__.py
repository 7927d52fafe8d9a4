"""Places on Earth: projections onto a plane, lengths and directions on the ellipsoid, land."""

from .land import land_at as land_at
from .projection import Projection as Projection
from .projection import project as project
