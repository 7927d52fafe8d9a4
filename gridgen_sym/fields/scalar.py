"""One scalar field from anything: a formula, a function, samples, or numbers of one grid."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

import numpy as np
import numpy.typing as npt

from ..arrays import Array, real_array
from ..errors import GridgenError, UnusableValueError, quoted
from .formula import Formula, SymbolicFormula, is_expression
from .function import Constant, Function, required_arguments, takes_two_arrays
from .locations import at_nodes, first_index
from .outside import refuse
from .sampled import SampledField

if TYPE_CHECKING:
    import sympy

Source: TypeAlias = "str | float | sympy.Expr | Callable[[Array, Array], npt.ArrayLike] | npt.NDArray[Any]"


class Evaluator(Protocol):
    """What knows the values of a field, and its derivatives, everywhere in the plane."""

    def values(self, x: Array, y: Array) -> npt.ArrayLike:
        """Return the values at points, or a single number for all of them."""

    def derivatives(self, x: Array, y: Array, along: tuple[str, ...]) -> list[npt.ArrayLike]:
        """Return the derivatives along `x`, `y`, `xx`, `xy` or `yy`, each as `values` does."""


@dataclass(frozen=True, slots=True, eq=False)
class ScalarField:
    """A scalar field: a function of position, or numbers that belong to the nodes or cells of one grid.

    Attributes:
        name: what messages call it, such as `the weight`.
        source: what it was made of.
        evaluator: of a function of position; None for numbers of one grid.
        numbers: those of one grid, at its nodes (ni, nj), in its cells (ni-1, nj-1), or at their corners
            (4, ni-1, nj-1) in the order of `corner_jacobians`; None for a function of position.
        variables: names of the two coordinates: `x` and `y`, or `xi` and `eta` in [0, 1].
    """

    name: str
    source: Any
    evaluator: Evaluator | None = None
    numbers: Array | None = None
    variables: tuple[str, str] = ("x", "y")

    @property
    def per_node(self) -> bool:
        """Whether it is given at the nodes or in the cells of one grid only."""
        return self.numbers is not None

    @property
    def varies(self) -> bool:
        """Whether its value at a node may change when the node moves."""
        return self.evaluator is not None and not isinstance(self.evaluator, Constant)

    def values(self, x: Array, y: Array, where: str = "node") -> Array:
        """Return the values at points, of their shape.

        Args:
            x: the points; of a field per node, the nodes of its grid.
            y: the same.
            where: what messages call a point.

        Raises:
            GridgenError: for values of another shape or not finite, or that cannot be computed.
        """
        if self.evaluator is None:
            return at_nodes(self.plane(x, y), x.shape)
        return self._checked(self._computed(self.evaluator.values, x, y), x, y, where)

    def known(self, x: Array, y: Array) -> Array:
        """Return the values at points, of their shape, for pictures: NaN outside the samples and where none is finite.

        Args:
            x: the points; of a field per node, the nodes of its grid.
            y: the same.

        Raises:
            GridgenError: for values of another shape, or that cannot be computed.
        """
        if self.evaluator is None:
            return self.values(x, y)
        with np.errstate(all="ignore"):
            found = real_array(self._computed(self.evaluator.values, x, y), self.name, copy=False)
        if found.shape not in ((), x.shape):
            raise GridgenError(f"{self.name} must have one value per point, shape {x.shape}; came {found.shape}")
        has = np.isfinite(found)
        if isinstance(self.evaluator, SampledField):
            has = has & self.evaluator.covers(x, y)
        return np.where(has, found, np.nan)

    def plane(self, x: Array, y: Array) -> Array:
        """Return the values where they are given: at the points, or per node, cell or corner of the grid of the points.

        Raises:
            GridgenError: as for `values`.
        """
        if self.evaluator is not None:
            return self.values(x, y)
        assert self.numbers is not None
        cells = tuple(count - 1 for count in x.shape)
        locations = {x.shape: "node", cells: "cell", (4, *cells): "corner"}
        where = locations.get(self.numbers.shape)
        if where is None:
            of_place = f"{'Weight' if 'weight' in self.name else 'Field'}.on_grid(grid, values)"
            hint = f". Samples of another grid are functions of position: {of_place}" if "x" in self.variables else ""
            raise GridgenError(
                f"{self.name} must have one value per node, shape {x.shape}, per cell, shape {cells}, or per corner, "
                f"shape {(4, *cells)}; came {self.numbers.shape}{hint}"
            )
        if where == "node":
            return self._checked(self.numbers, x, y, where)
        bad = ~np.isfinite(self.numbers)
        if bad.any():
            index = tuple(int(k) for k in np.argwhere(bad)[0])
            raise UnusableValueError(
                f"{self.name} must be finite at every {where}; it is {self.numbers[index]} at {where} {index}: check it"
            )
        return self.numbers

    def derivatives(self, x: Array, y: Array, along: tuple[str, ...]) -> list[Array]:
        """Return the derivatives along `x`, `y`, `xx`, `xy` or `yy`, each of the shape of the points.

        Raises:
            GridgenError: as for `values`, and for numbers of one grid, which have no derivatives.
        """
        if self.evaluator is None:
            raise GridgenError(
                f"{self.name} is an array, and has no derivatives: give a formula, a function, or samples"
            )
        found = self._computed(self.evaluator.derivatives, x, y, along)
        return [
            self._checked(one, x, y, "node", f"'s derivative along {key}")
            for one, key in zip(found, along, strict=True)
        ]

    @property
    def ends(self) -> bool:
        """Whether there are points outside of its samples, at which it has no value."""
        return isinstance(self.evaluator, SampledField) and self.evaluator.beyond == "error"

    def check_samples(
        self, x: Array, y: Array, where: str = "node", among: npt.NDArray[np.bool_] | None = None
    ) -> None:
        """Refuse points outside the samples, unless the nearest sample counts there.

        Args:
            x: the points.
            y: the same.
            where: what messages call a point.
            among: which points must lie in the samples; by default all.

        Raises:
            UnusableValueError: naming the field, the place and the repair.
        """
        if isinstance(self.evaluator, SampledField) and self.ends:
            outside = ~self.evaluator.covers(x, y)
            if among is not None:
                outside &= among
            if outside.any():
                index = first_index(outside)
                place = f"{where} {index}, {self.place(x, y, index)},"
                refuse(self.name, self.evaluator.kind, place, outside, where)

    def outside(self, x: Array, y: Array) -> int:
        """Return the number of points outside the samples, where the nearest sample counts."""
        return self.evaluator.outside(x, y) if isinstance(self.evaluator, SampledField) else 0

    def place(self, x: Array, y: Array, index: tuple[int, ...]) -> str:
        """Return the coordinates of a point in words."""
        return ", ".join(f"{name} = {part[index]:.6g}" for name, part in zip(self.variables, (x, y), strict=True))

    def _computed(self, compute: Callable[..., Any], *arguments: Any) -> Any:  # noqa: ANN401
        try:
            return compute(*arguments)
        except GridgenError:
            raise
        except Exception as error:  # A user's function may raise anything.
            raise GridgenError(
                f"{self.name} {quoted(str(self.source))} cannot be evaluated: {error!r}. It must be a formula in "
                f"{' and '.join(self.variables)}, or a function of two arrays ({', '.join(self.variables)}) that "
                "returns an array of their shape"
            ) from error

    def _checked(self, given: npt.ArrayLike, x: Array, y: Array, where: str, what: str = "") -> Array:
        """Return values or derivatives as numbers of the points' shape."""
        value = real_array(given, f"{self.name}{what}", copy=False)
        if value.shape not in ((), x.shape):
            raise GridgenError(
                f"{self.name}{what} must have one value per {where}, shape {x.shape}; came {value.shape}"
            )
        bad = ~np.isfinite(value)
        if bad.any():
            value, bad = np.broadcast_to(value, x.shape), np.broadcast_to(bad, x.shape)
            index = tuple(int(k) for k in np.argwhere(bad)[0])
            raise UnusableValueError(
                f"{self.name}{what} must be finite at every {where}; it is {value[index]} at {where} {index}, "
                f"{self.place(x, y, index)}: check {'its formula' if self.evaluator else 'it'} there"
            )
        return np.ascontiguousarray(np.broadcast_to(value, x.shape))


def as_scalar(
    given: ScalarField | Source | npt.ArrayLike, name: str, variables: tuple[str, str] = ("x", "y")
) -> ScalarField:
    """Return a field of anything.

    Args:
        given: text or a SymPy expression in x and y; a function of two arrays (x, y); samples (`raster_field`,
            `scattered_field`, `grid_field`); a number; or numbers at the nodes (ni, nj), in the cells (ni-1, nj-1) or
            at the corners (4, ni-1, nj-1) of the grid that the field will be used on.
        name: what messages call it.
        variables: names of the coordinates.

    Raises:
        GridgenError: for what is none of these.
    """
    if isinstance(given, ScalarField):
        return given
    if isinstance(given, str) or is_expression(given):
        try:
            made = Formula(given, variables) if isinstance(given, str) else SymbolicFormula(given, variables)
            return ScalarField(name, given, made, variables=variables)
        except GridgenError as error:
            raise GridgenError(f"{name}: {error}") from error
    if isinstance(given, SampledField):
        return ScalarField(name, given, given, variables=variables)
    if callable(given):
        if not takes_two_arrays(given):
            raise GridgenError(
                f"{name} must be a function of two arrays ({', '.join(variables)}); came one of "
                f"{required_arguments(given)} arguments"
            )
        return ScalarField(name, given, Function(given), variables=variables)
    numbers = real_array(given, name)
    if numbers.ndim:
        return ScalarField(name, given, numbers=numbers, variables=variables)
    return ScalarField(name, given, Constant(float(numbers)), variables=variables)
