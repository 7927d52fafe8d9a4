"""The command `generate`: the folder `generated/` of this package, or kernels in a user's own project."""

from __future__ import annotations

import os
from pathlib import Path

import click

from ..errors import GridgenError
from .base import functionals_option, loaded_files


@click.command()
@click.argument("names", nargs=-1, metavar="[NAME]...")
@click.option("-o", "--output", "folder", metavar="DIR", help="Where the kernels of the named functionals go.")
@click.option("--language", metavar="LIST", help="Their languages, such as c,numpy.  [default: c]")
@click.option(
    "--variant",
    "variants",
    multiple=True,
    metavar="VARIANT",
    help="Write a further variant, such as target (relative to a target), M:differentiated (the declared field M moves "
    "with the nodes), frozen or differentiated (with a weight), control, or several joined by +, as in "
    "M:differentiated+target. May be repeated.",
)
@click.option("--check", "only_check", is_flag=True, help="Write nothing; print a diff, and exit 1 if there is one.")
@functionals_option
@click.pass_context
def generate(
    ctx: click.Context,
    names: tuple[str, ...],
    folder: str | None,
    language: str | None,
    variants: tuple[str, ...],
    only_check: bool,
) -> None:
    """Write kernels of the functionals NAME ... into a folder of your own project; they need nothing of this package.

    For each NAME they are: those with the values of declared fields held; with a regularized barrier, where it has
    one; with a weight, where the density names s; relative to a target, where it names t11, t22, t12 or tau. Others are
    chosen with --variant. The heads of the files have the command that makes them, the same from whatever folder it was
    called.

    Without names: write the folder `generated/` of this package, kernels in C and NumPy and the derived equations.
    Only what has changed is derived again.
    """
    if names and folder:
        _export(names, folder, language or "c", variants, loaded_files(ctx), only_check)
    elif names:
        raise GridgenError(f"where should the kernels of {', '.join(names)} go? Name a folder, as in -o kernels")
    elif folder or language or variants or loaded_files(ctx):
        raise GridgenError(
            "name the functionals whose kernels you want, as in  gridgen-sym generate winslow -o kernels"
        )
    else:
        _generate(only_check)


def _export(
    names: tuple[str, ...],
    folder: str,
    language: str,
    variants: tuple[str, ...],
    files: tuple[str, ...],
    only_check: bool,
) -> None:
    from ..codegen.export import check_exported, check_languages, exported_sources, ordered_variants, write_exported
    from ..codegen.export_command import ExportCommand
    from ..functionals import functional

    functionals = [functional(name) for name in dict.fromkeys(names)]
    named = tuple(one.name for one in functionals)
    command = ExportCommand(named, check_languages(language.split(",")), folder, ordered_variants(variants), files)
    sources = exported_sources(functionals, command)
    if only_check:
        _report_difference(check_exported(Path(folder), sources), folder, command.here)
    else:
        _report_written(write_exported(Path(folder), sources))


def _generate(only_check: bool) -> None:
    from ..codegen.generate import check_generated, write_generated

    if only_check:
        _report_difference(check_generated(), "generated/", "gridgen-sym generate")
    else:
        _report_written(write_generated())


def _report_difference(difference: str, folder: str, command: str) -> None:
    click.echo(difference, nl=False)
    if difference:
        click.secho(f"{folder} is not what is derived now: run  {command}", fg="red", err=True)
        raise click.exceptions.Exit(1)
    click.echo(f"{folder} is what is derived now")


def _report_written(changed: list[Path]) -> None:
    for path in changed:
        click.echo(os.path.relpath(path) if path.is_relative_to(os.getcwd()) else str(path))
    click.echo(f"{len(changed)} files changed")
