"""Functionals made for adaptation: they equidistribute a weight, and a barrier keeps every cell valid."""

from __future__ import annotations

from typing import Any

from .metric import Metric
from .registry import builtin


@builtin(
    constraints=("k > 0",),
    reference="Section 2.1, with the barrier of Section 2.5",
    use_when=(
        "To adapt with a weight: cells are small where it is large, and none folds. `gg.adapt` uses it, and scales the "
        "weight. With your own weight choose `k` small beside s·J², where J is that of the map of the unit square: "
        "on average the area of the domain, whatever the number of nodes. Else the grid is that of `winslow`."
    ),
    avoid_when=(
        "without a weight, where `winslow` is simpler; and where `s J` must be constant exactly: the little of "
        "`winslow` takes its share."
    ),
)
def area_winslow(m: Metric, k: float = 0.02) -> Any:  # noqa: ANN401
    """Weighted area, with a little of winslow: it alone would be degenerate, and would fold."""
    return m.s * m.J**2 / 2 + k * (m.g11 + m.g22) / m.J
