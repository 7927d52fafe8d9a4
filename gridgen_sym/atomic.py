"""Whole files or none: reading and writing bytes, with errors that name the repair."""

from __future__ import annotations

import contextlib
import errno
import io
import os
import secrets
import shutil
import stat
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import BinaryIO

from .errors import GridgenError, quoted, shortened

#: What a file is to hold, in one or in pieces.
Content = bytes | Iterable[bytes]
#: Bytes that suffice to tell the kind of a file.
_START = 4096


def shown(path: str | os.PathLike[str]) -> str:
    """Return a path for a message; no path in use is cut."""
    return shortened(os.fspath(path), 500)


def file_name(path: str | os.PathLike[str]) -> str:
    """Return the text of a path.

    Raises:
        GridgenError: for what is no path; a number would be the file that a process has open under it.
    """
    try:
        text = os.fspath(path)
    except TypeError:
        text = None
    if not isinstance(text, str) or "\0" in text:
        raise GridgenError(f"a file name must be text or a path, but is {quoted(path)}")
    return text


def write_bytes(path: str | os.PathLike[str], data: Content, mode: int | None = None) -> None:
    """Write a file so that `path` holds either what it held before or all of `data`, at every moment.

    The data go to a new file in the same folder, are flushed to the disk, and are then renamed over `path`;
    if anything fails, the new file is removed again. A file that is replaced keeps its permissions. A symbolic link
    is followed, not replaced. A character device, and a pipe that is being read, are written to.

    Args:
        path: the file.
        data: its content, in one or in pieces.
        mode: its permissions; by default those of the file that is replaced, or what the user's umask leaves.

    Raises:
        GridgenError: if the folder is missing or may not be written to, the disk is full, the file is read-only, or
            `path` is a folder or another thing that is no file.
    """
    target = check_target(path)
    try:
        _check_link(Path(path))
        old = target.lstat() if os.path.lexists(target) else None  # A link that still is one is circular.
        if old is None or stat.S_ISREG(old.st_mode):
            _replace(target, data, mode, old)
        else:
            _pour(target, data, old.st_mode)
    except OSError as error:
        raise GridgenError(
            f"cannot write {shown(path)}: {error.strerror or error}; check the permissions and the free space of "
            "its folder, or write elsewhere"
        ) from error


def write_folder(path: str | os.PathLike[str], files: Mapping[str, Content]) -> None:
    """Write a folder of files so that `path` holds either what it held before or all of the new ones.

    The files go to a new folder beside it, which then takes its place. An old folder is removed; it must hold nothing
    but files with the suffixes of the new ones or, where these have none, with their names.

    Args:
        path: the folder.
        files: the contents, by their names.

    Raises:
        GridgenError: if the folder holds other files, or cannot be written.
    """
    folder = Path(os.path.realpath(path))
    known = {Path(name).suffix or name for name in files}
    new, old = (folder.parent / f".gridgen-{os.getpid()}-{secrets.token_hex(6)}.tmp" for _ in range(2))
    try:
        if os.path.lexists(folder):
            _check_replaceable(folder, known)
        new.mkdir()
        for name, data in files.items():
            _replace(new / name, data, None, None)
        if folder.is_dir():
            folder.rename(old)
        new.rename(folder)
    except OSError as error:
        if old.is_dir() and not folder.is_dir():
            old.rename(folder)
        raise GridgenError(
            f"cannot write the folder {shown(path)}: {error.strerror or error}; check the permissions and the free "
            "space there, or write elsewhere"
        ) from error
    finally:
        for left in (new, old):
            shutil.rmtree(left, ignore_errors=True)


def check_folder(path: str | os.PathLike[str]) -> None:
    """Check that a folder can be written at a path, as far as can be seen.

    Raises:
        GridgenError: if a file has this name, or the folder around it is missing or without permission.
    """
    folder = Path(os.path.realpath(file_name(path)))
    if not os.path.isdir(folder.parent):
        raise GridgenError(f"cannot write {shown(path)}: the folder {folder.parent} does not exist; make it first")
    if os.path.lexists(folder) and not os.path.isdir(folder):
        raise GridgenError(f"cannot write the folder {shown(path)}: a file has this name; remove it first")
    if not os.access(folder.parent, os.W_OK):
        denied = os.strerror(errno.EACCES)
        raise GridgenError(
            f"cannot write {shown(path)}: {denied}; check the permissions of the folder around it, or write elsewhere"
        )


def _pieces(data: Content) -> Iterable[bytes]:
    return (data,) if isinstance(data, bytes) else data


def _check_replaceable(folder: Path, known: set[str]) -> None:
    """Refuse to replace what holds anything but files of these suffixes, or names."""
    if not folder.is_dir():
        raise GridgenError(f"cannot write the folder {shown(folder)}: a file has this name; remove it first")
    for inside in sorted(folder.iterdir()):
        if (inside.suffix or inside.name) not in known or not inside.is_file() or inside.is_symlink():
            raise GridgenError(
                f"cannot replace the folder {shown(folder)}: it also holds {quoted(inside.name)}, which was not "
                "written here; move that, or write elsewhere"
            )


def check_target(path: str | os.PathLike[str]) -> Path:
    """Return the file that a path leads to, once it is known that one can be written there, as far as can be seen.

    Raises:
        GridgenError: if it is a folder or read-only, or its folder is missing or without permission.
    """
    target = Path(os.path.realpath(file_name(path)))
    if os.path.isdir(target):  # Unlike Path.is_dir, never an error, not even for a name too long.
        raise GridgenError(f"cannot write {shown(path)}: it is a folder; name a file in it")
    if not os.path.isdir(target.parent):
        raise GridgenError(f"cannot write {shown(path)}: the folder {target.parent} does not exist; make it first")
    exists = os.path.lexists(target)
    # A file is replaced by a new one in its folder; a device or a pipe is written to.
    places = [(target, "the file")] * exists + [(target.parent, "its folder")] * (not exists or target.is_file())
    for place, what in places:
        if not os.access(place, os.W_OK):
            denied = os.strerror(errno.EACCES)
            raise GridgenError(
                f"cannot write {shown(path)}: {denied}; check the permissions of {what}, or write elsewhere"
            )
    return target


def _check_link(path: Path) -> None:
    """Refuse a symbolic link that another user has laid in a folder for everyone, such as /tmp, as Linux does."""
    if not path.is_symlink() or not hasattr(os, "geteuid"):
        return
    folder = path.parent.stat()
    everyone = folder.st_mode & stat.S_ISVTX and folder.st_mode & stat.S_IWOTH
    if everyone and path.lstat().st_uid not in (os.geteuid(), folder.st_uid):
        raise GridgenError(
            f"cannot write {shown(path)}: it is another user's symbolic link in a folder for everyone; name the file "
            "itself"
        )


def _replace(target: Path, data: Content, mode: int | None, old: os.stat_result | None) -> None:
    """Write a new file beside `target` and rename it over that; `old` is what is known of the present one."""
    temporary = target.parent / f".gridgen-{os.getpid()}-{secrets.token_hex(6)}.tmp"
    try:
        # Not tempfile: its files are closed to everyone else, whatever the user's umask is.
        with temporary.open("xb") as stream:
            _set_permissions(stream, mode, old)
            stream.writelines(_pieces(data))
            stream.flush()
            os.fsync(stream.fileno())
        temporary.replace(target)
    finally:  # After the rename there is nothing to remove; after an error or an interrupt there is.
        with contextlib.suppress(OSError):
            temporary.unlink(missing_ok=True)


def _set_permissions(stream: BinaryIO, mode: int | None, old: os.stat_result | None) -> None:
    """Give a new file the permissions `mode`, or else those of the old one and, as far as we may, its owner."""
    if not hasattr(os, "fchmod"):  # Windows.
        return
    if mode is not None:
        os.fchmod(stream.fileno(), mode)
    elif old is not None:
        with contextlib.suppress(OSError):
            os.fchown(stream.fileno(), old.st_uid, old.st_gid)
        os.fchmod(stream.fileno(), stat.S_IMODE(old.st_mode) & 0o777)


def _pour(target: Path, data: Content, mode: int) -> None:
    """Write to a character device, or to a pipe that some program reads."""
    if not (stat.S_ISCHR(mode) or stat.S_ISFIFO(mode)):
        raise GridgenError(f"cannot write {shown(target)}: it is neither a file nor a device that takes characters")
    try:
        # Without waiting: a pipe that nobody reads would hold us up for ever.
        number = os.open(target, os.O_WRONLY | os.O_NONBLOCK | os.O_NOCTTY)
    except OSError as error:
        if error.errno == errno.ENXIO and stat.S_ISFIFO(mode):
            raise GridgenError(
                f"cannot write {shown(target)}: no program reads that pipe; start its reader first"
            ) from error
        raise
    os.set_blocking(number, True)
    with open(number, "wb") as stream:
        stream.writelines(_pieces(data))


def read_bytes(path: str | os.PathLike[str]) -> bytes:
    """Return the bytes of a file, of which there must be some.

    Raises:
        GridgenError: if the file is missing, a folder, a device, without permission, or empty.
    """
    with opened(path) as stream:
        return stream.read()


def read_start(path: str | os.PathLike[str]) -> bytes:
    """Return the first bytes of a file, which tell what kind it is of.

    Raises:
        GridgenError: if the file is missing, a folder, a device or without permission.
    """
    with _opened(path) as stream:
        return stream.read(_START)


@contextlib.contextmanager
def opened(path: str | os.PathLike[str]) -> Iterator[BinaryIO]:
    """Open a file at its beginning, which must hold more than blanks; what comes from a pipe is read first.

    Raises:
        GridgenError: as for `read_bytes`.
    """
    with _opened(path) as file:
        stream = file if file.seekable() else io.BytesIO(file.read())
        while not (piece := stream.read(_START)).strip():
            if not piece:
                raise GridgenError(f"cannot read {shown(path)}: the file is empty; write it again")
        stream.seek(0)
        yield stream


@contextlib.contextmanager
def _opened(path: str | os.PathLike[str]) -> Iterator[BinaryIO]:
    try:
        status = os.stat(file_name(path))
        if stat.S_ISCHR(status.st_mode) or stat.S_ISBLK(status.st_mode):  # Such as /dev/zero, which has no end.
            raise GridgenError(f"cannot read {shown(path)}: it is a device; name a file")
        with Path(path).open("rb") as stream:
            yield stream
    except FileNotFoundError as error:
        raise GridgenError(f"cannot read {shown(path)}: there is no such file; check its name and folder") from error
    except IsADirectoryError as error:
        raise GridgenError(f"cannot read {shown(path)}: it is a folder; name a file in it") from error
    except OSError as error:
        raise GridgenError(f"cannot read {shown(path)}: {error.strerror or error}; check its permissions") from error
