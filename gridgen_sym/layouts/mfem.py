"""Meshes of quadrilaterals in MFEM's own text format, straight or curved.

The format: https://mfem.org/mesh-formats. Nodes of curved meshes are those of continuous elements of one order: values
at the vertices, then within edges, then within elements. Edges are numbered as elements name them for the first time;
along each, values go from the vertex of the lower number to the other; within an element x goes first.
"""

from __future__ import annotations

import re

import numpy as np
import numpy.typing as npt

from ..arrays import Array
from ..errors import GridgenError, quoted
from .lagrange import lobatto_points
from .mesh import QuadrilateralMesh

_SQUARE, _SEGMENT = "3", "1"
_COLLECTION = re.compile(r"H1_2D_P(\d+)")
_SET = re.compile(r'"(.*)"\s+\d+\s+(.*)')
_NAMED_ORDERS = {"Linear": 1, "Quadratic": 2}
_SECTIONS = ("dimension", "elements", "attribute_sets", "boundary", "bdr_attribute_sets", "vertices", "nodes")


def decode(data: bytes) -> QuadrilateralMesh:
    """Return the mesh of a file.

    Raises:
        GridgenError: for another kind of file, other elements than quadrilaterals in the plane, or nodes of another
            kind.
    """
    try:
        sections = _sections(data.decode("ascii"))
        return _mesh(sections)
    except (ValueError, IndexError, KeyError) as error:
        if isinstance(error, GridgenError):
            raise
        raise GridgenError(f"it is cut short, or no mesh of MFEM: {error}") from error


def _sections(text: str) -> dict[str, list[str]]:
    """Return the lines of each section, without comments and empty lines."""
    lines = [line.partition("#")[0].strip() for line in text.splitlines()]
    lines = [line for line in lines if line]
    if not lines or not lines[0].startswith("MFEM mesh v1."):
        raise GridgenError(f"its first line must be 'MFEM mesh v1.0'; came {quoted(lines[0] if lines else '')}")
    found: dict[str, list[str]] = {}
    current: list[str] = []
    for line in lines[1:]:
        if line[0].isalpha() and line in _SECTIONS:
            current = found.setdefault(line, [])
        else:
            current.append(line)
    return found


def _mesh(sections: dict[str, list[str]]) -> QuadrilateralMesh:
    if sections["dimension"] != ["2"]:
        raise GridgenError(f"its dimension must be 2; came {' '.join(sections['dimension'])}")
    corners = np.array([row[2:] for row in _rows(sections["elements"], _SQUARE, "element", 4)], dtype=np.intp)
    edges = [(row[2:], row[0]) for row in _rows(sections["boundary"], _SEGMENT, "boundary element", 2)]
    boundary = np.array([[*ends, name] for ends, name in edges], dtype=np.intp).reshape(-1, 3)
    count = int(sections["vertices"][0])
    if corners.min() < 0 or corners.max() >= count:
        raise GridgenError(f"elements name vertices up to {corners.max()}, and there are {count}")
    if "nodes" in sections:
        order, values = _values(sections["nodes"])
    else:
        order, values = 1, np.array([line.split() for line in sections["vertices"][2 : count + 2]], dtype=float)
    lattice = _lattice(corners, count, order)
    if len(values) != lattice.max() + 1 or values.shape[1] != 2 or not np.isfinite(values).all():
        raise GridgenError(
            f"expected {lattice.max() + 1} finite nodes (x, y) of order {order}; came {len(values)} of "
            f"{values.shape[1]} numbers"
        )
    names = _set_names(sections.get("bdr_attribute_sets", []))
    return QuadrilateralMesh(corners, values[lattice], lobatto_points(order), boundary, names)


def _set_names(lines: list[str]) -> dict[int, str]:
    """Return the names of attributes from the rows of a section of sets, such as `"wall" 2 7 8`."""
    matches = (_SET.fullmatch(line) for line in lines[1:])
    return {int(attribute): match[1] for match in matches if match for attribute in match[2].split()}


def _rows(lines: list[str], shape: str, what: str, vertices: int) -> list[list[str]]:
    """Return the words of the rows of a section of elements."""
    rows = [line.split() for line in lines[1 : int(lines[0]) + 1]]
    if len(rows) != int(lines[0]):
        raise GridgenError(f"it announces {lines[0]} rows of {what}s, and has {len(rows)}")
    for number, row in enumerate(rows):
        if row[1] != shape or len(row) != 2 + vertices:
            raise GridgenError(
                f"{what} {number} is {quoted(' '.join(row))}: expected the shape {shape} with {vertices} vertices; "
                "only meshes of quadrilaterals can be layouts"
            )
    return rows


def _values(lines: list[str]) -> tuple[int, Array]:
    """Return the order of the map, and the nodes (n, 2)."""
    header = dict(line.split(": ", 1) for line in lines if ": " in line)
    name = header["FiniteElementCollection"]
    match = _COLLECTION.fullmatch(name)
    if not match and name not in _NAMED_ORDERS:
        raise GridgenError(
            f"its nodes are those of {quoted(name)}; expected {', '.join(_NAMED_ORDERS)} or H1_2D_P and an order: "
            "write the mesh with continuous nodes"
        )
    order = int(match[1]) if match else _NAMED_ORDERS[name]
    if int(header["VDim"]) != 2 or order < 1:
        raise GridgenError(f"its nodes must have 2 numbers and order 1 or more; came {header['VDim']} and {order}")
    words = [word for line in lines[1:] if ": " not in line for word in line.split()]
    numbers = np.array(words, dtype=float)
    return order, numbers.reshape(2, -1).T if int(header["Ordering"]) == 0 else numbers.reshape(-1, 2)


def _lattice(corners: npt.NDArray[np.intp], vertices: int, order: int) -> npt.NDArray[np.intp]:
    """Return the numbers of the nodes of every element, (n, order + 1, order + 1)."""
    inner = order - 1
    numbers: dict[tuple[int, int], int] = {}
    for a, b, c, d in corners.tolist():
        for one, other in ((a, b), (b, c), (c, d), (d, a)):
            numbers.setdefault((min(one, other), max(one, other)), len(numbers))
    found = np.empty((len(corners), order + 1, order + 1), dtype=np.intp)
    first_inner = vertices + inner * len(numbers)
    inside = np.arange(1, order)
    for element, (a, b, c, d) in enumerate(corners.tolist()):
        lattice = found[element]
        lattice[0, 0], lattice[-1, 0], lattice[-1, -1], lattice[0, -1] = a, b, c, d
        sides = ((a, b, (inside, 0)), (b, c, (-1, inside)), (d, c, (inside, -1)), (a, d, (0, inside)))
        for one, other, at in sides:
            first = vertices + inner * numbers[min(one, other), max(one, other)]
            along = first + np.arange(inner)
            lattice[at] = along if one < other else along[::-1]
        own = first_inner + element * inner**2 + np.arange(inner**2)
        lattice[1:-1, 1:-1] = own.reshape(inner, inner).T
    return found
