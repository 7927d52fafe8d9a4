"""What a package uses of one that stands to its right: the face names how to load it, and it is loaded when used."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

_loaders: dict[str, Callable[[], Any]] = {}


def provide(name: str, load: Callable[[], Any]) -> None:
    """Say how a package is loaded."""
    _loaders[name] = load


def provided(name: str) -> Any:  # noqa: ANN401 - a module
    """Return a package."""
    return _loaders[name]()
