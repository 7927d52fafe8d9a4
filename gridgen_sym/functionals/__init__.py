"""Functionals: each one is a formula, written once. Everything else is derived from it."""

from . import library as library
from .definition import Functional as Functional
from .definition import define as define
from .definition import functional as functional
from .definition import functionals as functionals
from .definition import is_builtin as is_builtin
