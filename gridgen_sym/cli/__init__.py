"""The command line. It parses, prints and sets exit codes; all work is done elsewhere.

Exit codes: 0 for success; 1 where an answer is bad (folded cells, a difference, a failed check); 2 for input that
cannot be used; 130 after Ctrl-C. What a command needs is loaded when it runs.
"""

from __future__ import annotations

import click

from ..version import __version__
from .adaptation import adapt
from .airfoil import airfoil
from .base import Program, functionals_option
from .files import convert, formats
from .formulas import check, derive, docs, functionals, verify
from .generate import generate
from .grids import domains, grid, quality
from .layouts import layouts
from .system import info, paper
from .view import view


@click.group(cls=Program, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(__version__, package_name="gridgen-sym", prog_name="gridgen-sym")
@functionals_option
def main() -> None:
    """Structured quadrilateral grids from variational functionals.

    \b
    gridgen-sym grid swan -f winslow -o swan.vts --plot swan.png
    gridgen-sym derive winslow
    """  # noqa: D301 - click reads the backspace: keep the lines


_about_grids = grid, airfoil, adapt, quality, view, convert, domains, layouts, formats
_about_formulas = functionals, derive, docs, check, verify, generate, info, paper
for _command in (*_about_grids, *_about_formulas):
    main.add_command(_command)
