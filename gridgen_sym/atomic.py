"""Whole files or none: reading and writing bytes, with errors that say what to do."""

from __future__ import annotations

import contextlib
import os
import secrets
from pathlib import Path

from .errors import GridgenError


def write_bytes(path: str | os.PathLike[str], data: bytes) -> None:
    """Write a file so that `path` holds either what it held before or all of `data`, at every moment.

    The data go to a new file in the same folder, are flushed to the disk, and are then renamed over `path`;
    if anything fails, the new file is removed again. A symbolic link is followed, not replaced.

    Raises:
        GridgenError: if the folder is missing or closed to us, the disk full, or `path` a folder.
    """
    target = Path(os.path.realpath(path))
    if os.path.isdir(target):  # Unlike Path.is_dir, never an error, not even for a name too long.
        raise GridgenError(f"cannot write {path}: it is a folder; name a file in it")
    if not os.path.isdir(target.parent):
        raise GridgenError(f"cannot write {path}: the folder {target.parent} does not exist; make it first")
    temporary = target.parent / f".gridgen-{os.getpid()}-{secrets.token_hex(6)}.tmp"
    try:
        # Not tempfile: its files are closed to everyone else, whatever the user's umask says.
        with temporary.open("xb") as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        temporary.replace(target)
    except OSError as error:
        raise GridgenError(
            f"cannot write {path}: {error.strerror or error}; check the permissions and the free space of "
            "its folder, or write elsewhere"
        ) from error
    finally:  # After the rename there is nothing to remove; after an error or an interrupt there is.
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)


def read_bytes(path: str | os.PathLike[str]) -> bytes:
    """Return the bytes of a file, of which there must be some.

    Raises:
        GridgenError: if the file is missing, a folder, closed to us, or empty.
    """
    try:
        data = Path(path).read_bytes()
    except FileNotFoundError as error:
        raise GridgenError(f"cannot read {path}: there is no such file; check its name and folder") from error
    except IsADirectoryError as error:
        raise GridgenError(f"cannot read {path}: it is a folder; name a file in it") from error
    except OSError as error:
        raise GridgenError(f"cannot read {path}: {error.strerror or error}; check its permissions") from error
    if not data.strip():
        raise GridgenError(f"cannot read {path}: the file is empty; write it again")
    return data
