"""The formats of grid files: found by listing the folder `formats`, and looked up by suffix or by name."""

from __future__ import annotations

import os
import pkgutil
from collections.abc import Iterable, Mapping
from functools import cache
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from types import MappingProxyType

from ..atomic import check_folder, check_target, file_name, read_start, shown
from ..errors import GridgenError, MissingExtraError, quoted
from . import formats
from .format import Format, Storage

#: Descriptions of layouts, which have no nodes of blocks: another function reads them.
_DESCRIPTIONS = (".toml", ".mesh", ".msh")


@cache
def known_formats() -> Mapping[str, Format]:
    """Return the formats by their names: those of the modules in the folder `formats`, in alphabetical order."""
    found = sorted(module.name for module in pkgutil.iter_modules(formats.__path__))
    return MappingProxyType({name: import_module(f"{formats.__name__}.{name}").FORMAT for name in found})


def known_suffixes(*, written: bool = False) -> list[str]:
    """Return the suffixes of the grid files that can be read, or of those that can be written."""
    usable = [form for form in known_formats().values() if (form.encode if written else form.decode)]
    return list(dict.fromkeys(suffix for form in usable for suffix in form.suffixes))


def suffix_of(path: str | os.PathLike[str]) -> str:
    """Return the suffix of a path in lower case; of a folder that has the name of a suffix and no other, this one."""
    file = Path(file_name(path))
    bare = f".{file.name.lower()}"
    folders = [form for form in known_formats().values() if form.storage is Storage.FOLDER]
    return bare if any(bare in form.suffixes for form in folders) else file.suffix.lower()


def format_for(path: str | os.PathLike[str], form: str, *, written: bool) -> tuple[Format, frozenset[str]]:
    """Return the format of a file, and the words that select a variant of it.

    Args:
        path: the file; its suffix selects the format, or its first bytes where several have this suffix.
        form: words between blanks: the name of a format, and variants that the format has.
        written: whether the file is to be written.

    Raises:
        GridgenError: for an unknown suffix, a word that is neither a format nor one of its variants, or a format that
            is only read or only written.
    """
    words = form.split()
    named = [word for word in words if word in known_formats()]
    if len(named) > 1:
        raise GridgenError(f"a file has one format; came {' and '.join(named)}")
    chosen = known_formats()[named[0]] if named else _by_suffix(path, written=written)
    variants = frozenset(words) - {*named}
    for word in sorted(variants - chosen.forms.keys()):
        known = ", ".join(chosen.forms) or "none"
        raise GridgenError(
            f"unknown form {quoted(word)} of a {chosen.name}: its forms are {known}; formats are "
            f"{', '.join(known_formats())}"
        )
    if not (chosen.encode if written else chosen.decode):
        raise GridgenError(
            f"cannot {'write' if written else 'read'} {shown(path)}: a {chosen.name} is only "
            f"{'read' if written else 'written'}; use one of {', '.join(known_suffixes(written=written))}"
        )
    return chosen, variants


def _by_suffix(path: str | os.PathLike[str], *, written: bool) -> Format:
    """Return the format that the suffix of a path selects; where several have it, that which recognizes the file."""
    suffix = suffix_of(path)
    fitting = [form for form in known_formats().values() if suffix in form.suffixes]
    if not fitting or (suffix in _DESCRIPTIONS and not written):
        known = ", ".join(f"{form.suffixes[0]} ({form.name})" for form in _usable(written=written))
        what = f"the suffix '{suffix}' is unknown" if suffix else "it has no suffix"
        if suffix in _DESCRIPTIONS:
            what = "it describes a layout, which gridgen_sym.read_layout reads"
        action = "write" if written else "read"
        raise GridgenError(f"cannot {action} {shown(path)}: {what}; use one of {known}")
    usable = [form for form in fitting if (form.encode if written else form.decode)] or fitting
    if written or len(usable) == 1:
        return usable[0]
    start = read_start(path)
    return next((form for form in usable if form.recognizes and form.recognizes(start)), usable[0])


def _usable(*, written: bool) -> Iterable[Format]:
    return (form for form in known_formats().values() if (form.encode if written else form.decode))


def holds_grid(path: str | os.PathLike[str]) -> bool:
    """Return whether a file is one of a grid by its suffix, and its first bytes where outlines have it, too."""
    suffix = suffix_of(path)
    fitting = [form for form in _usable(written=False) if suffix in form.suffixes]
    if not fitting or any(form.recognizes is None for form in fitting):
        return bool(fitting)
    start = read_start(path)
    return any(form.recognizes(start) for form in fitting if form.recognizes)


def check_written(path: str | os.PathLike[str], blocks: int | None = None, form: str = "") -> None:
    """Refuse, before any work is done, what cannot be written: its format, its place, or a package that it needs.

    Args:
        path: the file.
        blocks: how many blocks it is to hold; None where that is not known yet.
        form: as for `format_for`.

    Raises:
        GridgenError: for an unknown suffix, a format that holds one block where there are several, or a path at which
            no such file can be written.
        MissingExtraError: for a package that is not installed.
    """
    chosen, _ = format_for(path, form, written=True)
    if blocks is not None and blocks > 1 and not chosen.several:
        known = ", ".join(one.suffixes[0] for one in _usable(written=True) if one.several)
        raise GridgenError(
            f"cannot write {shown(path)}: a {chosen.name} holds one block, and here are {blocks}; use one "
            f"of {known}, or write each of layout.blocks"
        )
    (check_folder if chosen.storage is Storage.FOLDER else check_target)(path)
    if chosen.extra and find_spec(chosen.extra[1]) is None:
        raise MissingExtraError(f"writing a {chosen.name}", *chosen.extra)
