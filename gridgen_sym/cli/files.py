"""Commands about grid files: `convert`, `formats`."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from ..options import FILES
from .options import option
from .output import report


@click.command()
@click.argument("source", metavar="IN")
@click.argument("target", metavar="OUT")
@option(FILES["layout"])
@option(
    FILES["form"],
    *("--from", "read_form"),
    more=" of IN, where its suffix and content leave it open: 'plot3d', see 'gridgen-sym formats'",
    metavar="FORM",
)
@option(FILES["form"], *("--to", "write_form"), more=" of OUT", metavar="FORM")
@click.option("--quiet", is_flag=True, help="Report nothing but what is wrong.")
def convert(source: str, target: str, layout: bool, read_form: str | None, write_form: str | None, quiet: bool) -> None:
    """Read the grid in IN and write it to OUT, in the format that its suffix selects.

    Connections and names of boundaries that IN, or the neutral map file (.nmf) beside it, tells of are kept.
    """
    from ..io import check_written, read, read_as_told, write
    from ..topology import MultiBlock

    check_written(target, form=write_form or "")
    made = read(source, layout=True, form=read_form or "") if layout else read_as_told(source, read_form or "")
    write(made, target, form=write_form or "")
    blocks = made.blocks if isinstance(made, MultiBlock) else (made,)
    sizes = ", ".join(f"{ni} x {nj}" for ni, nj in (grid.shape for grid in blocks[:4])) + ", ..." * (len(blocks) > 4)
    report(quiet, f"wrote {Path(target)}: {len(blocks)} block{'s' * (len(blocks) > 1)} of {sizes} nodes")


@click.command()
def formats() -> None:
    """List the formats of grid files, and of the files that outlines are read from."""
    from rich import box
    from rich.console import Console
    from rich.table import Table

    from ..io import known_formats
    from ..outlines import outline_formats

    table = Table(
        "format", "suffixes", "read", "written", "blocks", "names", "needs", box=box.SIMPLE_HEAD, pad_edge=False
    )
    forms = Table("form", "of", "what it selects", box=box.SIMPLE_HEAD, pad_edge=False)
    for name, form in known_formats().items():
        table.add_row(
            f"{name}: {form.name}",
            " ".join(form.suffixes),
            "yes" if form.decode else "no",
            "yes" if form.encode else "no",
            "several" if form.several else "one",
            "in it" if form.names else ".nmf",
            f"{form.extra[1]} (extra {form.extra[0]})" if form.extra else "",
        )
        for word, meaning in form.forms.items():
            forms.add_row(word, name, meaning)
    # Where nobody looks at a terminal, no line is cut to the width of one.
    console = Console(width=None if sys.stdout.isatty() else 200)
    console.print(table)
    if forms.row_count:
        console.print(forms)
    outlines = Table("outlines", "suffixes", "read", "needs", box=box.SIMPLE_HEAD, pad_edge=False)
    for name, source in outline_formats().items():
        needs = f"{source.package} (extra geo)" if source.package else ""
        outlines.add_row(f"{name}: {source.name}", " ".join(source.suffixes), source.description, needs)
    console.print(outlines)
