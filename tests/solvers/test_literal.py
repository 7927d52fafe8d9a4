"""The paper's literal minimum: its sums run over corners at inner nodes, so that others have no barrier (E10)."""

from __future__ import annotations

import numpy as np
import pytest

import gridgen_sym as gg
from gridgen_sym.solvers.problem import smallest_inner_jacobian


def pinched(x, y):
    """Return 3 x 3 nodes of the unit square, the bottom one in the middle at (0.15, 1/2), the inner one at (x, y)."""
    planes = np.stack(np.meshgrid([0, 0.5, 1], [0, 0.5, 1], indexing="ij"))
    planes[:, 1, 0], planes[:, 1, 1] = (0.15, 0.5), (x, y)
    return gg.Grid.from_planes(*planes)


@pytest.mark.parametrize("start", [(0.5, 0.75), (0.4, 0.8), (0.5, 0.5)])
@pytest.mark.parametrize("method", ["newton", "local"])
def test_the_literal_minimum_has_a_folded_corner_at_a_boundary_node(start, method):
    options = {"interior_only": True, "keep_valid": False, "spacing": "index"}
    result = gg.optimize(pinched(*start), "winslow", method, **options, tolerance=1e-9)
    assert result.converged
    assert (result.grid.x[1, 1], result.grid.y[1, 1]) == pytest.approx((0.310, 0.676), abs=5e-4)
    assert result.energy == pytest.approx(17.25, abs=5e-3)
    assert gg.quality(result.grid).min_jacobian == pytest.approx(-0.053, abs=5e-4)
    assert result.status is gg.Status.FOLDED
    assert "1 cell is folded" in result.message


def test_with_keep_valid_no_corner_folds():
    result = gg.optimize(pinched(0.5, 0.75), "winslow", interior_only=True)
    assert gg.quality(result.grid).valid


def test_summed_corners_keep_their_barrier():
    """Many nodes: corners at inner nodes stay valid, those at the boundary need not."""
    start = gg.domain("swan", 9, 9)
    result = gg.optimize(start, "winslow", interior_only=True, keep_valid=False)
    assert smallest_inner_jacobian(result.grid.planes) > 0
    assert result.energy < gg.energy(gg.optimize(start, "winslow").grid, "winslow", interior_only=True)


def test_no_more_than_the_summed_corners_must_be_untangled():
    """The boundary turns the wrong way at a corner, in whose corner no sum has a part."""
    xy = gg.domain("square", 5, 5).xy
    xy[0, 0], xy[2, 2] = 0.4, 0.9
    literal = gg.optimize(gg.Grid(xy), "winslow", interior_only=True, keep_valid=False)
    assert literal.converged
    assert literal.quality.folded_cells == 1
    assert smallest_inner_jacobian(literal.grid.planes) > 0
    assert not gg.optimize(gg.Grid(xy), "winslow", interior_only=True).converged


def test_corners_at_inner_nodes():
    planes = np.stack(np.meshgrid(np.arange(4.0), np.arange(5.0), indexing="ij"))
    assert smallest_inner_jacobian(planes) == 1
    planes[0, 1, 0] = 3.5  # A corner at this boundary node folds, and none at an inner node.
    assert gg.quality(gg.Grid.from_planes(*planes)).min_jacobian < 0
    assert smallest_inner_jacobian(planes) == 1
    planes[0, 1, 1] = 2.5
    assert smallest_inner_jacobian(planes) < 0
