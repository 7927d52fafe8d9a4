"""Functionals: each one is a formula, written once. Everything else is derived from it."""

from . import library as library  # isort: skip - the paper's functionals come first in lists
from . import adaptive as adaptive
from . import literature as literature
from . import target_metrics as target_metrics
from .definition import Functional as Functional
from .registry import define as define
from .registry import functional as functional
from .registry import functionals as functionals
from .registry import is_builtin as is_builtin
from .registry import is_literature as is_literature
