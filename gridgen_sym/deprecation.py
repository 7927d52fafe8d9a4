"""Names that were changed: the old ones work for one minor version more, with a warning."""

from __future__ import annotations

import functools
import warnings
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

_Parameters = ParamSpec("_Parameters")
_Returned = TypeVar("_Returned")


def renamed_arguments(
    *, stacklevel: int = 2, **renamed: str
) -> Callable[[Callable[_Parameters, _Returned]], Callable[_Parameters, _Returned]]:
    """Accept old names of keyword arguments, with a `DeprecationWarning` that gives the new ones.

    Args:
        stacklevel: whose line the warning points to: 2 is the caller's of the function, and each decorator around this
            one adds 1.
        **renamed: the new name of each old one.

    Raises:
        TypeError: when the function is called with both names of an argument.
    """

    def decorate(function: Callable[_Parameters, _Returned]) -> Callable[_Parameters, _Returned]:
        name = function.__qualname__.removesuffix(".__init__")

        @functools.wraps(function)
        def call(*arguments: Any, **keywords: Any) -> _Returned:  # noqa: ANN401
            for old in renamed.keys() & keywords.keys():
                new = renamed[old]
                text = f"{name}({old}=...) is deprecated: the argument is called {new}"
                warnings.warn(text, DeprecationWarning, stacklevel=stacklevel)
                if new in keywords:
                    raise TypeError(f"{name}() got {new} and its old name {old}: give {new} alone")
                keywords[new] = keywords.pop(old)
            return function(*arguments, **keywords)

        return call

    return decorate
