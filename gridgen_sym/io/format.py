"""What describes a format of grid files, and what such a file holds."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING, Any

from ..arrays import Mask
from ..grids.grid import Grid

if TYPE_CHECKING:
    from ..topology.connection import SidePart
    from ..topology.copies import Bond


class Storage(Enum):
    """How a grid lies on the disk."""

    FILE = "one file"
    FOLDER = "a folder"
    FILE_AND_FOLDER = "a file, and a folder of the same name beside it"


@dataclass(frozen=True, slots=True)
class Blocks:
    """What a grid file holds.

    Attributes:
        grids: the blocks.
        names: of the blocks; None where the file has none.
        bonds: what is connected; None where the file does not say.
        boundaries: parts of the outer boundary by name.
        masks: for each block (ni, nj) 0 at nodes in holes, else 1; None where the file has none.
    """

    grids: tuple[Grid, ...]
    names: tuple[str, ...] | None = None
    bonds: tuple[Bond, ...] | None = None
    boundaries: Mapping[str, tuple[SidePart, ...]] = field(default_factory=dict)
    masks: tuple[Mask, ...] | None = None

    @property
    def described(self) -> tuple[tuple[str, Grid], ...]:
        """The names and the grids of the blocks; a block without a name has its number."""
        names = self.names or tuple(str(number) for number in range(len(self.grids)))
        return tuple(zip(names, self.grids, strict=True))


@dataclass(frozen=True, slots=True, kw_only=True)
class Format:
    """A format of grid files.

    Attributes:
        name: in a sentence: "VTK XML structured grid".
        suffixes: of its files, in lower case; the first one is the usual one.
        decode: returns a `Grid` or `Blocks` from the bytes of a file; None where such files are only written. It
            raises `GridgenError` for everything else than a whole file of the format, and knows nothing of the disk.
            With `forms` it takes the words that the user gave as a second argument; with a folder beside the file it
            takes `beside`, which opens a file with a path relative to it, as a keyword.
        encode: returns the bytes of a file, in one or in pieces, of a `Grid` or, if the format holds several blocks, of
            `Blocks`; None where such files are only read. With `forms` it takes the user's words as a second argument.
            With a folder it returns a mapping from names of files to their bytes; the file beside a folder has the name
            "", and `encode` takes `stem`, the name of the folder, as a keyword.
        streamed: whether `decode` takes an open binary file, at its beginning, instead of its bytes.
        recognizes: whether the first bytes of a file may be those of this format, for suffixes that are also those of
            another format, or of outlines; None where the suffix suffices.
        several: whether a file can hold several blocks.
        names: whether a file holds names of boundaries and connections; otherwise these go to a neutral map file.
        storage: how it lies on the disk.
        binary: whether numbers can be read back bit by bit because they are not text.
        dimensions: what is read, of planes and volumes.
        forms: the words that select a variant, with what each means.
        extra: the extra that it needs, and the package: ("io", "h5py").
        reads: what is read beyond what is written, for the table in the documentation.
        writes: what is written.
        test: the test that shows it: "tests/io/test_cgns.py".
    """

    name: str
    suffixes: tuple[str, ...]
    decode: Callable[..., Grid | Blocks] | None
    encode: Callable[..., Any] | None
    recognizes: Callable[[bytes], bool] | None = None
    several: bool = False
    names: bool = False
    storage: Storage = Storage.FILE
    streamed: bool = False
    binary: bool = False
    dimensions: str = "a plane"
    forms: Mapping[str, str] = field(default_factory=dict)
    extra: tuple[str, str] | None = None
    reads: str = ""
    writes: str = ""
    test: str = ""
