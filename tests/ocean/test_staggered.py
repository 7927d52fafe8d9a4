"""Staggered points, masks and metric of a plane grid, against what they are by definition."""

from __future__ import annotations

import numpy as np
import pytest

import gridgen_sym as gg
from gridgen_sym.ocean.staggered import masks, staggered

SHEARED = gg.Grid.from_planes(*(lambda i, j: (100.0 * i + 50.0 * j, 200.0 * j))(*np.mgrid[:5, :4]))


def test_points_are_where_the_index_puts_them():
    """On a grid that is linear in the index every point is at its index, also in the layer outside."""
    points = staggered(SHEARED.xy)
    for name, (a, b), shape in (("rho", (-0.5, -0.5), (6, 5)), ("u", (0, -0.5), (5, 5)), ("v", (-0.5, 0), (6, 4))):
        i, j = np.mgrid[: shape[0], : shape[1]] + np.reshape((a, b), (2, 1, 1))
        np.testing.assert_allclose(getattr(points, name), np.stack((100 * i + 50 * j, 200 * j), axis=-1))
    np.testing.assert_array_equal(points.psi, SHEARED.xy)


def test_metric_of_a_plane_grid():
    made = gg.ocean_grid(SHEARED)
    np.testing.assert_allclose(made["pm"], np.full((5, 6), 1 / 100))
    np.testing.assert_allclose(made["pn"], np.full((5, 6), 1 / np.hypot(50, 200)))
    np.testing.assert_allclose(made["angle"], 0, atol=1e-12)
    assert (float(made["xl"]), float(made["el"])) == pytest.approx((400, 3 * np.hypot(50, 200)))
    assert made["spherical"] == b"F"
    with pytest.raises(gg.GridgenError, match="the grid has no variable 'lon_rho'; it has grid, spherical, x_rho"):
        made["lon_rho"]


def test_derivatives_of_the_metric():
    """On an exponential spacing 1/pn along xi, and 1/pm along eta, change by known differences."""
    i, j = np.mgrid[:7, :6]
    grid = gg.Grid.from_planes(i * (1 + 0.1 * j), j * (1 + 0.2 * i))
    made = gg.ocean_grid(grid)
    dx, dy = 1 / made["pm"].T, 1 / made["pn"].T
    np.testing.assert_allclose(made["dndx"].T[1:-1], (dy[2:] - dy[:-2]) / 2)
    np.testing.assert_allclose(made["dmde"].T[:, 1:-1], (dx[:, 2:] - dx[:, :-2]) / 2)
    assert np.ptp(made["dndx"]) > 0.1


def test_masks_need_sea_all_around():
    sea = np.ones((4, 5))
    sea[1, 2] = 0
    found = masks(sea)
    assert {kind: int((mask == 0).sum()) for kind, mask in found.items()} == {"rho": 1, "u": 2, "v": 2, "psi": 4}
    assert found["psi"].shape == (3, 4)
    assert (found["psi"][:2, 1:3] == 0).all()


def test_land_is_where_islands_a_function_or_missing_depth_say(capsys):
    grid = gg.domain("square", 11, 11)
    island = [[0.31, 0.31], [0.61, 0.31], [0.61, 0.61], [0.31, 0.61]]
    made = gg.ocean_grid(grid, islands=[island, [[0.01, 0.01], [0.02, 0.01], [0.01, 0.02]]])
    assert int((made["mask_rho"][1:-1, 1:-1] == 0).sum()) == 9
    assert "1 of 2 islands hold no center of a cell" in capsys.readouterr().err
    made = gg.ocean_grid(grid, land=lambda x, y: x < 0.2, depth=lambda x, y: np.where(y < 0.5, 10 - 20 * y, np.nan))
    mask = made["mask_rho"]
    assert mask[:6, 3:].all()
    assert not mask[:, :3].any()
    assert not mask[6:].any()
    assert made["h"].min() == 1.0
    shallow = gg.ocean_grid(grid, depth=lambda x, y: 3 * x, min_depth=2)
    np.testing.assert_allclose(shallow["h"][3, 1:-1], np.maximum(2, 3 * shallow["x_rho"][3, 1:-1]))
    np.testing.assert_allclose(made["h"][1:4, 4], [9, 7, 5])
    np.testing.assert_array_equal(mask[0], mask[1])  # The ring outside is as its neighbors.


def test_what_lies_outside_of_the_coast_is_land():
    grid = gg.domain("square", 11, 11)
    pond = [[0.2, 0.2], [0.8, 0.2], [0.8, 0.8], [0.2, 0.8]]
    mask = gg.ocean_grid(grid, coast=pond, islands=[[[0.4, 0.4], [0.6, 0.4], [0.6, 0.6], [0.4, 0.6]]])["mask_rho"]
    assert mask.sum() == 36 - 4
    assert mask[4, 4] == 1
    assert mask[5, 5] == 0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"depth": np.ones((3, 3))}, r"depth must have a value at each rho point, shape \(6, 5\); came \(3, 3\)"),
        ({"min_depth": 0}, "min_depth must be positive"),
        ({"geographic": True, "projection": object()}, "is in no plane"),
    ],
)
def test_what_does_not_fit_is_refused(options, message):
    with pytest.raises(gg.GridgenError, match=message):
        gg.ocean_grid(SHEARED, **options)


def test_samples_must_reach_all_cells_and_may_be_missing():
    x = np.linspace(-50, 700, 40)
    values = np.full((40, 40), 5.0)
    values[x > 300] = np.nan
    made = gg.ocean_grid(SHEARED, depth=gg.raster_field(x, x, values))
    where = gg.ocean_grid(SHEARED)["x_rho"]
    np.testing.assert_array_equal(made["mask_rho"][1:-1, 1:-1], (where < x[x <= 300][-1] + 10)[1:-1, 1:-1])
    with pytest.raises(gg.GridgenError, match=r"depth is known by samples that do not reach \d+ of 12 cells"):
        gg.ocean_grid(SHEARED, depth=gg.raster_field(x[:20], x, np.ones((20, 40))))
    gg.ocean_grid(SHEARED, depth=gg.raster_field(x[:20], x, np.ones((20, 40)), outside="nearest"))
