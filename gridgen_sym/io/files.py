"""Grid files: from a path to a grid and back, in the format that the suffix selects."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np

from ..arrays import Mask
from ..atomic import check_target, opened, shown, write_bytes, write_folder
from ..errors import GridgenError, MissingExtraError
from ..grids.grid import Grid, check_grid
from ..messages import report
from .format import Blocks, Format, Storage
from .registry import check_written, format_for

if TYPE_CHECKING:
    from ..topology import MultiBlock


@overload
def read(path: str | os.PathLike[str], *, layout: Literal[True], form: str = "") -> MultiBlock: ...


@overload
def read(path: str | os.PathLike[str], *, layout: bool = False, form: str = "") -> Grid | Any: ...  # noqa: ANN401


def read(path: str | os.PathLike[str], *, layout: bool = False, form: str = "") -> Grid | MultiBlock | Any:
    """Read a grid of one or several blocks, from the kind of file that the suffix names.

    Args:
        path: the file; `gridgen-sym formats` lists the suffixes. Upper and lower case are alike.
        layout: connect the sides of a file of one block, too: the cut of a C- or O-grid. The result is a `MultiBlock`.
        form: words that select a format, or a variant of one, where suffix and content leave it open, with blanks
            between: `plot3d`, or those that `gridgen-sym formats` lists.

    Returns:
        A `Grid` for a file of one block, a `MultiBlock` for one of several. The connections and names of boundaries of
        a `MultiBlock` are those of the file, or those of the neutral map file (``.nmf``) of the same name in the same
        folder; where there are none, nodes that coincide are connected.

    Raises:
        GridgenError: for an unknown suffix, a file that is missing, empty, cut short or not of its kind,
            coordinates that are no grid, or connections that do not fit the blocks; the message names the path.
        MissingExtraError: for a format that needs a package which is not installed.
    """
    return _read(path, form, lambda blocks: layout or len(blocks.grids) > 1)


def read_as_told(path: str | os.PathLike[str], form: str = "") -> Grid | MultiBlock:
    """Read a grid; one block, too, is a `MultiBlock` where the file or the map beside it tells of names or connections.

    Args:
        path: the file.
        form: words that select a format, or a variant of one, as for `read`.

    Raises:
        GridgenError: as for `read`.
        MissingExtraError: as for `read`.
    """
    from .layouts import tells_connections

    return _read(path, form, lambda blocks: len(blocks.grids) > 1 or tells_connections(blocks, path))


def _read(path: str | os.PathLike[str], form: str, connects: Callable[[Blocks], bool]) -> Grid | MultiBlock:
    """Return the only block of a file or, if the sides of its blocks are to be connected, a layout."""
    chosen, words = format_for(path, form, written=False)
    blocks = _decoded(chosen, words, path)
    if not connects(blocks):
        return blocks.grids[0]
    from .layouts import assembled

    return assembled(blocks, path)


def _decoded(form: Format, words: frozenset[str], path: str | os.PathLike[str]) -> Blocks:
    """Return what a file holds."""
    assert form.decode  # format_for has seen to it.
    options: dict[str, Any] = {}
    if form.storage is Storage.FILE_AND_FOLDER:
        options["beside"] = lambda name: opened(Path(path).parent / name)
    given = (words,) if form.forms else ()
    with opened(path) as stream:
        data = stream if form.streamed else stream.read()
        try:
            found = form.decode(data, *given, **options)
        except MissingExtraError:
            raise
        except GridgenError as error:
            raise GridgenError(f"cannot read {shown(path)} as a {form.name}: {error}") from error
    return Blocks((found,)) if isinstance(found, Grid) else found


def read_masks(path: str | os.PathLike[str], *, form: str = "") -> dict[str, Mask]:
    """Read which nodes of a file belong to the field, and which to holes: the iblank of PLOT3D.

    Args:
        path: the file.
        form: words that select a format, or a variant of one, as for `read`.

    Returns:
        For each block by name a mask of shape (ni, nj): 0 at nodes in holes, else 1; also where the file has none.

    Raises:
        GridgenError: as for `read`.
        MissingExtraError: as for `read`.
    """
    chosen, words = format_for(path, form, written=False)
    blocks = _decoded(chosen, words | ({"holes"} & chosen.forms.keys()), path)
    masks = blocks.masks or tuple(np.ones(grid.shape, dtype=np.uint8) for grid in blocks.grids)
    return {name: mask for (name, _), mask in zip(blocks.described, masks, strict=True)}


def write(grid: Grid | MultiBlock, path: str | os.PathLike[str], *, form: str = "") -> None:
    """Write a grid to the kind of file that the suffix names, completely or not at all.

    Numbers have 17 significant digits (or are binary), so that reading gives back the same grid bit by bit.

    Args:
        grid: the grid; of a `MultiBlock` connections and names go to the file or, where its format has no place for
            them, to a neutral map file (``.nmf``) of the same name in the same folder.
        path: an existing file is replaced. `gridgen-sym formats` lists the suffixes, and which hold several blocks.
        form: words that select a format, or a variant of one, as for `read`.

    Raises:
        GridgenError: for an unknown suffix or one whose files hold one block, a boundary name that the file cannot
            hold, or a path at which no file can be written.
        MissingExtraError: for a format that needs a package which is not installed.
    """
    chosen, words, blocks, beside = _prepared(grid, path, form)
    _write(chosen, words, blocks, Path(path))
    from .layouts import map_path

    if beside is not None:
        write_bytes(map_path(path), beside)
    elif not chosen.names and map_path(path).is_file():
        report(f"{shown(map_path(path))} lies beside and is kept: remove it if it is the map of another grid")


def check_layout_written(layout: MultiBlock, path: str | os.PathLike[str]) -> None:
    """Refuse, before any work is done, a layout that a file cannot hold.

    Args:
        layout: of the blocks and names that are to be written; its nodes do not matter.
        path: the file.

    Raises:
        GridgenError: as for `write`.
        MissingExtraError: as for `write`.
    """
    form, words, blocks, _ = _prepared(layout, path, "")
    _encoded(form, words, blocks, Path(path))


def _prepared(
    grid: Grid | MultiBlock, path: str | os.PathLike[str], form: str
) -> tuple[Format, frozenset[str], Blocks, bytes | None]:
    """Return the format, its words, what it is to hold, and the neutral map that goes beside it, if any."""
    from ..topology import MultiBlock
    from .layouts import map_path

    chosen, words = format_for(path, form, written=True)
    if not isinstance(grid, MultiBlock):
        check_grid(grid)
        return chosen, words, Blocks((grid,)), None
    check_written(path, len(grid), form)
    blocks = Blocks(grid.blocks, grid.names, grid.bonds, grid.boundaries)
    if chosen.names:
        return chosen, words, blocks, None
    from . import nmf_text

    beside = nmf_text.encode(grid)
    check_target(map_path(path))
    return chosen, words, blocks, beside


def _encoded(form: Format, words: frozenset[str], blocks: Blocks, path: Path) -> Any:  # noqa: ANN401
    """Return what `encode` of a format makes of blocks."""
    assert form.encode  # format_for has seen to it.
    content = blocks if form.several else blocks.grids[0]
    given = [content, words] if form.forms else [content]
    return form.encode(*given, stem=path.stem) if form.storage is Storage.FILE_AND_FOLDER else form.encode(*given)


def _write(form: Format, words: frozenset[str], blocks: Blocks, path: Path) -> None:
    """Write blocks to a file, a folder, or a file and a folder beside it."""
    if form.storage is Storage.FILE_AND_FOLDER:
        check_target(path)
    data = _encoded(form, words, blocks, path)
    if form.storage is Storage.FILE:
        write_bytes(path, data)
    elif form.storage is Storage.FOLDER:
        write_folder(path, data)
    else:
        write_folder(path.with_suffix(""), {name: part for name, part in data.items() if name})
        write_bytes(path, data[""])
