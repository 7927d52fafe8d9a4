"""Layouts that files describe: points, curves and blocks in TOML, or a mesh whose quadrilaterals are the blocks."""

from .read import read_layout as read_layout
from .read import read_walls as read_walls
