"""Tests of gridgen_sym.geography; a package, so that test files elsewhere may have the same names."""
