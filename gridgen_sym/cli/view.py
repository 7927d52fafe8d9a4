"""The command `view`: a page that shows a grid in a browser."""

from __future__ import annotations

from pathlib import Path

import click

from ..errors import GridgenError
from .output import under_of, under_option


@click.command()
@click.argument("file")
@click.option("-o", "--output", metavar="PAGE", help="The page: .html.  [default: FILE.html in this folder]")
@click.option("--open", "show", is_flag=True, help="Open the page in a browser.")
@click.option("--layout", is_flag=True, help="Show a file of one block as a layout: with its boundaries' names.")
@under_option
def view(file: str, output: str | None, show: bool, layout: bool, under: str | None) -> None:
    """Write a page that shows the grid in FILE in a browser: one file, which needs no network.

    It zooms and pans, colors cells by their quality, and reports the measures of the cell pointed at.
    """
    from ..io import read
    from ..plotting import view_grid

    page = Path(output) if output else Path(f"{Path(file).name}.html")
    if page.suffix.lower() not in (".html", ".htm"):
        raise GridgenError(f"cannot write {page}: the suffix of a page is .html")
    view_grid(read(file, layout=layout), page, title=Path(file).name, under=under_of(under, str(page)))
    click.echo(f"wrote {page}")
    if show:
        click.launch(str(page.resolve()))
