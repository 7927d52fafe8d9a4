"""The kinds of declared fields, and the names of their components."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, TypeAlias

Kind: TypeAlias = Literal["scalar", "vector", "symmetric", "matrix"]

#: What is put after the name of a field to name its components, by kind. A symmetric matrix is positive definite; the
#: components of a matrix are in the order of rows.
KINDS: Mapping[str, tuple[str, ...]] = {
    "scalar": ("",),
    "vector": ("1", "2"),
    "symmetric": ("11", "12", "22"),
    "matrix": ("11", "12", "21", "22"),
}
#: Values at which a density is tried, by kind: no two of them the same, so that it may not vanish by accident.
TYPICAL: Mapping[str, tuple[float, ...]] = {
    "scalar": (1.25,),
    "vector": (0.5, 0.75),
    "symmetric": (1.5, 0.25, 0.75),
    "matrix": (1.25, 0.25, -0.5, 0.75),
}
#: What is put after the name of a component to name its derivatives in x and y, and along xi and eta.
PHYSICAL_SUFFIXES = ("_x", "_y", "_xx", "_xy", "_yy")
LOGICAL_SUFFIXES = ("_xi", "_eta")


def components(name: str, kind: str) -> tuple[str, ...]:
    """Return the names of the components of a field, such as M11, M12, M22 of a symmetric M."""
    return tuple(name + suffix for suffix in KINDS[kind])


def all_components(fields: Mapping[str, str]) -> tuple[str, ...]:
    """Return the names of the components of all fields, in order."""
    return tuple(component for name, kind in fields.items() for component in components(name, kind))


def typical_values(fields: Mapping[str, str]) -> dict[str, float]:
    """Return values of what a density may name beside the metric, at which it is tried: places, fields, s = 1."""
    values = {"x": 0.3, "y": 0.45, "xi": 0.4, "eta": 0.65, "s": 1.0}
    for name, kind in fields.items():
        values |= dict(zip(components(name, kind), TYPICAL[kind], strict=True))
    return values
