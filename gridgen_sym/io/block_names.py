"""Names of blocks that a text can hold and give back."""

from __future__ import annotations

from collections.abc import Sequence

from ..errors import GridgenError, quoted


def check_block_names(names: Sequence[str], what: str) -> None:
    """Refuse names that a file would not give back, or that would break it.

    Args:
        names: of the blocks.
        what: names the kind of file: "a Gmsh file".

    Raises:
        GridgenError: for a name that is empty, has line breaks or other signs that are not printed, or begins or ends
            with a blank.
    """
    for name in names:
        if not name or not name.isprintable() or name != name.strip():
            raise GridgenError(
                f"{what} cannot hold the block name {quoted(name)}: take one that is not empty, without line breaks, "
                "and without blanks at its ends"
            )
