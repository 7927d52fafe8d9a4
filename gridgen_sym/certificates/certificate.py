"""A certificate: what is proved of all grids with some boundary nodes, and the sentence that says so."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from ..arrays import Array
from .neck import Node

Kind = Literal["coincident", "crossing", "clockwise", "corner", "spike", "neck", "conflict", "sliver"]


@dataclass(frozen=True, slots=True)
class Certificate:
    """One proof that no grid without a folded cell has these boundary nodes; a 'sliver' proves less.

    Attributes:
        kind: 'coincident': two neighbors are one point; 'crossing': the boundary crosses itself, so that cells must be
            turned over; 'clockwise': the boundary runs clockwise, which can be repaired; 'corner': the three fixed
            nodes at a logical corner turn the wrong way; 'spike': the boundary runs back on itself at a node; 'neck':
            there is no place for an inner node; 'conflict': some cells cannot all be valid while the others are, which
            a search has shown; 'sliver': in every valid grid, if there is one, some of these cells is nearly folded, or
            much smaller than the lengths of the boundary's edges let expect.
        nodes: indices (i, j) of the nodes that prove it. Two for 'coincident'; the ends of two edges for 'crossing';
            before, at and after the place for 'corner' and 'spike'; the inner node and pairs of boundary nodes, to
            the left of each of which it would have to lie, for 'neck'; none for 'clockwise'; the four of each cell,
            counter-clockwise from its first, for 'conflict' and 'sliver'.
        point: where to look, (x, y).
        numbers: what was measured. 'corner': the number (0 to 3, counter-clockwise from (0, 0)) of a 'corner';
            'angle': its inner angle in degrees, also of a 'spike'; 'crossings': how many pairs of edges cross;
            'winding': how often the boundary winds round the point 'x', 'y'; 'turn': its total turn in degrees;
            'cells': how many conflict; 'share': the corner Jacobians of a 'sliver' cannot all exceed this part of the
            area that the lengths of the boundary's edges let expect there.
        message: a sentence that names the thing and what helps.
    """

    kind: Kind
    nodes: tuple[Node, ...]
    point: tuple[float, float]
    numbers: Mapping[str, float]
    message: str

    @property
    def impossible(self) -> bool:
        """Whether it proves that there is no valid grid: all but a 'sliver' do."""
        return self.kind != "sliver"

    def __str__(self) -> str:
        """Return the message."""
        return self.message


def point_of(xy: Array) -> tuple[float, float]:
    """Return an array (2,) as two numbers."""
    return float(xy[0]), float(xy[1])


def point_text(point: tuple[float, float]) -> str:
    """Return a point as text for a message."""
    return f"({point[0]:.6g}, {point[1]:.6g})"
