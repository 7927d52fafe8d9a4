"""Names that were changed: the old ones work for one minor version more, with a warning."""

from __future__ import annotations

import functools
import warnings
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

_Parameters = ParamSpec("_Parameters")
_Returned = TypeVar("_Returned")


def renamed_argument(
    old: str, new: str
) -> Callable[[Callable[_Parameters, _Returned]], Callable[_Parameters, _Returned]]:
    """Accept the old name of a keyword argument, with a `DeprecationWarning` that gives the new one."""

    def decorate(function: Callable[_Parameters, _Returned]) -> Callable[_Parameters, _Returned]:
        @functools.wraps(function)
        def call(*arguments: Any, **keywords: Any) -> _Returned:  # noqa: ANN401
            if old in keywords:
                text = f"{function.__name__}({old}=...) is deprecated: the argument is called {new}"
                warnings.warn(text, DeprecationWarning, stacklevel=2)
                keywords[new] = keywords.pop(old)
            return function(*arguments, **keywords)

        return call

    return decorate
