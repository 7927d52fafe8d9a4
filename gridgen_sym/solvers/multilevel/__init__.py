"""Nested iteration: starts from coarser grids of the same boundary."""
