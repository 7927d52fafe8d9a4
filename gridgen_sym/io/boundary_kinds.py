"""What the name of a boundary says of its kind, for formats that store a kind beside the name."""

from __future__ import annotations

import re
from enum import Enum


class Kind(Enum):
    """A kind of boundary: its value is that of CGNS (BCType_t)."""

    WALL = "BCWall"
    SYMMETRY = "BCSymmetryPlane"
    FARFIELD = "BCFarfield"
    INFLOW = "BCInflow"
    OUTFLOW = "BCOutflow"
    GENERAL = "BCGeneral"


#: Words in names, as CFD programs and their users have them.
_WORDS = (
    (Kind.WALL, r"wall|viscous|tangency|solid|airfoil|plate|body|surface"),
    (Kind.SYMMETRY, r"symmetry|symmetric"),
    (Kind.FARFIELD, r"far.?field|freestream"),
    (Kind.INFLOW, r"inlet|inflow"),
    (Kind.OUTFLOW, r"outlet|outflow|back.?pressure|exit"),
)


def kind_of(name: str) -> Kind:
    """Return the kind that the name of a boundary says, such as `viscous_solid` or `far field`; else `GENERAL`."""
    return next((kind for kind, words in _WORDS if re.search(words, name, re.IGNORECASE)), Kind.GENERAL)
