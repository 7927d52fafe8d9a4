"""Grid files: one module in `formats` for each format, and the registry that finds it."""

from ..grids.grid import write_grids_with
from .files import check_layout_written as check_layout_written
from .files import read as read
from .files import read_as_told as read_as_told
from .files import read_masks as read_masks
from .files import write as write
from .registry import check_written as check_written
from .registry import holds_grid as holds_grid
from .registry import known_formats as known_formats
from .registry import known_suffixes as known_suffixes

write_grids_with(write)
