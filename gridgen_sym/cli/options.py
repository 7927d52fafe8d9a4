"""Options of the command line, made of the rows of `gridgen_sym.options`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import click

from ..options import Option
from .types import integer, number

_Command = TypeVar("_Command", bound=Callable[..., Any])
_TYPES: dict[type, Any] = {float: number, int: integer, str: str}


def option(row: Option, *names: str, more: str = "", **settings: Any) -> Callable[[_Command], _Command]:  # noqa: ANN401
    """Return the decorator that adds an option to a command.

    What is not on the command line is None, and the function's own default holds; that of a flag is the row's.

    Args:
        row: what the option is.
        names: as click takes them; by default the argument's name with hyphens.
        more: what follows the row's help, with its punctuation: how a value is written here.
        settings: what else click takes, such as `metavar`.
    """
    flag = f"--{row.name.replace('_', '-')}"
    if row.kind is bool:
        names = names or ((f"{flag}/--no-{flag[2:]}") if row.default else flag,)
        settings |= {"is_flag": True, "default": row.default}
    else:
        settings["type"] = click.Choice(row.choices) if row.choices else _TYPES[row.kind]
    text = f"{row.help}{more}."
    if settings.get("multiple"):
        text += " May be repeated."
    if row.shown_default and not settings.get("required"):
        text += f"  [default: {row.shown_default}]"
    return click.option(*(names or (flag,)), help=text, **settings)
