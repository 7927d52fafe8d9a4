"""C- and O-grids of airfoils: valid, with the heights that were asked for, at right angles to the wall."""

import numpy as np
import pytest
from click.testing import CliRunner

import gridgen_sym as gg
from gridgen_sym.cli import main

FIRST = 1e-5
WAKE = 24


def wall_of(grid, begin, end):
    """Return first heights and degrees off normal at the nodes of the bottom from `begin` to before `end`."""
    up, along = (grid.xy[:, 1] - grid.xy[:, 0])[begin:end], (grid.xy[2:, 0] - grid.xy[:-2, 0])[begin - 1 : end - 1]
    height = np.hypot(*up.T)
    return height, np.degrees(np.arcsin(np.abs((up * along).sum(axis=1)) / (height * np.hypot(*along.T))))


def check(section, kind, blunt=False):
    result = gg.airfoil_grid(
        section, kind, first=FIRST, cells=(64, 32), wake=WAKE, blunt=blunt, progress=False, time_limit=60
    )
    grid, cut = result.grid, WAKE if kind == "C" else 0
    assert result.converged
    assert result.quality.valid
    assert grid.shape == (65 + 2 * cut + 8 * blunt, 33)
    beside = cut + 2 + 4 * blunt  # But two nodes beside the trailing edge.
    height, off = wall_of(grid, beside, len(grid.xy) - beside)
    assert np.percentile(np.abs(height / FIRST - 1), 99) < 0.01
    assert np.percentile(off, 95) < 2
    sides = (grid.xy[: cut + 1, 0], grid.xy[::-1][: cut + 1, 0]) if cut else (grid.xy[0], grid.xy[-1])
    np.testing.assert_array_equal(*sides)  # Of the cut.
    assert np.abs(grid.xy).max() == pytest.approx(21, abs=0.6)
    return result


@pytest.mark.parametrize(("section", "kind"), [("naca2412", "C"), ("naca0012", "O")])
def test_a_section_has_the_wall_that_was_asked_for(section, kind):
    check(section, kind)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("section", "kind", "blunt"),
    [("naca0012", "C", False), ("naca2412", "O", False), ("naca23012", "C", True), ("naca23012", "O", True)],
)
def test_more_sections_have_the_wall_that_was_asked_for(section, kind, blunt):
    check(section, kind, blunt)


def test_heights_grow_by_the_factor_that_was_asked_for():
    result = gg.airfoil_grid("naca0012", "O", first=1e-3, growth=1.3, cells=(32, 36), progress=False)
    assert result.quality.sides["bottom"].growth[1] == pytest.approx(1.3, rel=0.01)


def test_the_command_makes_a_grid_from_a_file(tmp_path):
    from gridgen_sym.boundary.naca import naca_points

    path, out = tmp_path / "section.dat", tmp_path / "c.p2dfmt"
    path.write_text("a section\n" + "".join(f"{x:.6f} {y:.6f}\n" for x, y in naca_points("4415", count=60)[::-1]))
    arguments = ["airfoil", str(path), "--type", "C", "--first", "1e-4", "--far", "10", "--size", "32x16"]
    done = CliRunner().invoke(main, [*arguments, "--wake", "12", "-o", str(out)])
    assert done.exit_code == 0, done.output
    assert "valid: no folded cell" in done.output
    assert out.read_text().startswith("1\n57 17\n")
    height, _ = wall_of(gg.read(out), 14, 43)
    np.testing.assert_allclose(height, 1e-4, rtol=0.01)


@pytest.mark.parametrize(("kind", "nodes", "far"), [("C", 41 * 9 - 13, 40 + 2 * 8), ("O", 16 * 9, 16)])
def test_a_solver_gets_the_cut_closed_and_the_names(tmp_path, kind, nodes, far):
    arguments = ["airfoil", "naca0012", "--type", kind, "--first", "1e-2", "--far", "5", "--size", "16x8"]
    done = CliRunner().invoke(main, [*arguments, "--wake", "12", "-o", str(tmp_path / "a.su2")])
    assert done.exit_code == 0, done.output
    text = (tmp_path / "a.su2").read_text()
    assert f"NPOIN= {nodes}\n" in text
    assert "MARKER_TAG= wall\nMARKER_ELEMS= 16\n" in text
    assert f"MARKER_TAG= farfield\nMARKER_ELEMS= {far}\n" in text


@pytest.mark.parametrize(
    ("options", "match"),
    [
        ({"kind": "H"}, "kind of an airfoil's grid must be 'C' or 'O'; came 'H'"),
        ({"cells": (33, 16)}, "cells must be two numbers"),
        ({"wake": 2}, "wake must be at least 3 cells"),
        ({"far": 0.5}, "far must be more than 1 chord"),
        ({"first": 0.5}, "first must be less than a chord"),
        ({"first": -1}, "first of the wall must be a positive height"),
        ({"leading": 1.0}, "leading must be between 0 and the mean length"),
        ({"section": "nowhere.dat"}, "nowhere.dat"),
    ],
)
def test_numbers_without_a_place_are_refused(options, match):
    with pytest.raises(gg.GridgenError, match=match):
        gg.airfoil_grid(**{"section": "naca0012", "cells": (32, 16), **options})
