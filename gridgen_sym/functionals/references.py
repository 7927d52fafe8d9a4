"""Which sources a functional has."""

from __future__ import annotations

import re
from collections.abc import Mapping

from .bibliography import REFERENCES, Reference
from .definition import Functional
from .registry import literature_sources

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
    """Return the sources of a functional of the package, else one made of its `reference`, else none."""
    if not functional.reference:
        return ()
    keys = SOURCES.get(functional.name, literature_sources(functional.name))
    if keys:
        return tuple(REFERENCES[key] for key in keys)
    note = re.sub(r"([&%$#_])", r"\\\1", functional.reference)
    return (Reference(functional.name, "misc", {"note": note}),)
