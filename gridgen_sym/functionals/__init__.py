"""Functionals: each one is a formula, written once. Everything else is derived from it."""

from . import library as library  # isort: skip - the paper's functionals come first in lists
from . import adaptive as adaptive
from .definition import Functional as Functional
from .definition import define as define
from .definition import functional as functional
from .definition import functionals as functionals
from .definition import is_builtin as is_builtin
