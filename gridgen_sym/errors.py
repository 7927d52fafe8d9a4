"""The one error type for bad input: it names the thing, what was expected, what came, and the repair."""

from __future__ import annotations

#: A message of more characters is cut in its middle, whatever it quotes; messages of compilers are longest.
_LONGEST = 6000


class GridgenError(ValueError):
    """Input that gridgen_sym cannot use; the message says what is wrong with it and how to repair it."""

    def __init__(self, message: str) -> None:
        """Keep a message that can be read: `quoted` shortens what a user gave, and this all else."""
        half = _LONGEST // 2
        left_out = len(message) - 2 * half
        if left_out > _LONGEST // 50:  # A message that was cut stays as it is when it is made again from a pickle.
            message = f"{message[:half]} ... ({left_out} characters left out) ... {message[-half:]}"
        super().__init__(message)


class UnusableValueError(GridgenError):
    """A field has no value that can be used at some point: not finite, too large, or negative where it must not be.

    At a point that a solver only tries this ends the trial, not the run.
    """


def quoted(value: object, longest: int = 200) -> str:
    """Return what was given as it would be typed, for a message: cut where it is too long to read."""
    return shortened(repr(value), longest)


def shortened(value: object, longest: int = 200) -> str:
    """Return the text of a value, for a message: cut where it is too long to read."""
    text = str(value)
    return text if len(text) <= longest else f"{text[:longest]}... ({len(text)} characters)"


class MissingExtraError(GridgenError, ImportError):
    """An optional package is needed and not installed; the message gives the command that installs it."""

    def __init__(self, purpose: str, extra: str, package: str) -> None:
        """Say that `purpose` needs `package`, which the extra `extra` installs."""
        self._given = (purpose, extra, package)
        super().__init__(
            f"{purpose} needs the package '{package}', which is not installed: run  pip install 'gridgen-sym[{extra}]'"
        )

    def __reduce__(self) -> tuple[type[MissingExtraError], tuple[str, str, str]]:
        """Pickle what it was made of, so that a worker process can hand it on."""
        return type(self), self._given
