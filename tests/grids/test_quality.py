"""The measures of a grid."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from gridgen_sym.boundary import domain
from gridgen_sym.grids import Grid, quality


def rectangle(ni, nj, width, height):
    """A lattice of cells of width by height."""
    return np.stack(np.meshgrid(width * np.arange(ni), height * np.arange(nj), indexing="ij"), axis=-1)


def test_a_lattice_in_exact_numbers():
    report = quality(Grid(rectangle(5, 4, 2.0, 0.5)))
    assert report.valid
    assert (report.cells, report.folded_cells) == (12, 0)
    assert report.min_jacobian == report.mean_jacobian == report.max_jacobian == 1.0
    assert report.min_scaled_jacobian == 1.0
    assert report.mean_condition == report.max_condition == 4.25
    assert report.min_angle == report.max_angle == 90.0
    assert report.max_aspect_ratio == 4.0
    assert report.max_area_ratio == 1.0
    assert report.folded.shape == (0, 2)
    assert report.folded_centers.shape == (0, 2)


def test_a_sheared_lattice():
    xy = rectangle(4, 4, 1.0, 1.0)
    xy[..., 0] += xy[..., 1]
    report = quality(Grid(xy))
    assert report.min_angle == pytest.approx(45.0)
    assert report.max_angle == pytest.approx(135.0)
    assert report.min_scaled_jacobian == pytest.approx(np.sqrt(0.5))
    assert report.max_condition == pytest.approx(3.0)
    assert report.max_aspect_ratio == pytest.approx(np.sqrt(2))


def test_area_ratio_along_both_axes():
    x, y = np.array([0.0, 1.0, 4.0, 5.0]), np.array([0.0, 1.0, 2.0])
    for planes in (np.meshgrid(x, y, indexing="ij"), np.meshgrid(y, x, indexing="ij")):
        assert quality(Grid.from_planes(*planes)).max_area_ratio == pytest.approx(3.0)


def test_a_reflex_corner_is_folded_and_its_angle_is_over_180():
    xy = rectangle(4, 4, 1.0, 1.0)
    xy[1, 1] = [0.4, 0.4]  # Over the diagonal of the cell (0, 0) only.
    report = quality(Grid(xy))
    assert report.folded_cells == 1
    assert report.folded.tolist() == [[0, 0]]
    assert report.describe_folds().startswith("not valid: 1 of 9 cells is folded")
    assert report.folded_centers == pytest.approx(np.array([[0.35, 0.35]]))
    assert report.min_jacobian == pytest.approx(-0.2)
    assert report.max_angle == pytest.approx(360 - np.degrees(np.arccos(-0.48 / 0.52)))
    assert report.max_condition == np.inf
    assert np.isfinite(report.mean_condition)


def test_a_cell_that_is_only_touched_is_folded():
    xy = rectangle(4, 4, 1.0, 1.0)
    xy[1, 1] = [0.5, 0.5]  # On the diagonal: J = 0 exactly.
    report = quality(Grid(xy))
    assert report.folded_cells == 1
    assert report.min_jacobian == 0.0
    assert report.max_angle == pytest.approx(180.0)


def test_a_turned_over_grid():
    report = quality(Grid(rectangle(4, 4, 1.0, 1.0)[::-1]))
    assert report.folded_cells == report.cells == 9
    assert report.max_area_ratio == np.inf
    assert report.mean_condition == np.inf
    assert report.min_angle == report.max_angle == 270.0
    assert "and 4 more" in report.describe_folds()


def test_edges_of_no_length():
    xy = rectangle(4, 4, 1.0, 1.0)
    xy[0] = [0.0, 1.5]  # The left side is one point.
    report = quality(Grid(xy))
    assert report.folded_cells == 3
    assert report.min_jacobian == 0.0
    assert report.min_scaled_jacobian == 0.0
    assert report.min_angle == 0.0
    point = quality(Grid(np.ones((3, 3, 2))))
    assert point.folded_cells == 4
    assert point.max_aspect_ratio == point.max_area_ratio == point.mean_condition == np.inf


def test_the_report_says_how_many_and_where():
    report = quality(domain("swan", 41, 41))
    text = report.describe_folds(limit=2)
    assert "57 of 1600 cells are folded" in text
    assert text.count("cell (") == 2
    assert "cell (5, 39) at (0.140852, 0.636629)" in text
    assert text.endswith("and 55 more")
    assert report.describe_folds(limit=100).count("cell (") == 57
    assert report.describe_folds(limit=0).count("\n") == 0
    assert str(report) == report.summary()
    assert "folded cells                  57" in str(report)
    assert quality(domain("square", 4, 4)).describe_folds() == "valid: no folded cell among 9"


def test_equal_grids_have_equal_quality():
    assert quality(domain("swan", 9, 9)) == quality(domain("swan", 9, 9))
    assert quality(domain("swan", 9, 9)) != quality(domain("swan", 9, 10))


@given(
    hnp.arrays(
        np.float64,
        st.tuples(st.integers(3, 5), st.integers(3, 5), st.just(2)),
        elements=st.floats(allow_nan=False, allow_infinity=False) | st.sampled_from([0.0, 1.0, 5e-324, 1.7e308]),
    )
)
def test_no_grid_warns_and_folds_agree_with_the_smallest_jacobian(xy):
    report = quality(Grid(xy))
    assert report.valid == (report.min_jacobian > 0)
    assert len(report.folded) == report.folded_cells <= report.cells
    assert str(report)


def test_a_dictionary_has_every_measure_as_json_has_it():
    xy = np.stack(np.meshgrid([0.0, 1, 2, 3], [0.0, 1, 2], indexing="ij"), axis=-1)
    xy[1, 1] = xy[0, 1]  # An edge without a length: ratios that are infinite.
    found = quality(Grid(xy))
    told = json.loads(json.dumps(found.as_dict(), allow_nan=False))
    assert set(told) == {"valid", *(one.name for one in dataclasses.fields(found))}
    assert told["max_condition"] is None
    assert told["folded"] == found.folded.tolist()
    assert told["min_jacobian"] == found.min_jacobian
    assert told["sides"]["bottom"] == {
        "side": "bottom",
        "first_heights": list(found.sides["bottom"].first_heights),
        "growth": list(found.sides["bottom"].growth),
        "non_orthogonality": dataclasses.asdict(found.sides["bottom"].non_orthogonality),
    }
