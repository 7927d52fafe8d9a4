"""The formats of outlines: found by listing the folder `formats`, and looked up by suffix or by content."""

from __future__ import annotations

import os
import pkgutil
from collections.abc import Mapping
from functools import cache
from importlib import import_module
from pathlib import Path
from types import MappingProxyType

from ..atomic import file_name, read_bytes, shown
from ..errors import GridgenError, MissingExtraError
from . import formats
from .content import OutlineContent
from .format import OutlineFormat

#: What has no other suffix, and is not recognized, is text.
_PLAIN = "text"


@cache
def outline_formats() -> Mapping[str, OutlineFormat]:
    """Return the formats by their names: those of the modules in the folder `formats`, in alphabetical order."""
    found = sorted(module.name for module in pkgutil.iter_modules(formats.__path__))
    return MappingProxyType({name: import_module(f"{formats.__name__}.{name}").FORMAT for name in found})


def outline_suffixes() -> list[str]:
    """Return the suffixes of all formats; other files are read as text."""
    return list(dict.fromkeys(suffix for form in outline_formats().values() for suffix in form.suffixes))


def read_content(path: str | os.PathLike[str]) -> OutlineContent:
    """Read an outline's file, in the format that its suffix names, or that its content shows.

    Raises:
        GridgenError: if the file is missing or malformed.
        MissingExtraError: if the package is not installed that reads the format.
    """
    data = read_bytes(path)
    form = _format_of(path, data)
    try:
        return form.decode(data, Path(path))
    except MissingExtraError:
        raise
    except GridgenError as error:
        what = "" if form is outline_formats()[_PLAIN] else f" as a {form.name}"
        raise GridgenError(f"cannot read {shown(path)}{what}: {error}") from error


def is_outline(path: str | os.PathLike[str]) -> bool:
    """Return whether the content of a file shows that it is an outline, where grid files have its suffix, too."""
    data = read_bytes(path)
    return any(form.recognizes(data) for form in _with_suffix(path) if form.recognizes)


def _format_of(path: str | os.PathLike[str], data: bytes) -> OutlineFormat:
    """Return the format that recognizes a file, of those with its suffix, or else of all."""
    named = _with_suffix(path)
    seen = [form for form in named or outline_formats().values() if form.recognizes and form.recognizes(data)]
    plain = outline_formats()[_PLAIN]
    return (seen or ([] if plain in named else named) or [plain])[0]


def _with_suffix(path: str | os.PathLike[str]) -> list[OutlineFormat]:
    suffix = Path(file_name(path)).suffix.lower()
    return [form for form in outline_formats().values() if suffix in form.suffixes]
