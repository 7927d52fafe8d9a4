"""A functional of my own."""

import gridgen_sym as gg


def smooth(m, k=0.1):
    """Winslow's smoothness with a little orthogonality."""
    return (m.g11 + m.g22) / m.J + k * m.g12**2 / m.J**2


gg.define("smooth", smooth, constraints=("k >= 0",))
