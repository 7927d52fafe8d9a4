"""The grid that minimizes a functional as a function of arrays, for programs that differentiate themselves.

`gridgen_sym.jax` and `gridgen_sym.torch` put such functions into their graphs.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Hashable, Iterator, Mapping
from hashlib import sha256
from typing import Any

import numpy as np

from ..arrays import Array
from ..boundary.wall import Wall
from ..errors import GridgenError, quoted
from ..functionals.definition import Functional
from ..grids import Grid
from ..solvers.optimize import optimize
from ..solvers.run.result import Result
from .gradients import Gradients

#: Numbers by name, some of which are mappings of numbers by name.
Data = Mapping[str, Any]
#: Results, and functions, that are remembered.
_RESULTS, _FUNCTIONS = 8, 32
#: What of a wall are numbers that can be differentiated.
_WALL_NUMBERS = ("first", "growth")


class GridFunction:
    """The nodes (ni, nj, 2) of the minimum, of the nodes of a start and further arrays.

    The data are a mapping with `nodes`, and perhaps `parameters`, `weight`, `fields`, `target`, `walls` and `slide`:
    see `split_data`. The last results are remembered, so that a derivative needs no second solve.
    """

    def __init__(self, functional: str | Functional, static: Mapping[str, Any]) -> None:
        """Take the functional, and all that is not differentiated."""
        self._functional, self._static = functional, static
        self._results: OrderedDict[str, Result] = OrderedDict()

    def nodes(self, data: Data) -> Array:
        """Return the nodes of the minimum."""
        return self._solved(data).grid.xy

    def pullback(self, data: Data, cotangent: Array) -> dict[str, Any]:
        """Return the derivatives in all data, in their shapes, of a number whose derivatives in the nodes are given."""
        gradients = self._solved(data).vjp(np.asarray(cotangent, dtype=np.float64))
        return {name: _shaped(_part(gradients, name), given) for name, given in data.items()}

    def _solved(self, data: Data) -> Result:
        key = sha256()
        for path, leaf in leaves(data):
            array = np.ascontiguousarray(leaf, dtype=np.float64)
            key.update(repr((path, array.shape)).encode() + array.tobytes())
        name = key.hexdigest()
        if name not in self._results:
            self._results[name] = self._solve(data)
            if len(self._results) > _RESULTS:
                self._results.popitem(last=False)
        self._results.move_to_end(name)
        return self._results[name]

    def _solve(self, data: Data) -> Result:
        given, arrays = dict(self._static), {name: part for name, part in data.items() if name != "nodes"}
        if "parameters" in arrays:
            given["parameters"] = {name: float(number) for name, number in arrays["parameters"].items()}
        if "weight" in arrays:
            given["weight"] = np.asarray(arrays["weight"])
        if "fields" in arrays:
            fields = {name: np.asarray(one) for name, one in arrays["fields"].items()}
            given["fields"] = {**given.get("fields", {}), **fields}
        if "target" in arrays:
            given["target"] = Grid(np.asarray(arrays["target"]))
        if "walls" in arrays:
            said = given.get("walls", {})
            given["walls"] = {side: _wall(said.get(side, {}), one) for side, one in arrays["walls"].items()}
        if "slide" in arrays:
            curves = {side: np.asarray(points) for side, points in arrays["slide"].items()}
            given["slide"] = {**given.get("slide", {}), **curves}
        return optimize(Grid(np.asarray(data["nodes"])), self._functional, progress=False, **given)


def _wall(said: Mapping[str, Any], numbers: Mapping[str, Any]) -> Wall:
    arrays: dict[str, Any] = {name: np.asarray(one) for name, one in numbers.items()}
    return Wall(**said, **arrays)


def grid_function(functional: str | Functional, static: Mapping[str, Any]) -> GridFunction:
    """Return the function of a functional and of what is not differentiated: the same for the same."""
    key = (functional, *((name, _identity(value)) for name, value in sorted(static.items())))
    if key not in _functions:
        _functions[key] = GridFunction(functional, static)
        if len(_functions) > _FUNCTIONS:
            _functions.popitem(last=False)
    _functions.move_to_end(key)
    return _functions[key]


_functions: OrderedDict[Hashable, GridFunction] = OrderedDict()


def _identity(value: Any) -> Hashable:  # noqa: ANN401
    """Return what tells a value from others as long as it exists."""
    if isinstance(value, Mapping):
        return tuple((name, _identity(one)) for name, one in sorted(value.items()))
    return value if isinstance(value, (str, int, float, bool, tuple, type(None))) else id(value)


def split_data(given: Data) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return what is differentiated of the arguments of `optimize`, and what is not.

    Args:
        given: `nodes` of the start, (ni, nj, 2), of which those that stay count; `parameters` by name; `weight` and
            `fields`, arrays per node, cell or corner; `target`, the nodes of a reference grid (ni, nj, 2); `walls` by
            side, mappings with `first`, `growth` and what else a `Wall` takes; `slide`, as in `optimize`, of which
            points (n, 2) of curves are differentiated. What is None is left out.

    Raises:
        GridgenError: for walls that are no mappings.
    """
    data = {name: one for name, one in given.items() if one is not None and name not in ("walls", "slide")}
    static: dict[str, Any] = {}
    if given.get("walls") is not None:
        walls = given["walls"]
        if not isinstance(walls, Mapping) or not all(isinstance(one, Mapping) for one in walls.values()):
            raise GridgenError(
                "walls of a differentiable grid are mappings, such as {'bottom': {'first': 1e-3, 'growth': 1.2}}; came "
                f"{quoted(walls)}"
            )
        data["walls"] = {
            side: {name: one for name, one in wall.items() if name in _WALL_NUMBERS} for side, wall in walls.items()
        }
        static["walls"] = {
            side: {name: one for name, one in wall.items() if name not in _WALL_NUMBERS} for side, wall in walls.items()
        }
    slide = given.get("slide")
    if isinstance(slide, Mapping):
        curves = {side: one for side, one in slide.items() if hasattr(one, "shape")}
        static["slide"] = {side: one for side, one in slide.items() if side not in curves}
        if curves:
            data["slide"] = curves
    elif slide is not None:
        static["slide"] = slide
    return data, static


def leaves(data: Data, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Yield the numbers of nested mappings with their paths, in alphabetical order."""
    for name in sorted(data):
        one = data[name]
        if isinstance(one, Mapping):
            yield from leaves(one, (*path, name))
        else:
            yield (*path, name), one


def nested(paths: list[tuple[str, ...]], values: list[Any]) -> dict[str, Any]:
    """Return the nested mappings of numbers with their paths."""
    found: dict[str, Any] = {}
    for path, value in zip(paths, values, strict=True):
        place = found
        for name in path[:-1]:
            place = place.setdefault(name, {})
        place[path[-1]] = value
    return found


def _part(gradients: Gradients, name: str) -> Any:  # noqa: ANN401
    """Return the derivatives in one of the data."""
    if name == "walls":
        return {side: {"first": one.first, "growth": one.growth} for side, one in gradients.walls.items()}
    return gradients.boundary if name == "nodes" else getattr(gradients, name)


def _shaped(found: Any, given: Any) -> Any:  # noqa: ANN401
    """Return derivatives as arrays of the shapes of what was given, of which they may have more."""
    if isinstance(given, Mapping):
        return {name: _shaped(found[name], one) for name, one in given.items()}
    return np.asarray(found, dtype=np.float64).reshape(np.shape(given))
