"""Pictures of certificates."""

from __future__ import annotations

import numpy as np
import pytest
from support_boundaries import flat_polygon, grid_of_ring, smooth_curve

import gridgen_sym as gg
from gridgen_sym.errors import GridgenError


def square(**moved):
    """The unit square of 8 x 8 cells with some nodes of its bottom moved: b3=(x, y)."""
    xy = gg.domain("square", 9, 9).xy
    for name, point in moved.items():
        xy[int(name[1:]), 0] = point
    return gg.transfinite(xy[:, 0], xy[:, -1], xy[0], xy[-1])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("grid", "titles"),
    [
        (square(b1=(0.0, -0.1), b2=(0.2, -0.1)), ["1: corner 0 has 180 degrees"]),
        (square(b4=(0.5, 1.1)), ["1: the boundary crosses itself"]),
        (square(b4=(0.375, 0.0)), ["1: two nodes at one point"]),
        (square(b3=(0.5, 0.25), b4=(0.5, 0.75), b5=(0.5, 0.25)), ["1: the boundary runs back"]),
        (gg.Grid(square().xy[::-1]), ["1: the boundary runs clockwise"]),
        (grid_of_ring(smooth_curve(2741, 16, 0.6), 5, 5), ["1: 2 cells cannot all be valid"]),
        (grid_of_ring(flat_polygon(9, 12, 1e-2), 3, 5), ["1: 3 cells cannot all be valid (stretched)"]),
    ],
)
def test_each_kind_has_a_panel(grid, titles, tmp_path):
    found = gg.certificates(grid, search=True)
    figure = gg.plot_certificates(grid, tmp_path / "why.png")
    whole, *panels = figure.axes
    assert whole.get_title() == "no valid grid exists"
    assert [ax.get_title() for ax in panels] == titles
    assert [text.get_text() for text in whole.texts] == ["1"]
    for ax, certificate in zip(panels, found, strict=True):
        (x0, x1), (y0, y1) = ax.get_xlim(), ax.get_ylim()
        assert x0 < certificate.point[0] < x1
        assert y0 < certificate.point[1] < y1
    assert (tmp_path / "why.png").read_bytes().startswith(b"\x89PNG")


def test_of_many_certificates_the_first_are_drawn():
    i, j = np.meshgrid(np.arange(12), np.arange(3), indexing="ij")
    xy = np.stack((i, j), axis=-1).astype(float)
    xy[1:-1:2, 0] += [0, 2.5]
    xy[1:-1:2, 0, 0] -= 0.9
    xy[2:-1:2, -1, 0] += 0.9
    grid = gg.Grid(xy)
    few = gg.certificates(grid)
    figure = gg.plot_certificates(grid, found=few * 6)
    assert len(figure.axes) == 6
    assert figure.axes[0].get_title() == f"no valid grid exists, 5 of {6 * len(few)} shown"


def test_without_a_certificate_there_is_no_picture():
    with pytest.raises(GridgenError, match="has none"):
        gg.plot_certificates(square())
