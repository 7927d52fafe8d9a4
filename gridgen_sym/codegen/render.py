"""Fill the templates; the only module that knows `templates/`."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any

import jinja2

from ..functionals.definition import Functional
from ..functionals.metric import DERIVATIVE_NAMES, METRIC_NAMES
from ..resources import resource_folder
from ..version import __version__
from .facts import KernelFacts
from .source import Source

if TYPE_CHECKING:
    from .kernel import Kernel, Program
    from .printer import Printer


def render_kernel(template: str, kernel: Kernel, printer: Printer) -> str:
    """Return the source of a kernel, from a template and the printer of its language."""
    return environment().get_template(template).render(template_variables(kernel, printer))


def render_shared(path: str) -> Source:
    """Return a file that all kernels of a language share, such as `c/common.h`, from the template of that name."""
    return Source(path, environment().get_template(f"{path}.jinja").render(version=__version__))


def render_interface(language: str, facts: KernelFacts) -> str:
    """Return what tells a program of a user how to call a kernel, of which only the facts are needed.

    In C it is a header; in Python it follows the kernel in its module.
    """
    (name,) = (name for name in environment().list_templates() if name.startswith(f"{language}/interface."))
    return environment().get_template(name).render(facts=facts, version=__version__)


def render_page(template: str, **variables: object) -> str:
    """Return a page of the documentation, from a template in `templates/docs`."""
    return environment().get_template(f"docs/{template}").render(variables)


def render_document(functional: Functional, equations: str) -> Source:
    """Return the page of a functional in `generated/`, from the report on its equations."""
    text = render_page("functional.md.jinja", functional=functional, equations=equations, version=__version__)
    return Source(f"docs/{functional.name}.md", text)


def template_variables(kernel: Kernel, printer: Printer) -> dict[str, Any]:
    """Return what the template of a kernel is given, the same names for every language."""
    return {
        "facts": kernel.facts,
        "programs": {name: _printed(program, printer) for name, program in kernel.programs.items()},
        "version": __version__,
    }


def _printed(program: Program, printer: Printer) -> dict[str, Any]:
    return {
        "inputs": program.inputs,
        "outputs": program.outputs,
        "lines": printer.program(program),
        "uses": _used_names(program),
        "reads": _used_names(program, but_for=METRIC_NAMES),
        "metric": METRIC_NAMES,
        "edges": tuple(name for name in program.inputs if name.removeprefix("v_") in DERIVATIVE_NAMES),
    }


def _used_names(program: Program, but_for: tuple[str, ...] = ()) -> frozenset[str]:
    """Return the names that the program reads, but for the values of some, so that templates know what is unused."""
    wanted = [assignment.value for assignment in program.assignments if assignment.name not in but_for]
    used = {symbol.name for value in wanted for symbol in value.free_symbols}
    if used & set(program.parameters):
        used.add("parameters")
    return frozenset(used)


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
