"""The files from which outlines are read: each module here is one format, found by listing this folder.

A module has the function `decode`, and `FORMAT`, its description: an `OutlineFormat`.
"""
