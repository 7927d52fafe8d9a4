"""Measures are computed when they are asked for, by bands of rows, and are those of a plain loop over corners."""

import copy
import dataclasses
import math
import pickle

import numpy as np
import pytest

from gridgen_sym.boundary import domain
from gridgen_sym.grids import Grid, measures, quality

#: The nodes of the corners of a cell, and their next nodes along xi and eta; True where one edge points inwards.
CORNERS = (((0, 0), 0, 0, False), ((1, 0), 0, 1, True), ((1, 1), 1, 1, False), ((0, 1), 1, 0, True))


def plain(xy):
    """Return the measures by a loop over cells and corners, in the words of their definitions."""
    jacobians, scaled, conditions, angles, off, aspects, areas = [], [], [], [], [], [], {}
    for i, j in np.ndindex(xy.shape[0] - 1, xy.shape[1] - 1):
        cell = xy[i : i + 2, j : j + 2]
        along_xi = [cell[1, side] - cell[0, side] for side in (0, 1)]
        along_eta = [cell[side, 1] - cell[side, 0] for side in (0, 1)]
        own = []
        for _, bottom, left, turned in CORNERS:
            g1, g2 = along_xi[bottom], along_eta[left]
            J, g12, product = g1[0] * g2[1] - g1[1] * g2[0], float(g1 @ g2), math.hypot(*g1) * math.hypot(*g2)
            own.append(J)
            scaled.append(J / product if product > 0 else 0.0)
            conditions.append((g1 @ g1 + g2 @ g2) / J if J > 0 else math.inf)
            angles.append(math.degrees(math.atan2(J, -g12 if turned else g12)) % 360 if product > 0 else 0.0)
            off.append(math.degrees(math.atan2(abs(g12), abs(J))) if product > 0 else 90.0)
        jacobians += own
        areas[i, j] = sum(own) / 4
        width, height = (sum(math.hypot(*edge) for edge in edges) for edges in (along_xi, along_eta))
        aspects.append(max(width, height) / min(width, height) if min(width, height) > 0 else math.inf)
    ratios = [
        max(area / areas[beside], areas[beside] / area) if min(areas.values()) > 0 else math.inf
        for (i, j), area in areas.items()
        for beside in ((i + 1, j), (i, j + 1))
        if beside in areas
    ]
    finite = [one for one in conditions if one < math.inf]
    folded = np.array(jacobians).reshape(-1, 4).min(axis=1) <= 0
    return {
        "cells": len(areas),
        "folded_cells": int(folded.sum()),
        "folded": [list(index) for index, is_folded in zip(areas, folded, strict=True) if is_folded],
        "min_jacobian": min(jacobians),
        "mean_jacobian": np.mean(jacobians),
        "max_jacobian": max(jacobians),
        "min_scaled_jacobian": min(scaled),
        "mean_condition": np.mean(finite) if finite else math.inf,
        "max_condition": max(conditions),
        "min_angle": min(angles),
        "max_angle": max(angles),
        "max_aspect_ratio": max(aspects),
        "max_area_ratio": max(ratios),
        "non_orthogonality": [np.mean(off), np.percentile(off, 95), max(off)],
    }


@pytest.mark.parametrize("band", [1, 30, 10_000])
@pytest.mark.parametrize("shape", [(3, 3), (12, 7), (5, 14)], ids=str)
@pytest.mark.parametrize("noise", [0.0, 0.15, 0.6], ids=str)
def test_measures_are_those_of_a_loop_over_corners(monkeypatch, band, shape, noise):
    monkeypatch.setattr(measures, "_BAND", band)
    random = np.random.default_rng(3)
    xy = np.stack(np.meshgrid(*(np.arange(count) ** 1.1 for count in shape), indexing="ij"), axis=-1)
    xy += noise * random.uniform(-1, 1, xy.shape)
    if noise == 0.6:
        xy[1, 1] = xy[0, 1]  # An edge of no length.
    found = quality(Grid(xy))
    for name, expected in plain(xy).items():
        value = getattr(found, name)
        value = dataclasses.astuple(value) if name == "non_orthogonality" else value
        np.testing.assert_allclose(value, np.reshape(expected, np.shape(value)), rtol=1e-12, atol=1e-12, err_msg=name)


def test_a_measure_is_computed_when_it_is_asked_for():
    found = quality(domain("wavy", 9, 9))
    assert found.valid  # Which needs the Jacobians alone.
    assert object.__getattribute__(found, "min_jacobian") > 0
    for name in ("min_angle", "max_condition", "max_area_ratio", "sides"):
        with pytest.raises(AttributeError):
            object.__getattribute__(found, name)
    with pytest.raises(AttributeError, match="no attribute 'min_angel'"):
        found.min_angel  # noqa: B018


def test_a_quality_is_a_value():
    grid = domain("wavy", 9, 9)
    found, again = quality(grid), quality(grid)
    assert found.min_jacobian > 0  # The others are not there yet.
    for same in (again, pickle.loads(pickle.dumps(found)), copy.copy(again), dataclasses.replace(again)):
        assert same == found
        assert hash(same) == hash(found)
        assert str(same) == str(found)
        assert repr(same) == repr(found)
    assert found != quality(domain("swan", 9, 9))
    with pytest.raises(dataclasses.FrozenInstanceError):
        found.min_angle = 0.0
    assert {field.name for field in dataclasses.fields(found)} == {*measures.GROUPS}


def test_overflowing_jacobians_are_folded():
    i, j = np.mgrid[:5.0, :4.0]
    found = quality(Grid.from_planes(1e160 * (2 * i + j), 1e160 * (i + 2 * j)))  # J = inf - inf.
    assert found.folded_cells == found.cells
    assert np.isnan(found.min_jacobian)
