"""What `vjp` returns: the gradient of a number that depends on a grid, in all that the grid was made of."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ..arrays import Array
from .data import BlockAdjoint, BlockData
from .lines import LineData
from .slides import CurveGradient
from .wall_data import WallGradient


class Gradients:
    """The derivatives of one number, or of several, in the data of a grid; each is computed when it is asked for.

    Of several numbers every array has these along its first axis. Of several blocks everything but `parameters` is a
    mapping from their names; the derivative in a node with several copies is the sum over these, and so is that in what
    several blocks share.
    """

    def __init__(
        self,
        names: Sequence[str] | None,
        data: Sequence[BlockData],
        adjoints: Sequence[Sequence[BlockAdjoint]],
        many: bool,
        lines: LineData | None = None,
    ) -> None:
        """Take the adjoints of every number on every block; `names` of several blocks, None for one."""
        self._names, self._data, self._adjoints, self._many, self._lines = names, data, adjoints, many, lines

    def __repr__(self) -> str:
        """Name what there is."""
        return f"<gradients of {len(self._adjoints)} number{'s' * (len(self._adjoints) > 1)} that depend on a grid>"

    @property
    def boundary(self) -> Any:  # noqa: ANN401
        """In the nodes of the start that do not move, (ni, nj, 2): those of the boundary, and fixed ones.

        Where walls are given, also through the cells that they ask for. Of a side that slides along the curve of its
        own nodes, through that curve.
        """
        found = self._of_blocks(lambda data, adjoint: data.in_boundary(adjoint))
        if self._lines is None:
            return found
        own = [self._lines.in_boundary(*self._joined(adjoints)) for adjoints in self._adjoints]
        for number, name in enumerate(found):
            parts = [one[number] for one in own]
            found[name] = found[name] + (np.stack(parts) if self._many else parts[0])
        return found

    @property
    def parameters(self) -> dict[str, Any]:
        """In the parameters of the functional, by name."""
        found = [
            [data.in_parameters(adjoint) for data, adjoint in zip(self._data, adjoints, strict=True)]
            for adjoints in self._adjoints
        ]
        totals = [{name: sum(one[name] for one in blocks) for name in blocks[0]} for blocks in found]
        if not self._many:
            return dict(totals[0])
        return {name: np.array([total[name] for total in totals]) for name in totals[0]}

    @property
    def weight(self) -> Any:  # noqa: ANN401
        """In the weight; None without one.

        Of an array or of samples in these, in their shape; of a number as a number. Of a formula or function in its
        values at the nodes, (ni, nj); where it is differentiated in its values and its derivatives in x and y,
        (3, ni, nj).
        """
        return self._of_blocks(lambda data, adjoint: data.in_weight(adjoint))

    @property
    def fields(self) -> Any:  # noqa: ANN401
        """In the declared fields, by name: each as `weight`, with the components first."""
        return self._of_blocks(lambda data, adjoint: data.in_fields(adjoint))

    @property
    def target(self) -> Any:  # noqa: ANN401
        """In the target; None without one.

        Of a reference grid in its nodes, (ni, nj, 2); of lengths and an angle in these three, and of a matrix in its
        four entries, each as `weight`.
        """
        return self._of_blocks(lambda data, adjoint: data.in_target(adjoint))

    @property
    def walls(self) -> Any:  # noqa: ANN401
        """In the walls, by side: a `WallGradient`, in the forms in which first heights and growth were given."""
        return self._of_blocks(lambda data, adjoint: data.in_walls(adjoint))

    @property
    def slide(self) -> Any:  # noqa: ANN401
        """In the curves that were given of sliding sides, by side.

        Of points in these, (n, 2); of a spline or a function a `CurveGradient`. Of several blocks by the name of the
        boundary, and not by block.
        """
        if self._lines is None:
            return self._of_blocks(lambda data, adjoint: data.in_slide(adjoint))
        found = [self._lines.in_slide(*self._joined(adjoints)) for adjoints in self._adjoints]
        return _stacked(found) if self._many else found[0]

    @staticmethod
    def _joined(adjoints: Sequence[BlockAdjoint]) -> tuple[Array, Array]:
        """Return the derivatives in the nodes, and the solution, of all blocks one after the other."""
        nodes, field = ([np.ravel(getattr(one, name)) for one in adjoints] for name in ("nodes", "field"))
        return np.concatenate(nodes), np.concatenate(field)

    def _of_blocks(self, derive: Callable[[BlockData, BlockAdjoint], Any]) -> Any:  # noqa: ANN401
        found = []
        for number, data in enumerate(self._data):
            parts = [derive(data, adjoints[number]) for adjoints in self._adjoints]
            found.append(_stacked(parts) if self._many else parts[0])
        return found[0] if self._names is None else dict(zip(self._names, found, strict=True))


def _stacked(parts: Sequence[Any]) -> Any:  # noqa: ANN401
    """Return the same derivatives of several numbers with these along the first axis."""
    first = parts[0]
    if first is None:
        return None
    if isinstance(first, Mapping):
        return {name: _stacked([part[name] for part in parts]) for name in first}
    if isinstance(first, CurveGradient):
        return CurveGradient(first.at, *(np.stack([getattr(p, n) for p in parts]) for n in ("points", "slopes")))
    if isinstance(first, WallGradient):
        return WallGradient(*(_stacked([getattr(part, name) for part in parts]) for name in ("first", "growth")))
    if isinstance(first, tuple):
        return tuple(_stacked(group) for group in zip(*parts, strict=True))
    stacked: Array = np.stack(parts)
    return stacked
