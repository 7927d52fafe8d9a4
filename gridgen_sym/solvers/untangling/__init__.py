"""Untangling: from a folded grid to a valid one with the same boundary nodes."""
