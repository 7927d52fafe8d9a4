"""The command that writes kernels into a folder, and how their heads report it: the same from whatever folder."""

from __future__ import annotations

import os
import shlex
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True)
class ExportCommand:
    """A command `gridgen-sym generate NAME ... -o DIR`.

    Attributes:
        functionals: their names.
        languages: in which kernels are written.
        folder: where they go, as the user has named it.
        variants: that are written beside those that the densities ask for.
        files: with the user's own functionals, as the user has named them.
    """

    functionals: tuple[str, ...]
    languages: tuple[str, ...]
    folder: str
    variants: tuple[str, ...] = ()
    files: tuple[str, ...] = ()

    @property
    def here(self) -> str:
        """The command, for the folder in which it was given."""
        return self._text(self.folder, self.files)

    @property
    def recorded(self) -> str:
        """The command, for the folder `place`, whatever folder it was given in."""
        return self._text(self._from_base(self.folder), tuple(map(self._from_base, self.files)))

    @property
    def place(self) -> str:
        """Where to run the recorded command, from the folder of the kernels: the nearest folder above all of them."""
        return Path(os.path.relpath(self._base, _located(self.folder))).as_posix()

    @property
    def _base(self) -> str:
        return os.path.commonpath([os.path.dirname(_located(path)) for path in (self.folder, *self.files)])

    def _from_base(self, path: str) -> str:
        return Path(os.path.relpath(_located(path), self._base)).as_posix()

    def _text(self, folder: str, files: tuple[str, ...]) -> str:
        words = ["gridgen-sym", "generate", *self.functionals]
        words += [word for file in files for word in ("--functionals", file)]
        words += ["-o", folder, "--language", ",".join(self.languages)]
        words += [word for variant in self.variants for word in ("--variant", variant)]
        return shlex.join(words)


def _located(path: str) -> str:
    """Return the absolute path of a file or folder; one that is a link itself keeps its name."""
    above, name = os.path.split(os.path.abspath(path))
    return os.path.join(os.path.realpath(above), name)
