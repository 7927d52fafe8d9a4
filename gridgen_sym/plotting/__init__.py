"""Pictures of grids and of certificates, with Matplotlib (extra `plot`), and pages for a browser."""

from .certificates import plot_certificates as plot_certificates
from .grids import plot_grid as plot_grid
from .grids import plot_grids as plot_grids
from .view import view_grid as view_grid
