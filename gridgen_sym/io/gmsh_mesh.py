"""Meshes of Gmsh (.msh) as they are stored: versions 2.2 and 4.1, text and binary, in either order of bytes.

Source: https://gmsh.info/doc/texinfo/gmsh.html#MSH-file-format
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..errors import GridgenError, quoted
from .gmsh_numbers import Bytes, Indices, Numbers, Words

_SECTION = re.compile(rb"\$(\w+)[ \t]*\r?\n")
_NAME = re.compile(r'(\d+)\s+(\d+)\s+"(.*)"')
#: Numbers of nodes by the type of an element: points, and complete lines and quadrilaterals of the orders 1 to 5.
_NODES = {15: 1, 1: 2, 8: 3, 26: 4, 27: 5, 28: 6, 3: 4, 10: 9, 36: 16, 37: 25, 38: 36}
#: What other types are, for messages.
_OTHERS = {2: "a triangle", 9: "a triangle", 16: "a quadrilateral without inner nodes", 4: "a solid", 5: "a solid"}


class Group(NamedTuple):
    """Elements of one type on one curve or surface.

    Attributes:
        type: of the elements.
        entity: the tag of the curve or surface.
        physical: the tags of the physical groups that it belongs to.
        nodes: the tags of their nodes, (elements, nodes).
    """

    type: int
    entity: int
    physical: tuple[int, ...]
    nodes: Indices


@dataclass(frozen=True, slots=True)
class GmshMesh:
    """A mesh as a file has it.

    Attributes:
        tags: of the nodes.
        points: (nodes, 3).
        groups: the elements.
        names: of physical groups, by dimension and tag.
    """

    tags: Indices
    points: Array
    groups: tuple[Group, ...]
    names: Mapping[tuple[int, int], str]


def decode_mesh(data: bytes) -> GmshMesh:
    """Return the mesh of a file.

    Raises:
        GridgenError: for another kind of file, another version, or elements other than points, lines and
            quadrilaterals.
    """
    sections = _sections(data)
    version, order = _format(sections)

    def numbers(name: str) -> Numbers:
        content = sections.get(name)
        if content is None:
            raise GridgenError(f"it has no section ${name}")
        return Bytes(content, order) if order else Words(content.split())

    try:
        if version == "2.2":
            tags, points = _nodes_2(numbers("Nodes"))
            groups = list(_elements_2(numbers("Elements"), binary=bool(order)))
        else:
            physical = _physical(numbers("Entities")) if "Entities" in sections else {}
            tags, points = _nodes_4(numbers("Nodes"))
            groups = list(_elements_4(numbers("Elements"), physical))
    except (ValueError, IndexError, OverflowError) as error:
        if isinstance(error, GridgenError):
            raise
        raise GridgenError(f"it is cut short, or no mesh of Gmsh: {error}") from error
    return GmshMesh(tags, points, tuple(groups), _names(sections.get("PhysicalNames", b"")))


def _sections(data: bytes) -> dict[str, bytes]:
    """Return the content of each section; the end of one is looked for behind its beginning."""
    found: dict[str, bytes] = {}
    at = 0
    while match := _SECTION.search(data, at):
        name = match[1]
        end = data.find(b"$End" + name, match.end())
        if end < 0:
            raise GridgenError(f"it is cut short: its section ${name.decode()} does not end")
        found.setdefault(name.decode(), data[match.end() : end])
        at = end + len(name) + 4
    return found


def _format(sections: Mapping[str, bytes]) -> tuple[str, str]:
    """Return the version, and the order of bytes; nothing for a text."""
    line, _, rest = sections.get("MeshFormat", b"").partition(b"\n")
    words = line.decode("ascii", "replace").split()
    if len(words) != 3 or words[0] not in ("2.2", "4.1") or words[1] not in ("0", "1") or words[2] != "8":
        raise GridgenError(
            "it must be a mesh of Gmsh, version 2.2 or 4.1: a line such as '4.1 0 8' after $MeshFormat; came "
            f"{quoted(' '.join(words))}: let Gmsh write it with Mesh.MshFileVersion = 4.1"
        )
    if words[1] == "0":
        return words[0], ""
    if rest[:4] not in (b"\1\0\0\0", b"\0\0\0\1"):
        raise GridgenError("the number 1 that tells the order of bytes of a binary mesh is missing after its version")
    return words[0], "<" if rest[0] else ">"


def _names(content: bytes) -> dict[tuple[int, int], str]:
    """Return the names of physical groups."""
    matches = (_NAME.match(line.strip()) for line in content.decode("utf-8", "replace").splitlines())
    return {(int(match[1]), int(match[2])): match[3] for match in matches if match}


def _nodes_2(numbers: Numbers) -> tuple[Indices, Array]:
    return numbers.rows(_count(numbers), 3)


def _count(numbers: Numbers) -> int:
    """Return the number on the first line of a section of version 2.2, which is text in binary files, too."""
    if isinstance(numbers, Words):
        return int(numbers.integers(1)[0])
    assert isinstance(numbers, Bytes)
    line, _, numbers.data = numbers.data.partition(b"\n")
    return int(line)


def _elements_2(numbers: Numbers, *, binary: bool) -> Iterator[Group]:
    """Yield the elements of a file of version 2.2; the first two tags are the physical group and the entity."""
    found: dict[tuple[int, int, int], list[Indices]] = {}
    left = _count(numbers)
    while left > 0:
        if binary:
            kind, count, tags = numbers.integers(3).tolist()
        else:
            (_, kind, tags), count = numbers.integers(3).tolist(), 1
        nodes = _nodes_of(kind)
        # In a text the number of an element stands before its type.
        rows = numbers.integers(count * (binary + tags + nodes)).reshape(count, -1)[:, int(binary) :]
        for row in rows:
            key = (kind, *(int(row[k]) if k < tags else 0 for k in (1, 0)))
            found.setdefault(key, []).append(row[tags:])
        left -= count if count > 0 else left
    for (kind, entity, physical), nodes_of in found.items():
        yield Group(kind, entity, (physical,) if physical else (), np.stack(nodes_of))


def _physical(numbers: Numbers) -> dict[tuple[int, int], tuple[int, ...]]:
    """Return the tags of the physical groups of points, curves and surfaces, by dimension and tag."""
    found = {}
    counts = numbers.tags(4).tolist()
    for dimension in range(3):
        for _ in range(counts[dimension]):
            tag = int(numbers.integers(1)[0])
            numbers.reals(6 if dimension else 3)
            found[dimension, tag] = tuple(numbers.integers(int(numbers.tags(1)[0])).tolist())
            if dimension:
                numbers.integers(int(numbers.tags(1)[0]))
    return found


def _nodes_4(numbers: Numbers) -> tuple[Indices, Array]:
    tags, points = [np.empty(0, dtype=np.int64)], [np.empty((0, 3))]
    for _ in range(int(numbers.tags(4)[0])):
        dimension, _, parametric = numbers.integers(3).tolist()
        count = int(numbers.tags(1)[0])
        tags.append(numbers.tags(count))
        width = 3 + (dimension if parametric else 0)
        points.append(numbers.reals(count * width).reshape(count, width)[:, :3])
    return np.concatenate(tags), np.concatenate(points)


def _elements_4(numbers: Numbers, physical: Mapping[tuple[int, int], tuple[int, ...]]) -> Iterator[Group]:
    for _ in range(int(numbers.tags(4)[0])):
        dimension, entity, kind = numbers.integers(3).tolist()
        count, nodes = int(numbers.tags(1)[0]), _nodes_of(kind)
        rows = numbers.tags(count * (1 + nodes)).reshape(count, 1 + nodes)
        yield Group(kind, entity, tuple(map(abs, physical.get((dimension, entity), ()))), rows[:, 1:])


def _nodes_of(kind: int) -> int:
    """Return how many nodes an element has."""
    if kind not in _NODES:
        raise GridgenError(
            f"it has elements of type {kind} ({_OTHERS.get(kind, 'another kind')}): only meshes of complete "
            "quadrilaterals in the plane can be layouts. Recombine triangles (Mesh.RecombineAll = 1), and let Gmsh "
            "save what belongs to physical groups only (Mesh.SaveAll = 0)"
        )
    return _NODES[kind]
