"""Tests of gridgen_sym.ocean; a package, so that test files elsewhere may have the same names."""
