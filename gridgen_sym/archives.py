"""Packed data, and arrays of NumPy archives (.npz). Nothing is unpacked before its size is known."""

from __future__ import annotations

import io
import zipfile
import zlib
from typing import IO

import numpy as np

from .arrays import Array
from .errors import GridgenError, shortened

#: Data that need at most so many bytes are unpacked, whatever they were packed into.
_HARMLESS = 1 << 28
#: Coordinates of nodes that differ do not become shorter than by this factor.
_MOST_PACKED = 200
#: NumPy writes the header of an array into so many bytes at most; a damaged one may announce any number.
_HEADER = 1 << 14
#: What a damaged archive raises in the libraries that read it.
ARCHIVE_FAULTS = (
    ValueError, TypeError, OSError, EOFError, KeyError, MemoryError, NotImplementedError, RuntimeError, SyntaxError,
    zlib.error, zipfile.BadZipFile,
)  # fmt: skip


def check_packing(packed: int, unpacked: int, what: str) -> None:
    """Refuse what would fill the memory from a small file.

    Args:
        packed: bytes in the file.
        unpacked: bytes that these announce.
        what: names the data.

    Raises:
        GridgenError: if no coordinates of a grid can be packed like this.
    """
    if unpacked > _HARMLESS and unpacked > _MOST_PACKED * packed:
        raise GridgenError(
            f"{what} would need {unpacked} bytes of memory, but has {packed} in the file: no grid can be packed so "
            "tightly. If it is one, write it without compression"
        )


def read_arrays(data: bytes | IO[bytes], forms: tuple[tuple[str, ...], ...], expected: str) -> dict[str, Array]:
    """Return arrays of real numbers from a NumPy archive.

    Args:
        data: the archive, or an open file.
        forms: sets of names; the arrays of the first one that is there are read.
        expected: what the message of an error says of these.

    Raises:
        GridgenError: if the archive is damaged, holds Python objects, has none of the forms, or is packed so tightly
            that it would fill the memory.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data) if isinstance(data, bytes) else data) as archive:
            names = {name.removesuffix(".npy"): name for name in archive.namelist()}
            for form in forms:
                if names.keys() >= set(form):
                    return {name: _array(archive, names[name]) for name in form}
    except GridgenError:
        raise
    except ARCHIVE_FAULTS as error:
        raise GridgenError(
            f"it is no whole NumPy archive ({shortened(error)}); write it again with np.savez(path, {forms[0][0]}=...)"
        ) from error
    raise GridgenError(f"it holds {shortened(', '.join(names)) or 'nothing'}; {expected}")


def _array(archive: zipfile.ZipFile, name: str) -> Array:
    """Return one array of an archive, whose header must agree with what the archive announces."""
    member = archive.getinfo(name)
    if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        raise ValueError("it is compressed otherwise than NumPy does")  # LZMA may ask for gigabytes at once.
    with archive.open(member) as stream:
        head = io.BytesIO(stream.read(_HEADER))
    shape, kind = _announced(head)
    count = int(np.prod(shape, dtype=object))  # Python's whole numbers do not overflow.
    size = head.tell() + count * kind.itemsize
    if kind.kind not in "biuf":
        what = "Python objects, which are not unpickled (allow_pickle)" if kind.hasobject else f"numbers of type {kind}"
        raise ValueError(f"'{name}' holds {what}, not real numbers")
    if member.file_size != size:
        raise ValueError(f"{member.file_size} bytes are announced for {shape} numbers of type {kind}")
    check_packing(member.compress_size, size, f"the array '{name.removesuffix('.npy')}'")
    with archive.open(member) as stream:
        # Objects stay forbidden: unpickling a file from elsewhere would run its code.
        array: Array = np.lib.format.read_array(stream, allow_pickle=False)
        if stream.read(1):  # At its end the checksum is verified.
            raise ValueError("it has more bytes than announced")
    return array


def _announced(head: IO[bytes]) -> tuple[tuple[int, ...], np.dtype[np.generic]]:
    """Return the shape and the type that the header of an array announces."""
    version = np.lib.format.read_magic(head)
    read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, _, kind = read(head)
    return shape, kind
