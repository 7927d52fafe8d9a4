"""Functionals: each one is a formula, written once. Everything else is derived from it."""

from . import library as library  # isort: skip - the paper's functionals come first in lists
from . import adaptive as adaptive
from .definition import Functional as Functional
from .registry import define as define
from .registry import functional as functional
from .registry import functionals as functionals
from .registry import is_builtin as is_builtin
