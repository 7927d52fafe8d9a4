"""Types of the command line: numbers, read as in files, and sizes such as 40x40."""

from __future__ import annotations

import re

import click

from ..errors import quoted
from ..parsing import number_in, whole_number_in


def number(text: str) -> float:
    """Return a real number; unlike click's own type this one does not take `1_0` for ten."""
    try:
        return number_in(text)
    except ValueError:
        raise click.BadParameter(f"{quoted(text)} is not a number.") from None


def integer(text: str) -> int:
    """Return a whole number; unlike click's own type this one does not take `1_0` for ten."""
    try:
        return whole_number_in(text)
    except ValueError:
        raise click.BadParameter(f"{quoted(text)} is not a whole number.") from None


_SIZE = re.compile("([^xX×,]+)[xX×,]([^xX×,]+)")


class SizedCommand(click.Command):
    """A command whose option `--size` takes two numbers, as in `40 40` or `40x40`."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse the arguments, with a size in one word cut in two."""
        return super().parse_args(ctx, _with_sizes_in_two(args))


def _with_sizes_in_two(args: list[str]) -> list[str]:
    result: list[str] = []
    for k, word in enumerate(args):
        if word == "--":  # What follows are no options.
            return result + args[k:]
        option, equals, value = word.partition("=")
        if option == "--size" and equals:
            result.append("--size")
            word = value
        both = _SIZE.fullmatch(word) if result[-1:] == ["--size"] else None
        result += both.groups() if both else [word]
    return result
