"""Where the functionals of the library come from, as BibTeX: the one place where a source is described."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

from .definition import Functional


@dataclass(frozen=True, slots=True)
class Reference:
    """A source.

    Attributes:
        key: by which it is cited.
        kind: of BibTeX: `article`, `book`, `misc`.
        fields: of BibTeX, in LaTeX.
    """

    key: str
    kind: str
    fields: Mapping[str, str]

    def bibtex(self) -> str:
        """Return the entry."""
        lines = (f"  {name} = {{{text}}}," for name, text in self.fields.items())
        return "\n".join([f"@{self.kind}{{{self.key},", *lines, "}"])


def _article(key: str, author: str, title: str, journal: str, where: tuple[str, str, str, str]) -> Reference:
    """Return an article; `where` is its volume, number (or nothing), pages and year."""
    volume, number, pages, year = where
    fields = {"author": author, "title": title, "journal": journal, "volume": volume, "number": number}
    kept = {name: text for name, text in fields.items() if text}
    return Reference(key, "article", kept | {"pages": pages, "year": year})


#: The paper whose functionals these are; `Functional.reference` names its sections.
PAPER = Reference(
    "khattri2006",
    "misc",
    {
        "author": "Khattri, Sanjay Kumar",
        "title": "Grid Generation and Adaptation by Functionals",
        "howpublished": "arXiv:math/0607388",
        "year": "2006",
    },
)
REFERENCES: Mapping[str, Reference] = {
    reference.key: reference
    for reference in (
        PAPER,
        _article(
            "winslow1966",
            "Winslow, Alan M.",
            "Numerical Solution of the Quasilinear {P}oisson Equation in a Nonuniform Triangle Mesh",
            "Journal of Computational Physics",
            ("1", "2", "149--172", "1966"),
        ),
        _article(
            "steinberg1986",
            "Steinberg, Stanly and Roache, Patrick J.",
            "Variational Grid Generation",
            "Numerical Methods for Partial Differential Equations",
            ("2", "1", "71--96", "1986"),
        ),
        _article(
            "castillo1991",
            "Castillo, Jos{\\'e} E.",
            "A Discrete Variational Grid Generation Method",
            "SIAM Journal on Scientific and Statistical Computing",
            ("12", "2", "454--468", "1991"),
        ),
        _article(
            "knupp1992",
            "Knupp, Patrick M.",
            "A Robust Elliptic Grid Generator",
            "Journal of Computational Physics",
            ("100", "", "409--418", "1992"),
        ),
        Reference(
            "knupp1993",
            "book",
            {
                "author": "Knupp, Patrick and Steinberg, Stanly",
                "title": "Fundamentals of Grid Generation",
                "publisher": "CRC Press",
                "year": "1993",
            },
        ),
    )
}
#: The sources of the functionals of the library, by the functional's name.
SOURCES: Mapping[str, tuple[str, ...]] = {
    "area": ("khattri2006", "steinberg1986", "castillo1991"),
    "length": ("khattri2006", "steinberg1986", "castillo1991"),
    "orthogonality": ("khattri2006", "steinberg1986", "castillo1991"),
    "combined": ("khattri2006", "steinberg1986", "castillo1991"),
    "knupp": ("khattri2006", "knupp1992"),
    "winslow": ("khattri2006", "winslow1966"),
    "liao": ("khattri2006", "knupp1993"),
    "modified_liao": ("khattri2006", "knupp1993"),
    "area_winslow": ("khattri2006",),
}


def references_of(functional: Functional) -> tuple[Reference, ...]:
    """Return the sources of a functional: those of the table, else one made of its `reference`, else none."""
    if functional.name in SOURCES and functional.reference:
        return tuple(REFERENCES[key] for key in SOURCES[functional.name])
    if not functional.reference:
        return ()
    note = re.sub(r"([&%$#_])", r"\\\1", functional.reference)
    return (Reference(functional.name, "misc", {"note": note}),)
