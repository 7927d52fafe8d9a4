"""Tests of gridgen_sym.outlines; a package, so that test files elsewhere may have the same names."""
