"""Results that can be differentiated: the gradient of a grid in what it was made of."""

from __future__ import annotations

from typing import Any

import numpy.typing as npt

from ...later import provided


class Differentiable:
    """A result whose grid minimizes an energy, and so is a function of all that the energy depends on."""

    __slots__ = ()

    def vjp(self, cotangent: npt.ArrayLike) -> Any:  # noqa: ANN401 - `sensitivities.Gradients`
        """Return the gradient of a number that depends on the grid's nodes, in all that the grid was made of.

        One linear system is solved, whatever the number of data: the Hessian's at the minimum, by the solver's own
        multigrid, and as well as the grid was: with `tolerance=1e-12` derivatives have some ten digits.

        Args:
            cotangent: the derivatives of the number in the nodes, (ni, nj, 2); of several numbers, (m, ni, nj, 2). For
                several blocks a mapping from their names, or a sequence of one such array for each; the derivative in
                a node with several copies is the sum over these.

        Returns:
            The `Gradients`: in boundary nodes, parameters, weight, fields, target, walls and curves.

        Raises:
            GridgenError: for a result that is no converged minimum, or whose Hessian is singular.
        """
        return provided("sensitivities").vjp(self, cotangent)

    def jvp(self, **tangents: Any) -> Any:  # noqa: ANN401
        """Return how the grid's nodes move as what it was made of changes, per unit of that change.

        Args:
            tangents: the directions: `boundary` (ni, nj, 2), of which nodes that stay count; `parameters` by name;
                `weight` and `fields` (by name) in the form in which they were given, or as anything that they may be
                given as; `target`, `walls` by side, `slide` by side; see the `Gradients` of `vjp` for the forms.

        Returns:
            (ni, nj, 2); for several blocks a mapping from their names.

        Raises:
            GridgenError: as for `vjp`.
        """
        return provided("sensitivities").jvp(self, **tangents)
