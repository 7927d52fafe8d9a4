"""Blocks that are one grid: which nodes of their sides are the same, and which of them are fixed."""

from .connection import Connection as Connection
from .multiblock import MultiBlock as MultiBlock
from .quality import LayoutQuality as LayoutQuality
from .quality import quality as quality
