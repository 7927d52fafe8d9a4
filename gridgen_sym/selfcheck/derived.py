"""Derived expressions written out in the derivatives of the map, so that numbers can be put in."""

from __future__ import annotations

from typing import Any

#: Derivatives of the map: first, and second.
FIRST = ("x_xi", "y_xi", "x_eta", "y_eta")
SECOND = ("x_xixi", "x_xieta", "x_etaeta", "y_xixi", "y_xieta", "y_etaeta")


def written_out(expression: Any) -> Any:  # noqa: ANN401 - SymPy expressions; SymPy is not imported here
    """Return an expression with the metric written out and the weight 1."""
    from ..symbolic.coordinates import expand_metric, s
    from ..symbolic.definiteness import almost_everywhere

    return almost_everywhere(expand_metric(expression).subs(s, 1))
