"""Write generated files, each whole or not at all, or show how those on the disk differ."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator
from pathlib import Path

from ..atomic import write_bytes
from .source import Source


def write_sources(folder: Path, sources: Iterable[Source]) -> list[Path]:
    """Write the files whose text differs, and return their paths."""
    changed = []
    for source in sources:
        path = folder / source.path
        if not path.exists() or path.read_bytes() != source.text.encode():
            path.parent.mkdir(parents=True, exist_ok=True)
            write_bytes(path, source.text.encode())
            changed.append(path)
    return changed


def difference(folder: Path, label: str, path: str, text: str, *, known: str = "on disk") -> Iterator[str]:
    """Yield the lines of a unified diff from a file on the disk to its text; nothing where they agree.

    Args:
        folder: where the file is.
        label: how the diff calls this folder.
        path: of the file in it.
        text: what it should be; empty if it should not exist.
        known: what the diff calls the file on the disk.
    """
    file = folder / path
    old = file.read_bytes().decode(errors="replace") if file.exists() else ""
    yield from difflib.unified_diff(
        old.splitlines(keepends=True),
        text.splitlines(keepends=True),
        f"{label}/{path} ({known})",
        f"{label}/{path} (derived now)",
    )
