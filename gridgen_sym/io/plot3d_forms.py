"""The forms of PLOT3D files, and the words by which a user selects one."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..errors import GridgenError
from ..messages import report

#: Words, and what they select; those of one line exclude each other.
_CHOICES = (
    {
        "ascii": "text, 17 digits",
        "fortran": "Fortran unformatted: each record between two lengths",
        "binary": "C binary: no records",
    },
    {"little": "little-endian", "big": "big-endian"},
    {"double": "8 bytes a coordinate", "single": "4 bytes a coordinate"},
    {"count": "the number of blocks stands before their sizes", "nocount": "one block, and no number of blocks"},
    {"space": "three sizes, and x, y, z", "plane": "two sizes, and x, y"},
    {"iblank": "with a plane of iblank", "noiblank": "without iblank"},
)
#: Every word with its meaning.
WORDS = {word: meaning for choice in _CHOICES for word, meaning in choice.items()} | {
    "holes": "nodes that iblank blanks out (0) are kept, as nodes"
}
MOST_BLOCKS = 100_000  # A first number that is larger counts no blocks.


@dataclass(frozen=True, slots=True)
class Form:
    """What a file may be.

    Attributes:
        sizes: (ni, nj, nk) of every block.
        dimension: how many coordinates a node has.
        blanked: whether each block has a plane of iblank.
        counted: whether the number of blocks is in it.
        kind: `ascii`, `fortran` or `binary`.
        order: `<` or `>`, of numbers that are not text.
        precision: bytes of a coordinate that is not text.
        marker: bytes of a length before and after a record of Fortran.
    """

    sizes: tuple[tuple[int, int, int], ...]
    dimension: int
    blanked: bool
    counted: bool
    kind: str = "ascii"
    order: str = "<"
    precision: int = 8
    marker: int = 4

    @property
    def nodes(self) -> int:
        """How many nodes all blocks have."""
        return sum(ni * nj * nk for ni, nj, nk in self.sizes)

    @property
    def is_plane(self) -> bool:
        """Whether every block may be a plane of a grid, or one layer of cells: no line, and no volume."""
        return all(sum(n <= 2 for n in size) == 1 for size in self.sizes)

    @property
    def header(self) -> int:
        """How many numbers stand before the coordinates."""
        return self.counted + self.dimension * len(self.sizes)

    @property
    def count(self) -> int:
        """How many numbers the file has, if it is text; else how many bytes."""
        if self.kind == "ascii":
            return self.header + (self.dimension + self.blanked) * self.nodes
        records = 2 * self.marker * (self.counted + 1 + len(self.sizes)) if self.kind == "fortran" else 0
        return 4 * self.header + (self.dimension * self.precision + 4 * self.blanked) * self.nodes + records

    @property
    def words(self) -> tuple[str, ...]:
        """The words that select it."""
        return (
            self.kind,
            *(() if self.kind == "ascii" else (("little", "big")[self.order == ">"], _PRECISIONS[self.precision])),
            "count" if self.counted else "nocount",
            "space" if self.dimension == 3 else "plane",
            "iblank" if self.blanked else "noiblank",
        )

    @property
    def described(self) -> str:
        """The form in words for a message."""
        ni, nj, nk = self.sizes[0]
        first = f"{ni} x {nj}" + f" x {nk}" * (self.dimension == 3)
        blocks = f"{len(self.sizes)} blocks, the first of {first} nodes," if len(self.sizes) > 1 else f"{first} nodes"
        precision = "" if self.kind == "ascii" else f" in {_PRECISIONS[self.precision]} precision"
        return f"{blocks} in {self.dimension} dimensions" + precision + " with iblank" * self.blanked

    def misfit(self, count: int) -> str:
        """Return what is too much or too little for a file of this form that has `count` numbers or bytes."""
        over = count - self.count
        return f"{self.described} needs {self.count}, so that {abs(over)} are {'too many' if over > 0 else 'missing'}"


_PRECISIONS = {8: "double", 4: "single"}


def check_words(words: Collection[str]) -> None:
    """Refuse words that exclude each other."""
    for choice in _CHOICES:
        given = [word for word in choice if word in words]
        if len(given) > 1:
            raise GridgenError(f"a PLOT3D file cannot be both {given[0]} and {given[1]}: take one word for its form")


def allows(words: Collection[str], form: Form) -> bool:
    """Return whether a form is one of those that the user's words leave; text has neither byte order nor precision."""
    for choice in _CHOICES:
        given, own = choice.keys() & set(words), choice.keys() & set(form.words)
        if given and own and given != own:
            return False
    return True


def chosen_form(fitting: Sequence[Form], first_block: Callable[[Form], list[Array]]) -> Form:
    """Return the likeliest of the forms that fit a file, the first; where there are others that is reported.

    Args:
        fitting: the forms.
        first_block: returns the numbers of a form's first block: its coordinates, and iblank, if there is one.
    """
    if len(fitting) > 1:
        fitting = [form for form in fitting if form.is_plane] or fitting
    if len(fitting) > 1:
        fitting = [form for form in fitting if is_plausible(form, first_block(form))] or fitting
    others = [form for form in fitting[1:] if form.words != fitting[0].words or form.sizes != fitting[0].sizes]
    if others:
        report(
            f"the file is read as {fitting[0].described} (form '{' '.join(fitting[0].words)}'), but could also be "
            f"{others[0].described}: the form '{' '.join(others[0].words)}' reads it so"
        )
    return fitting[0]


def is_plausible(form: Form, values: Sequence[Array]) -> bool:
    """Return whether iblank may be one, and coordinates are no whole numbers that are read as other ones."""
    if form.blanked and not ((values[-1] % 1 == 0) & (np.abs(values[-1]) <= MOST_BLOCKS)).all():
        return False
    smallest = float(np.finfo(np.float32 if form.precision == 4 else np.float64).tiny)
    return not any(((plane != 0) & (np.abs(plane) < smallest)).any() for plane in values[: form.dimension])


def unfit(forms: Sequence[Form], count: int, what: str, expected: str) -> GridgenError:
    """Return the error for a file that has none of the forms.

    Args:
        forms: what its header may mean, the likeliest first.
        count: how many numbers or bytes the file has.
        what: names these, and the header.
        expected: what a file should be.
    """
    likely = sorted(forms, key=lambda form: abs(form.count - count))[:2] if len(forms) > 2 else forms
    needed = " or ".join(dict.fromkeys(form.misfit(count) for form in likely))
    short = any(form.count > count for form in likely) or not likely
    repair = "The file may be cut short: write it again" if short else "Write it again"
    return GridgenError(f"{what}{f' ({needed})' if needed else ''}; {expected}. {repair}")
