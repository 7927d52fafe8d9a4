"""Faces of a neutral map file, which knows blocks in space, and the sides of plane blocks.

In space face 1 is k = 1, 2 is k = nk, 3 is i = 1, 4 is i = ni, 5 is j = 1, 6 is j = nj; the first range of a face runs
along the next direction after its normal in the cycle i, j, k, the second along the one after that.
"""

from __future__ import annotations

from dataclasses import dataclass

#: The direction across each pair of faces: k, i, j.
_NORMALS = (2, 0, 1)
#: A plane block is one layer of cells deep, or none.
_DEPTHS = (1, 2)
_LOW, _HIGH = ("left", "bottom"), ("right", "top")


@dataclass(frozen=True, slots=True)
class FaceRange:
    """What a face of the file is in the plane.

    Attributes:
        side: of the plane block.
        along: which of the two ranges of the face runs along the side: 0 or 1.
    """

    side: str
    along: int


@dataclass(frozen=True, slots=True)
class Frame:
    """How a plane block lies in the directions i, j, k of the file.

    Attributes:
        across: the direction in which the plane was extruded; xi and eta are the other two, in their order.
        depth: the number of nodes in it.
        plane: whether the faces are those of a file for the plane, in which i = 1, i = ni, j = 1, j = nj are 1 to 4.
    """

    across: int
    depth: int
    plane: bool = False

    def face_range(self, face: int) -> FaceRange | None:
        """Return the side that a face is, from 1; None for a face that is the plane itself."""
        normal = (face - 1) // 2 if self.plane else _NORMALS[(face - 1) // 2]
        if normal == self.across:
            return None
        others = [axis for axis in range(3) if axis != self.across]
        sides = _LOW if face % 2 else _HIGH
        cycle = ((normal + 1) % 3, (normal + 2) % 3)
        along = 0 if self.plane else cycle.index(others[1 - others.index(normal)])
        return FaceRange(sides[others.index(normal)], along)


def frame_of(sizes: tuple[int, int, int], shape: tuple[int, int], *, plane: bool) -> Frame | None:
    """Return how a plane block of a shape (ni, nj) lies in a block of these sizes; None where it does not fit."""
    for across in range(3):
        if sizes[across] in _DEPTHS and tuple(size for axis, size in enumerate(sizes) if axis != across) == shape:
            return Frame(across, sizes[across], plane)
    return None


#: NASA's own files for plane grids: one layer of cells in the direction i.
LAYER = Frame(0, 2)
_SIDES = {face: found for face in range(1, 7) if (found := LAYER.face_range(face))}
#: The face of every side of such a block, and which range of it runs along the side.
FACES = {found.side: face for face, found in _SIDES.items()}
ALONG = {found.side: found.along for found in _SIDES.values()}
#: The two faces that are the plane.
PLANE_FACES = tuple(face for face in range(1, 7) if face not in _SIDES)
