"""What a format of outlines is: a name, suffixes, a decoder and a description."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from ..errors import GridgenError, MissingExtraError, shortened
from .content import OutlineContent


@dataclass(frozen=True, slots=True)
class OutlineFormat:
    """A kind of file that holds an outline.

    Attributes:
        name: of the format.
        suffixes: of its files, in lower case.
        decode: returns the content of a file's bytes; the path names files that belong to it.
        description: what is read, in a sentence without its period.
        package: the package that reads it, of the extra `geo`; empty if none is needed.
        test: the test that shows it: "tests/outlines/test_text.py::test_archives".
        recognizes: whether bytes are of this format, where the suffix does not say; None where nothing shows it.
    """

    name: str
    suffixes: tuple[str, ...]
    decode: Callable[[bytes, Path], OutlineContent]
    description: str
    package: str = ""
    test: str = ""
    recognizes: Callable[[bytes], bool] | None = None


def foreign(call: Callable[[], object], what: str) -> object:
    """Return what a call of another package returns; whatever error it raises is one of this file.

    Raises:
        GridgenError: naming `what` should have been read; damaged files raise errors of any type in readers.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # Remarks on a file of which all that counts is there.
            return call()
    except (GridgenError, MissingExtraError):
        raise
    except Exception as error:
        raise GridgenError(
            f"it is no whole {what} ({type(error).__name__}: {shortened(error)}); write it again"
        ) from error
