"""A certificate: what is proved of all grids with given boundary nodes, and the sentence that says so."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from ..arrays import Array
from .node_constraints import Node

Kind = Literal["coincident", "crossing", "clockwise", "corner", "spike", "neck", "conflict", "sliver"]


class Numbers(dict[str, float]):
    """The numbers of a certificate by name; the old name 'share' of 'jacobian_fraction' still works."""

    def __missing__(self, name: str) -> float:
        """Return the number of an old name, with a warning."""
        if name == "share" and "jacobian_fraction" in self:
            warnings.warn("'share' is called 'jacobian_fraction' now", DeprecationWarning, stacklevel=2)
            return self["jacobian_fraction"]
        raise KeyError(name)


@dataclass(frozen=True, slots=True)
class Certificate:
    """A proof about every grid with given boundary nodes, from these nodes alone.

    All kinds but 'sliver' prove that no valid grid exists: in every grid with these boundary nodes some corner
    Jacobian of some cell is not positive. A 'sliver' proves less: every valid grid, if there is one, has a corner
    Jacobian that is at most a given fraction of the expected one.

    What is proved holds exactly for the coordinates as they are stored. Every decision is made in integer or rational
    arithmetic, or in floating-point arithmetic with an error bound. Only `point`, `numbers` and the fraction of
    a 'sliver' are rounded.

    Attributes:
        kind: the reason:

            * 'coincident': two neighbors on the boundary are one point;
            * 'crossing': the boundary crosses itself and winds a negative number of times around some point, or its
              tangent does not turn through 360 degrees in all;
            * 'clockwise': the boundary runs clockwise, or encloses no area; reversing one axis may repair that;
            * 'corner': the three fixed nodes at a logical corner form a Jacobian that is not positive;
            * 'spike': the boundary runs back on itself at a node;
            * 'neck': the half-planes that boundary nodes put on one inner node have no common point;
            * 'conflict': some cells cannot all be valid while the others are, by constraint propagation and branching;
            * 'sliver': not all corner Jacobians of some cells can exceed a fraction of the expected ones.
        nodes: indices (i, j) of the nodes that prove it. Two for 'coincident'; the ends of two edges for 'crossing';
            before, at and after the node in question for 'corner' and 'spike'; the inner node and pairs of boundary
            nodes, to the left of each of which it would have to lie, for 'neck'; none for 'clockwise'; the four of each
            cell, counter-clockwise from its first, for 'conflict' and 'sliver'.
        point: where to look, (x, y), rounded.
        numbers: what was measured. 'corner': the number (0 to 3, counter-clockwise from (0, 0)) of a 'corner';
            'angle': its inner angle in degrees, also of a 'spike'; 'crossings': how many pairs of edges cross;
            'winding': how often the boundary winds around the point 'x', 'y'; 'turn': its total turn in degrees;
            'cells': how many conflict; 'jacobian_fraction': the corner Jacobians of a 'sliver' cannot all exceed this
            fraction of the Jacobians predicted from the boundary spacing (`expected_jacobians`).
        message: a sentence that names the reason, the nodes and a repair.
    """

    kind: Kind
    nodes: tuple[Node, ...]
    point: tuple[float, float]
    numbers: Mapping[str, float] = field(hash=False)
    message: str

    @property
    def impossible(self) -> bool:
        """Whether it proves that no valid grid exists: all kinds but 'sliver' do."""
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
