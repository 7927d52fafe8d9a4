"""What all commands share: errors and their exit codes, and the user's own functionals."""

from __future__ import annotations

import errno
import io
import sys
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click

from .. import startup
from ..errors import GridgenError

_Command = TypeVar("_Command", bound=Callable[..., Any])
_LOADED = "gridgen_sym.functionals"


class InputError(click.ClickException):
    """Input that cannot be used: its text without a traceback, and exit code 2."""

    exit_code = 2


class Program(click.Group):
    """A group that turns the errors of its commands into messages and exit codes, and lists commands as added."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the commands in the order in which they were added."""
        return list(self.commands)

    def make_context(self, *arguments: Any, **options: Any) -> click.Context:  # noqa: ANN401
        """Parse the group's own options, of which `--functionals` runs a file."""
        startup.loaded()
        for stream in (sys.stdout, sys.stderr):
            if isinstance(stream, io.TextIOWrapper):  # A terminal without the signs of mathematics shows others.
                stream.reconfigure(errors="replace")
        context: click.Context = _answered(super().make_context, *arguments, **options)
        return context

    def invoke(self, ctx: click.Context) -> Any:  # noqa: ANN401
        """Run a command."""
        return _answered(super().invoke, ctx)


def _answered(call: Callable[..., Any], *arguments: Any, **options: Any) -> Any:  # noqa: ANN401
    try:
        return call(*arguments, **options)
    except GridgenError as error:
        raise InputError(str(error)) from error
    except MemoryError as error:
        raise InputError(f"there is not enough memory: take fewer nodes. {error}".strip()) from error
    except KeyboardInterrupt:
        click.secho("\ninterrupted", err=True, fg="yellow")
        raise click.exceptions.Exit(130) from None
    except OSError as error:
        if error.errno == errno.EPIPE:  # The reader of a pipe has left: click knows what to do.
            raise
        raise InputError(str(error)) from error


def functionals_option(command: _Command) -> _Command:
    """Add `--functionals FILE.py` to a command; the files are run before the command."""
    return click.option(
        "--functionals",
        "files",
        metavar="FILE.py",
        multiple=True,
        is_eager=True,
        expose_value=False,
        callback=_load_files,
        help="Run a Python file that adds functionals with gg.define(...). May be repeated.",
    )(command)


def _load_files(ctx: click.Context, _: click.Parameter, files: tuple[str, ...]) -> None:
    loaded: dict[Path, str] = ctx.meta.setdefault(_LOADED, {})
    for file in files:
        path = Path(file).resolve()
        if path not in loaded:
            loaded[path] = file
            run_functionals_file(file)


def loaded_files(ctx: click.Context) -> tuple[str, ...]:
    """Return the files of `--functionals` as the user named them, in the order in which they were run."""
    return tuple(ctx.meta.get(_LOADED, {}).values())


def run_functionals_file(file: str) -> None:
    """Run a user's file, which must define at least one functional.

    Raises:
        GridgenError: naming the file and the line where it went wrong.
    """
    import runpy

    from ..functionals import functionals

    if not Path(file).is_file():
        raise GridgenError(f"cannot read {file}: there is no such file; --functionals takes a Python file")
    before = set(functionals())
    try:
        runpy.run_path(file, run_name="gridgen_sym_functionals")
    except SyntaxError as error:
        raise GridgenError(f"{error.filename}, line {error.lineno}: {error.msg}") from error
    except (Exception, SystemExit) as error:
        kind = "" if isinstance(error, GridgenError) else f"{type(error).__name__}: "
        raise GridgenError(f"{_place(file, error)}: {kind}{error}") from error
    if set(functionals()) == before:
        raise GridgenError(f"{file} adds no functional: call gg.define(name, density) in it")


def _place(file: str, error: BaseException) -> str:
    """Return the file and the line of it in which an error came up."""
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == file]
    return f"{file}, line {lines[-1]}" if lines else file
