"""The legend of a picture: below the tick labels, in as few rows as there is room for."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_HANDLE, _LETTER = 0.5, 0.065  # Inches that an entry takes for its line, and for each letter.


def write_legend(ax: Axes, marker_scale: float) -> None:
    """Write the legend of what has a label, if anything has; markers are `marker_scale` times as large in it."""
    labels = ax.get_legend_handles_labels()[1]
    if labels:
        ax.legend(
            loc="upper center",
            bbox_to_anchor=(0.5, 0.0),
            borderaxespad=2.6,  # Below the tick labels, however low the axes are: in units of the font's size.
            fontsize=8,
            frameon=False,
            markerscale=marker_scale,
            ncols=_columns(labels, _room(ax)),
        )


def _room(ax: Axes) -> float:
    """Return the width in inches that belongs to axes: of panels beside each other, that of the column."""
    width, place = float(ax.figure.figure.get_figwidth()), ax.get_subplotspec()
    if place is None:
        return width * float(ax.get_position().width)
    ratios = np.asarray(place.get_gridspec().get_width_ratios(), dtype=float)
    return float(width * ratios[place.colspan.start : place.colspan.stop].sum() / ratios.sum())


def _columns(labels: Sequence[str], width: float) -> int:
    """Return the number of columns that have room in a width in inches, all rows about as long."""
    most = max(1, int(width / (_HANDLE + _LETTER * max(map(len, labels)))))
    return math.ceil(len(labels) / math.ceil(len(labels) / most))
