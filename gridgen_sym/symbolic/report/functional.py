"""Every derived equation of a functional, as plain text and as LaTeX.

Both are made from the same sections, so that neither can show what the other does not.
"""

from __future__ import annotations

from ...functionals.definition import Functional
from .document import document, fragment
from .sections import sections
from .text import text_section


def derive_text(functional: Functional) -> str:
    """Return every derived equation of a functional as plain text, with names as in the code."""
    head = f"Functional {functional.name}: {functional.description}".rstrip(": ")
    return "\n\n".join([head, *(text_section(section) for section in sections(functional))]) + "\n"


def derive_latex(functional: Functional, *, complete: bool = False) -> str:
    r"""Return every derived equation of a functional as LaTeX, with numbered and labeled equations.

    Args:
        functional: any.
        complete: a document that compiles by itself, with its bibliography, and not a section for \input in one that
            loads amsmath.
    """
    return (document if complete else fragment)(functional)
