"""Boundary nodes that slide along their curves: curves, the nodes on them, and Newton's systems with tangents."""
