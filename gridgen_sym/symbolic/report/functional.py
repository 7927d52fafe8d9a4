"""Every derived equation of a functional, as plain text and as LaTeX.

Both are made from the same sections, so that neither can show what the other does not.
"""

from __future__ import annotations

from ...functionals.definition import Functional
from .latex import latex_section
from .sections import sections
from .text import text_section


def derive_text(functional: Functional) -> str:
    """Return every derived equation of a functional as plain text, with names as in the code."""
    head = f"Functional {functional.name}: {functional.description}".rstrip(": ")
    return "\n\n".join([head, *(text_section(section) for section in sections(functional))]) + "\n"


def derive_latex(functional: Functional) -> str:
    """Return every derived equation of a functional as a LaTeX fragment, for a document that loads amsmath."""
    name = functional.name.replace("_", r"\_")
    body = "\n".join(latex_section(section) for section in sections(functional))
    return f"\\section*{{The functional \\texttt{{{name}}}}}\n{body}\n"
