"""Places outside the samples of a field: what may count there, and how one is refused.

The nodes of a grid that is given, and those of a result, must lie in the samples. Grids that a solver only tries on its
way may leave them: the nearest sample counts there.
"""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np
import numpy.typing as npt

from ..errors import GridgenError, UnusableValueError, quoted

#: What counts outside the samples: nothing, or the nearest sample.
Outside = Literal["error", "nearest"]

#: Places are in the samples up to this part of their extent: what rounding does to points on an edge.
ROUNDING = 1e-9


def check_choice(outside: str) -> None:
    """Refuse what is no choice of `outside`."""
    if outside not in get_args(Outside):
        raise GridgenError(f"outside must be 'error' or 'nearest'; came {quoted(outside)}")


def refuse(name: str, kind: str, place: str, outside: npt.NDArray[np.bool_], where: str) -> None:
    """Refuse a place outside the samples.

    Args:
        name: of the field.
        kind: what the samples are, in words.
        place: the first place outside, in words.
        outside: which places are outside.
        where: what a place is called.

    Raises:
        UnusableValueError: naming the field, the place and the repair.
    """
    raise UnusableValueError(
        f"{name} is known by samples {kind}, and {place} lies outside of them, as {int(outside.sum())} of "
        f"{outside.size} {where}s do: sample the whole domain, or let the nearest sample count there, with "
        "outside='nearest' where the samples are given (--outside nearest)"
    )
