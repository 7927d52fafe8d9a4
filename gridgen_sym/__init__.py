"""gridgen_sym: structured quadrilateral grids from variational functionals."""

__version__ = "0.1.0"
