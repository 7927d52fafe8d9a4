"""What the commands `grid`, `adapt` and `quality` print, draw and write."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ..errors import GridgenError, MissingExtraError
from ..options import PICTURES
from .field import field_of
from .options import option

if TYPE_CHECKING:
    from ..fields.scalar import ScalarField
    from ..geography import Projection
    from ..grids import Grid
    from ..solvers import LayoutResult, Result
    from ..topology import MultiBlock

_PICTURES = (".png", ".svg", ".pdf")
#: Adds `--under` to a command.
under_option = option(
    PICTURES["under"], more=": a formula in x and y, or a .npz or .csv file as for 'adapt --to'", metavar="FIELD"
)


def under_of(text: str | None, plot: str | None, projection: Projection | None = None) -> ScalarField | None:
    """Return the field that `--under` gives, with the text as its name; its samples are placed by a projection.

    Raises:
        GridgenError: if it is none, or there is no picture `plot` to draw it in.
    """
    from ..fields import as_scalar

    if text is not None and not plot:
        raise GridgenError(f"--under {text} is drawn in a picture: give --plot PNG, too")
    if text is None:
        return None
    return replace(as_scalar(field_of(text, smooth=False, projection=projection), "the field"), name=text)


def check_outputs(output: str | None, plot: str | None) -> None:
    """Refuse files that cannot be written before any work is done."""
    from importlib.util import find_spec

    from ..atomic import check_target
    from ..io import check_written

    if output:
        check_written(output)
    if plot:
        check_target(plot)
    if plot and Path(plot).suffix.lower() not in _PICTURES:
        raise GridgenError(f"cannot write {plot}: a picture's suffix must be one of {', '.join(_PICTURES)}")
    if plot and find_spec("matplotlib") is None:
        raise MissingExtraError("--plot", "plot", "matplotlib")


def report(quiet: bool, text: str) -> None:
    """Print a line, unless the command is to be quiet."""
    if not quiet:
        click.echo(text)


class Announcement:
    """The line about the start, printed when the work begins: what cannot be used has been refused by then."""

    def __init__(self, quiet: bool, source: str, start: Grid | MultiBlock) -> None:
        """Make the line, of a start that comes from `source`."""
        from ..topology import MultiBlock, quality

        measured = quality(start)
        if isinstance(start, MultiBlock):
            size = (
                f"{_counted(len(start), 'block')}, {_counted(len(start.bonds), 'connection')}, {measured.cells} cells"
            )
        else:
            size = f"{start.shape[0] - 1} x {start.shape[1] - 1} cells"
        self._quiet = quiet
        self._text = f"start: {source}, {size}, {measured.folded_cells or 'none'} of them folded"

    def __call__(self, _: object = None) -> None:
        """Print it, at the first step or after the work, but once."""
        if self._text:
            report(self._quiet, self._text)
            self._text = ""


def _counted(count: int, what: str) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"


def certify_and_draw(
    made: Grid | MultiBlock,
    plot: str | None,
    title: str,
    quiet: bool,
    result: Result | LayoutResult | None = None,
    under: ScalarField | None = None,
) -> None:
    """Report the proofs that the boundary of a folded grid admits no valid one, and draw it, or these.

    The `result` of a solver has its own certificates.
    """
    from ..certificates import certificates
    from ..plotting import plot_certificates, plot_grid
    from ..plotting.names import as_written
    from ..solvers import LayoutResult
    from ..topology import MultiBlock
    from ..topology import quality as measure

    if isinstance(made, MultiBlock) or isinstance(result, LayoutResult):
        if isinstance(made, MultiBlock) and result is None and not measure(made).valid:
            for name, proofs in certificates(made, search=True).items():
                for certificate in proofs:
                    click.secho(f"block {name}: {certificate.message}", fg="red", err=True)
        if plot:
            plot_grid(made, plot, title=as_written(title), under=under)
            report(quiet, f"wrote {plot}")
        return
    if result:
        found = result.certificates
    else:
        found = () if measure(made).valid else certificates(made, search=True)
        for certificate in found:
            click.secho(certificate.message, fg="red", err=True)
    if plot:
        if found:
            plot_certificates(made, plot, found=found, under=under)
        else:
            plot_grid(made, plot, title=as_written(title), under=under)
        report(quiet, f"wrote {plot}")
