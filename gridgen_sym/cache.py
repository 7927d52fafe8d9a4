"""The cache of what is made once per machine; safe with many processes, a killed one, a full disk, damaged files.

The name of a kept file ends with the digest of its content. So a file that is not what was written is never used, and
no process waits for another: two that make the same thing each write it completely, under the same name.

Cached libraries run as the user: so the folder must be the user's own, and nobody else may write to it.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import re
import shlex
import stat
import tempfile
import time
from functools import lru_cache
from pathlib import Path

from .atomic import write_bytes
from .errors import GridgenError
from .messages import report_once

_DAY = 86400.0
#: Kept files are removed when nothing has used them for so many days.
_UNUSED_DAYS = 90
#: How the name of a kept file ends: a key, the digest of its content, its suffix.
_KEPT = re.compile(r"-[0-9a-f]{24}-[0-9a-f]{16}(\.\w+)?$")


@lru_cache(maxsize=1)
def cache_folder() -> Path:
    """Return the folder of compiled kernels: GRIDGEN_SYM_CACHE, else the user's cache folder.

    Where that cannot be written, a temporary folder that lives as long as the process; this is reported.

    Raises:
        GridgenError: if the folder is another user's, or others can write in it.
    """
    import platformdirs

    chosen = os.environ.get("GRIDGEN_SYM_CACHE")
    folder = Path(chosen) if chosen else platformdirs.user_cache_path("gridgen_sym")
    try:
        _make_private(folder)
        with tempfile.TemporaryFile(dir=folder):
            return folder
    except OSError as error:
        report_once(
            f"the cache folder {folder} cannot be written ({error.strerror}): kernels are compiled again in every "
            "process; set GRIDGEN_SYM_CACHE to a folder that can"
        )
        return Path(_process_folder().name)


@lru_cache(maxsize=1)
def _process_folder() -> tempfile.TemporaryDirectory[str]:
    return tempfile.TemporaryDirectory(prefix="gridgen_sym-")


def _make_private(folder: Path) -> None:
    """Make a folder in which only the user may write, or check that it is one.

    Raises:
        GridgenError: if others can change what is in it.
        OSError: if it cannot be made.
    """
    folder.parent.mkdir(parents=True, exist_ok=True)
    folder.mkdir(mode=0o700, exist_ok=True)
    status = folder.stat()
    fault = _distrust(status)
    if fault:
        shared = status.st_mode & stat.S_ISVTX  # Such as /tmp, which is meant for everyone.
        repair = "" if shared or not fault.startswith("can") else f"run  chmod go-w {shlex.quote(str(folder))}  or "
        raise GridgenError(
            f"the cache folder {folder} {fault}, and what is kept there runs in your name: {repair}set "
            "GRIDGEN_SYM_CACHE to a folder of your own"
        )


def _distrust(status: os.stat_result) -> str:
    """Return why another user (not root) can change a file or folder; empty if nobody can."""
    if not hasattr(os, "geteuid"):  # Windows, where a user's folder is private by inheritance.
        return ""
    if status.st_uid not in (0, os.geteuid()):
        return f"belongs to another user (number {status.st_uid})"
    if status.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
        return f"can be written by other users (mode {stat.S_IMODE(status.st_mode):04o})"
    return ""


def find_kept(stem: str, suffix: str) -> Path | None:
    """Return the file that was kept under a stem (a name, maybe in a folder), if it is as it was written.

    A file that others can write is ignored and made again.

    Raises:
        GridgenError: if others can write in its folder.
    """
    folder = (cache_folder() / stem).parent
    if not folder.is_dir():
        return None
    _make_private(folder)
    for path in sorted(cache_folder().glob(f"{stem}-*{suffix}")):
        try:
            if not _distrust(path.stat()) and path.name == _name(stem, path.read_bytes(), suffix):
                _mark_used(path)
                return path
        except OSError:  # It cannot be read: ignored.
            continue
    return None


def keep(stem: str, suffix: str, content: bytes) -> Path:
    """Keep some content under a stem; where the disk is full, for this process only; this is reported.

    Raises:
        GridgenError: if it can be written nowhere.
    """
    name = _name(stem, content, suffix)
    path = (cache_folder() / stem).with_name(name)
    try:
        _make_private(path.parent)
        write_bytes(path, content, mode=0o600)
        _remove_unused(path.parent)
    except (GridgenError, OSError) as error:
        report_once(f"{error}: what is made now is lost with this process")
        path = Path(_process_folder().name) / name
        write_bytes(path, content)
    return path


def _mark_used(path: Path) -> None:
    if time.time() - path.stat().st_mtime > _DAY:
        with contextlib.suppress(OSError):  # The folder may be read-only.
            os.utime(path)


def _remove_unused(folder: Path) -> None:
    """Remove what nothing has used for long: an edited formula or a new release leaves behind what it replaces."""
    for path in folder.iterdir():
        with contextlib.suppress(OSError):  # Another process may have removed it.
            if _KEPT.search(path.name) and time.time() - path.stat().st_mtime > _UNUSED_DAYS * _DAY:
                path.unlink()


def digest(*parts: str) -> str:
    """Return a key of some texts."""
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:24]


def _name(stem: str, content: bytes, suffix: str) -> str:
    return f"{Path(stem).name}-{hashlib.sha256(content).hexdigest()[:16]}{suffix}"
