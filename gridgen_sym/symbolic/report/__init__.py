"""Report: every derived equation as plain text and as LaTeX, from the same sections."""

from .functional import derive_latex as derive_latex
from .functional import derive_text as derive_text
