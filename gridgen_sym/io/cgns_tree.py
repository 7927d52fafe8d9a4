"""The tree of a CGNS file on HDF5: nodes with a name, a label and data, read and written through h5py.

Every node of the CGNS tree is an HDF5 group with the attributes name, label, type and flags, and its data in the
dataset ' data', whose axes are those of Fortran: reversed.
Source: CGNS Standard Interface Data Structures 4.x, and the mapping "SIDS File Mapping Manual, HDF5" (cgns.github.io).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..archives import check_packing
from ..errors import GridgenError, MissingExtraError

_VERSION = np.array([3.1], dtype=np.float32)  # The oldest one with these nodes: older libraries read it, too.
#: Names of CGNS data types by those of NumPy.
_TYPES = {"i1": "C1", "i4": "I4", "f4": "R4", "f8": "R8"}
#: Characters that a name of a node has at most.
LONGEST_NAME = 32


def library(purpose: str) -> Any:  # noqa: ANN401 - a module
    """Return h5py.

    Raises:
        MissingExtraError: if it is not installed.
    """
    try:
        import h5py
    except ImportError as error:
        raise MissingExtraError(f"{purpose} a CGNS file", "io", "h5py") from error
    return h5py


def begin(root: Any, version: str) -> None:  # noqa: ANN401 - h5py's groups
    """Write what stands at the root of every file."""
    _describe(root, "HDF5 MotherNode", "Root Node of HDF5 File", "MT")
    root.create_dataset(" format", data=text("IEEE_LITTLE_32", 15))
    root.create_dataset(" hdf5version", data=text(f"HDF5 Version {version}", 33))
    add(root, "CGNSLibraryVersion", "CGNSLibraryVersion_t", _VERSION)


def add(parent: Any, name: str, label: str, data: NDArray[Any] | None = None) -> Any:  # noqa: ANN401
    """Add a node to the tree, with its data, if it has any, and return it."""
    group = parent.create_group(name, track_order=True)
    _describe(group, name, label, "MT" if data is None else _TYPES[data.dtype.str[1:]])
    group.attrs.create("flags", np.array([1], dtype=np.int32))
    if data is not None:
        group.create_dataset(" data", data=data)
    return group


def integers(*numbers: int | Sequence[int]) -> NDArray[np.int32]:
    """Return whole numbers as a node has them."""
    return np.array(numbers, dtype=np.int32)


def text(words: str, length: int = 0) -> NDArray[np.int8]:
    """Return text as a node has it: numbers of one byte, filled with zeros up to a length."""
    return np.frombuffer(words.encode("utf-8").ljust(length, b"\0"), dtype=np.int8)


def _describe(group: Any, name: str, label: str, kind: str) -> None:  # noqa: ANN401
    """Add the attributes that every node has, texts of fixed lengths."""
    for attribute, words, length in (("name", name, 33), ("label", label, 33), ("type", kind, 3)):
        group.attrs.create(attribute, np.bytes_(words.encode("utf-8")), dtype=f"S{length}")


def children(group: Any, label: str) -> list[Any]:  # noqa: ANN401
    """Return the nodes with a label directly below one, in the order of their ordinals, if they have any."""
    # A link into another file may lead anywhere.
    inside = [key for key in group if type(group.get(key, getlink=True)).__name__ != "ExternalLink"]
    nodes = [group[key] for key in inside if group.get(key, getclass=True).__name__ == "Group"]
    found = [node for node in nodes if bytes(node.attrs.get("label", b"")).rstrip(b"\0 ") == label.encode()]
    return sorted(found, key=_ordinal)


def _ordinal(node: Any) -> int:  # noqa: ANN401
    if "Ordinal" not in node or " data" not in node["Ordinal"]:
        return 0
    numbers = content(node["Ordinal"]).ravel()
    return int(numbers[0]) if len(numbers) else 0


def only(group: Any, label: str) -> Any:  # noqa: ANN401
    """Return the one node with a label below another."""
    nodes = children(group, label)
    if len(nodes) != 1:
        raise GridgenError(f"it has {len(nodes)} nodes of the type {label} where 1 is expected: write it again")
    return nodes[0]


def name_of(node: Any) -> str:  # noqa: ANN401
    """Return the name of a node."""
    return str(node.name).rpartition("/")[2]


def content(node: Any) -> NDArray[Any]:  # noqa: ANN401
    """Return the data of a node, which must not take more memory than its part of the file allows."""
    data = node[" data"]
    if data.dtype.kind not in "iuf":
        raise GridgenError(f"the data of {name_of(node)} are no numbers, but {data.dtype}")
    if data.external or data.is_virtual:
        raise GridgenError(f"the data of {name_of(node)} are in another file: write them into one")
    check_packing(data.id.get_storage_size(), data.nbytes, f"the array {name_of(node)}")
    found: NDArray[Any] = data[()]
    return found


def words_of(node: Any) -> str:  # noqa: ANN401
    """Return the data of a node that are text."""
    return content(node).astype(np.uint8).tobytes().decode("utf-8", errors="replace").rstrip("\0 ")
