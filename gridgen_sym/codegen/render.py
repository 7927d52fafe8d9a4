"""Fill the templates; the only module that knows `templates/`."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import jinja2

from ..functionals.definition import Functional
from ..resources import resource_folder
from ..version import __version__
from .kernel import Kernel, Program, Source
from .printers import CPrinter, NumpyPrinter, Printer

#: Language -> (entry template, path of the result, printer).
LANGUAGES: dict[str, tuple[str, str, type[Printer]]] = {
    "c": ("c/kernels.c.jinja", "c/{name}.c", CPrinter),
    "numpy": ("numpy/kernels.py.jinja", "numpy/{name}.py", NumpyPrinter),
}


def render(kernel: Kernel, language: str) -> Source:
    """Return the source file of a kernel in `"c"` or `"numpy"`."""
    template, path, printer = LANGUAGES[language]
    text = environment().get_template(template).render(template_variables(kernel, printer()))
    return Source(path.format(name=kernel.name), text)


def render_page(template: str, **variables: object) -> str:
    """Return a page of the documentation, from a template in `templates/docs`."""
    return environment().get_template(f"docs/{template}").render(variables)


def render_document(functional: Functional) -> Source:
    """Return the page of derived equations of a functional."""
    from ..symbolic.report.functional import derive_text

    equations = derive_text(functional)
    text = render_page("functional.md.jinja", functional=functional, equations=equations, version=__version__)
    return Source(f"docs/{functional.name}.md", text)


def template_variables(kernel: Kernel, printer: Printer) -> dict[str, Any]:
    """Return what every template is given, the same names for every language."""
    return {
        "kernel": kernel,
        "programs": {name: _printed(program, printer) for name, program in kernel.programs.items()},
        "weight_planes": _weight_planes(kernel),
        "euler_lagrange": "residual" in kernel.programs,
        "version": __version__,
    }


def _printed(program: Program, printer: Printer) -> dict[str, Any]:
    lines = printer.program(program)
    return {
        "inputs": program.inputs,
        "outputs": program.outputs,
        "lines": lines,
        "operations": program.operations,
        "uses": _used_names(program),
    }


def _used_names(program: Program) -> frozenset[str]:
    """Return the names that the program reads, so that templates can mark the others as unused."""
    used = {symbol.name for assignment in program.assignments for symbol in assignment.value.free_symbols}
    if used & set(program.parameters):
        used.add("parameters")
    return frozenset(used)


def _weight_planes(kernel: Kernel) -> tuple[str, ...]:
    """Return the names of the planes of the weight array, in order."""
    return tuple(name for name in kernel.programs["corner_energy"].inputs if name == "s" or name.startswith("s_"))


@lru_cache(maxsize=1)
def environment() -> jinja2.Environment:
    """Return the Jinja2 environment; a variable that a template misses is an error."""
    return jinja2.Environment(
        loader=jinja2.FileSystemLoader(resource_folder("templates")),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,
    )
