"""Tests of gridgen_sym.grids; a package, so that test files elsewhere may have the same names."""
