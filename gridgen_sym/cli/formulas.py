"""Commands about formulas: `functionals`, `derive`, `docs`, `check`, `verify`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from .base import functionals_option

if TYPE_CHECKING:
    from ..functionals import Functional
    from ..symbolic import Verdict


@click.command()
@functionals_option
def functionals() -> None:
    """List the functionals with the type of their equations, as random points show it; 'derive' proves more.

    Those of the literature, whose equations are derived when they are first used, are listed with their source.
    """
    from rich import box
    from rich.console import Console
    from rich.table import Table

    from ..functionals import functional, is_literature
    from ..functionals import functionals as names

    head = ("name", "density", "equations", "barrier", "parameters, fields", "what it asks for")
    table = Table(*head, box=box.SIMPLE_HEAD, pad_edge=False)
    literature = Table("of the literature", "what it asks for", "source", box=box.SIMPLE_HEAD, pad_edge=False)
    with Console(stderr=True).status("deriving the equations ..."):
        for definition in map(functional, names()):
            if is_literature(definition.name):
                literature.add_row(definition.name, definition.description, definition.reference)
            else:
                table.add_row(*_row(definition))
    # Where nobody looks at a terminal, no line is cut to the width of one.
    console = Console(width=None if sys.stdout.isatty() else 200)
    console.print(table, literature)


def _row(definition: Functional) -> tuple[str, ...]:
    """Return one line of the list."""
    from ..codegen.derivations import summary

    found = summary(definition)
    given = [f"{name}={value:g}" for name, value in definition.parameters.items()]
    given += [f"{name} ({kind})" for name, kind in definition.fields.items()]
    return (
        definition.name,
        found.density,
        ", ".join(found.equations),
        "yes" if found.barrier else "no",
        ", ".join(given),
        definition.description,
    )


@click.command()
@click.argument("name")
@click.option("--latex", is_flag=True, help="A section of LaTeX for \\input in a document that loads amsmath.")
@click.option("--document", is_flag=True, help="A LaTeX document that compiles by itself, with its bibliography.")
@functionals_option
def derive(name: str, latex: bool, document: bool) -> None:
    """Print every equation derived from the functional NAME."""
    from ..functionals import functional

    definition = functional(name)
    from ..codegen.derivations import known_report, report_latex

    if latex or document:
        click.echo(report_latex(definition, complete=document), nl=False)
    else:
        click.echo(known_report(definition), nl=False)


@click.command()
@click.argument("name")
@click.option(
    "-o", "--output", "folder", default="out", show_default=True, metavar="DIR", help="Where the page and its files go."
)
@functionals_option
def docs(name: str, folder: str) -> None:
    """Write a page about the functional NAME: equations, classification, kernels, pictures (HTML)."""
    from ..functionals import functional

    definition = functional(name)
    from ..documentation.standalone import write_html

    click.echo(f"wrote {write_html(definition, Path(folder))}")


@click.command()
@click.argument("name")
@functionals_option
def check(name: str) -> None:
    """Check derivatives, equations and kernels of the functional NAME against independent computations.

    The weight is 1; fields are smooth ones, held and moving.
    """
    from ..functionals import functional

    definition = functional(name)
    from ..selfcheck import checks

    failed = 0
    for line in checks(definition):
        failed += not line.passed
        color = {"ok": "green", "vacuous": "yellow", "FAILED": "red"}[line.word]
        click.secho(f"{line.word:<8}", fg=color, nl=False)
        click.echo(line.text)
    if failed:
        click.secho(f"{failed} checks of {name} failed", fg="red", err=True)
        raise click.exceptions.Exit(1)


@click.command()
def verify() -> None:
    """Compare every printed equation of the paper with what is derived."""
    from ..symbolic import verify as verdicts

    found = verdicts()
    for verdict in found:
        click.secho(f"{verdict.equation.place}: ", nl=False)
        click.secho(_answer(verdict), fg=_color(verdict))
    known = [verdict.erratum for verdict in found if verdict.erratum]
    plain = sum(verdict.is_plain for verdict in found)
    conditional = sum(verdict.agrees and not verdict.is_plain and not verdict.erratum for verdict in found)
    discoveries = sum(verdict.is_discovery for verdict in found)
    click.echo(
        f"{len(found)} printed equations and claims: {plain} agree, {conditional} under a condition, "
        f"{len(known)} are known errata ({', '.join(sorted(set(known), key=lambda key: int(key[1:])))}), "
        f"{discoveries} differ without a known erratum"
    )
    if discoveries:
        raise click.exceptions.Exit(1)


def _answer(verdict: Verdict) -> str:
    """Return one line: agrees, or the exact difference."""
    text = verdict.text
    # A number is a factor or a value, and the text says which; anything else is printed minus derived.
    if verdict.difference.free_symbols and str(verdict.difference) not in text:
        text = f"printed - derived = {verdict.difference}; {text}"
    head = f"{verdict.status} [{verdict.erratum}]" if verdict.erratum else verdict.status
    return f"{head}: {text}" if text else head


def _color(verdict: Verdict) -> str:
    return "red" if verdict.is_discovery else "yellow" if verdict.erratum else "green"
