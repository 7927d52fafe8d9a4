"""What a back end is, and how one is found by its name: built in, registered, or installed as an entry point.

A back end prints kernels in its language and makes callable functions of what it has printed. It is one folder: this
package's are in `gridgen_sym/backends/`, and only `documentation` imports them; others may be anywhere.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import lru_cache
from importlib import import_module
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from ..errors import GridgenError, quoted
from .facts import KernelFacts

if TYPE_CHECKING:
    from .kernel import Kernel

#: Those of this package, in the order in which they are tried.
BUILTIN = ("c", "numpy")
#: The group of entry points in which an installed package names its back ends.
ENTRY_POINTS = "gridgen_sym.backends"

Function = Callable[..., None]


@runtime_checkable
class Backend(Protocol):
    """One back end: it prints kernels, and loads them.

    Printing may load SymPy and Jinja2; all the rest must not, since a solver does not need them.

    Attributes:
        name: what `backend=` and GRIDGEN_SYM_BACKEND call it; also its folder in `generated/`, if it has one.
        suffix: of its source files, with the dot.
    """

    name: str
    suffix: str

    def missing(self) -> str:
        """Return what this machine lacks to run it, with the repair; an empty text where it lacks nothing."""
        ...

    def render(self, kernel: Kernel) -> str:
        """Return the source of a kernel."""
        ...

    def load(self, facts: KernelFacts, source: str) -> Mapping[str, Function]:
        """Return the functions of a source by name, of those in `facts.functions`.

        Each takes a block and then what `interface.FUNCTIONS` says of it.
        """
        ...


_registered: dict[str, Backend] = {}


def register_backend(backend: Backend) -> None:
    """Make a back end known by its name, in this process.

    An installed package needs no call: it names its back end in the group `gridgen_sym.backends` of its entry points.

    Args:
        backend: an object that meets the protocol `Backend`.

    Raises:
        GridgenError: if it does not, or if its name is taken.
    """
    checked = _checked(backend)
    if checked.name in BUILTIN or _registered.get(checked.name, checked) is not checked:
        raise GridgenError(f"there is a back end {checked.name!r}: give yours another name")
    _registered[checked.name] = checked


def find_backend(name: str) -> Backend:
    """Return the back end of this name.

    Raises:
        GridgenError: if there is none.
    """
    name = str(name)
    if name in BUILTIN:
        found: Backend = import_module(f"gridgen_sym.backends.{name}").BACKEND
        return found
    if name in _registered:
        return _registered[name]
    installed = _installed()
    if name not in installed:
        known = " or ".join(map(repr, (*BUILTIN, *_registered, *installed)))
        raise GridgenError(f"unknown backend {quoted(name)}: GRIDGEN_SYM_BACKEND and backend= take {known}")
    return _checked(installed[name].load())


@lru_cache(maxsize=1)
def _installed() -> Mapping[str, Any]:
    from importlib.metadata import entry_points

    return {point.name: point for point in entry_points(group=ENTRY_POINTS)}


def _checked(backend: object) -> Backend:
    if isinstance(backend, Backend):
        return backend
    lacking = [part for part in ("name", "suffix", "missing", "render", "load") if not hasattr(backend, part)]
    raise GridgenError(f"{quoted(backend)} is no back end: it lacks {', '.join(lacking)} of the protocol Backend")
