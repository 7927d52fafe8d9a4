"""What is made once per machine and kept: many processes at once, a killed one, a full disk or a damaged file are safe.

The name of a kept file ends with the digest of its content. So a file that is not what was written is never used, and
nobody waits for anybody: of two processes that make the same thing each writes it whole, under the same name.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from functools import lru_cache
from pathlib import Path

from ..atomic import write_bytes
from ..errors import GridgenError
from ..messages import say_once


@lru_cache(maxsize=1)
def cache_folder() -> Path:
    """Return the folder of compiled kernels: GRIDGEN_SYM_CACHE, else the user's cache folder.

    Where that cannot be written, a temporary folder that lives as long as the process, and says so.
    """
    import platformdirs

    chosen = os.environ.get("GRIDGEN_SYM_CACHE")
    folder = Path(chosen) if chosen else platformdirs.user_cache_path("gridgen_sym")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return folder
    except OSError as error:
        say_once(
            f"the cache folder {folder} cannot be written ({error.strerror}): kernels are compiled again in every "
            "process; set GRIDGEN_SYM_CACHE to a folder that can"
        )
        return Path(_process_folder().name)


@lru_cache(maxsize=1)
def _process_folder() -> tempfile.TemporaryDirectory[str]:
    return tempfile.TemporaryDirectory(prefix="gridgen_sym-")


def find(stem: str, suffix: str) -> Path | None:
    """Return the file that was kept under a stem (a name, maybe in a folder), if it is as it was written."""
    for path in sorted(cache_folder().glob(f"{stem}-*{suffix}")):
        try:
            if path.name == _name(stem, path.read_bytes(), suffix):
                return path
        except OSError:  # It cannot be read: as good as none.
            continue
    return None


def keep(stem: str, suffix: str, content: bytes) -> Path:
    """Keep some content under a stem; where the disk is full, for this process only, and say so.

    Raises:
        GridgenError: if it can be written nowhere.
    """
    name = _name(stem, content, suffix)
    path = (cache_folder() / stem).with_name(name)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_bytes(path, content)
    except (GridgenError, OSError) as error:
        say_once(f"{error}: what is made now is lost with this process")
        path = Path(_process_folder().name) / name
        write_bytes(path, content)
    return path


def digest(*parts: str) -> str:
    """Return a key of some texts."""
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:24]


def _name(stem: str, content: bytes, suffix: str) -> str:
    return f"{Path(stem).name}-{hashlib.sha256(content).hexdigest()[:16]}{suffix}"
