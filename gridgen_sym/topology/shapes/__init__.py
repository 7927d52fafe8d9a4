"""Layouts of the shapes that people ask for, by name: one function for each."""

from . import blades as blades
from . import channels as channels
from . import holes as holes
from . import rounds as rounds
from .registry import layout as layout
from .registry import layout_description as layout_description
from .registry import layout_names as layout_names
