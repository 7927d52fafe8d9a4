"""Run all examples of the paper into a folder."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from ..atomic import write_bytes
from ..errors import GridgenError
from ..plotting import plot_grids
from .adaptive import adaptive_area
from .comparisons import comparisons
from .report import Example, markdown, text


def run(folder: str | os.PathLike[str], say: Callable[[str], None] = print) -> tuple[Example, ...]:
    """Run Section 3 of the paper again: write its pictures and `results.md`, and say what was found.

    Args:
        folder: where the files go; made where it is missing. Files of the same names are replaced.
        say: takes lines of progress first and the table, in parts, at the end.

    Returns:
        The examples in the paper's order: their grids, numbers and claims.

    Raises:
        MissingExtraError: if Matplotlib is not installed.
        GridgenError: if the folder or a file cannot be written.
    """
    target = Path(folder)
    try:
        target.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise GridgenError(f"cannot make the folder {target}: {error.strerror or error}; name another one") from error
    examples = []
    for make in (adaptive_area, comparisons):
        for example in make(say):
            for picture in example.pictures:
                plot_grids(picture.panels, target / picture.file, columns=picture.columns)
            examples.append(example)
    write_bytes(target / "results.md", markdown(examples).encode())
    for example in examples:
        say(text(example))
    files = [picture.file for example in examples for picture in example.pictures]
    say(f"\nwritten to {target}: results.md, {', '.join(files)}")
    return tuple(examples)
