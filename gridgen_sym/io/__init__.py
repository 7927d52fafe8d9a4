"""Grid files: one module for each format, and the table that finds it by the suffix."""

from ..grids.grid import write_grids_with
from .files import check_holds as check_holds
from .files import known_suffixes as known_suffixes
from .files import read as read
from .files import write as write

write_grids_with(write)
