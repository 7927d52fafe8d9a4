"""The grid files that can be read and written: each module here is one format, found by listing this folder.

A module has the functions `decode` and `encode`, or one of them, and `FORMAT`, their description: a `Format`.
"""
