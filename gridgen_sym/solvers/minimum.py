"""What a result is the minimum of: kept with it, so that it can be differentiated."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from ..boundary.sides import Sides
from ..boundary.wall import Wall
from ..functionals.definition import Functional

OnGrid = TypeVar("OnGrid")


@dataclass(frozen=True, slots=True, eq=False)
class Minimum(Generic[OnGrid]):
    """The problem of which a grid is the minimum, and what it was made of.

    It is not kept where a result is pickled: compiled kernels cannot be.

    Attributes:
        problem: makes or returns the problem, on one block or on several.
        functional: what was minimized.
        parameters: its values, where they are not the defaults.
        tolerance: factor by which the gradient had to fall: derivatives are solved for as well.
        start: the grid that was given, whose boundary the result has.
        target: as it was given.
        slide: as it was given.
        walls: by block the name of which is the key (of one block, an empty text): what was asked of the four sides,
            and that with corrected first heights, whose target was used.
        objection: why there are no derivatives nevertheless; empty where there are.
    """

    problem: Callable[[], OnGrid]
    functional: Functional
    parameters: Mapping[str, float] | None
    tolerance: float
    start: Any
    target: object = None
    slide: object = None
    walls: Mapping[str, tuple[Sides[Wall | None], Sides[Wall | None]]] | None = None
    objection: str = ""

    def __reduce__(self) -> tuple[type[None], tuple[()]]:
        """Become None in a pickle."""
        return type(None), ()
