"""One public function for a grid of one block and for one of several."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable
from typing import Any, Concatenate, ParamSpec, Protocol, TypeVar, overload

from ...errors import GridgenError
from ...grids import Grid
from ...topology import MultiBlock

Given = ParamSpec("Given")
OfBlock = TypeVar("OfBlock", covariant=True)
OfLayout = TypeVar("OfLayout", covariant=True)


class OnBoth(Protocol[Given, OfBlock, OfLayout]):
    """A function of a grid, or of several blocks, with the same further arguments."""

    @overload
    def __call__(self, grid: Grid, *args: Given.args, **kwargs: Given.kwargs) -> OfBlock: ...

    @overload
    def __call__(self, grid: MultiBlock, *args: Given.args, **kwargs: Given.kwargs) -> OfLayout: ...


def on_several_blocks(
    for_layout: Callable[..., OfLayout], without: tuple[str, ...] = (), *, gets_own: bool = False
) -> Callable[[Callable[Concatenate[Grid, Given], OfBlock]], OnBoth[Given, OfBlock, OfLayout]]:
    """Return a decorator that hands a `MultiBlock` to another function.

    Args:
        for_layout: that function.
        without: names of arguments that it does not take; they are refused, unless they have their default value.
        gets_own: whether it also takes the function of one block, as `of_one_block`.
    """

    def decorate(for_block: Callable[Concatenate[Grid, Given], OfBlock]) -> OnBoth[Given, OfBlock, OfLayout]:
        defaults = {name: one.default for name, one in inspect.signature(for_block).parameters.items()}

        @functools.wraps(for_block)
        def either(grid: Any, *args: Any, **kwargs: Any) -> Any:  # noqa: ANN401
            if not isinstance(grid, MultiBlock):
                return for_block(grid, *args, **kwargs)
            for name in without:
                if kwargs.pop(name, defaults[name]) is not defaults[name]:
                    raise GridgenError(f"{for_block.__name__} of several blocks does not take {name!r}: leave it out")
            own = {"of_one_block": for_block} if gets_own else {}
            return for_layout(grid, *args, **kwargs, **own)

        return either

    return decorate
