"""Drawings: DXF written by ezdxf, SVG as programs write it; each against the curve that it draws."""

from __future__ import annotations

import numpy as np
import pytest

import gridgen_sym as gg
from gridgen_sym.outlines import read_content

pytestmark = pytest.mark.extras

SVG = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 100 100">{}</svg>'


def area(curve):
    x, y = curve.T
    return abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) / 2


def channel(space):
    """Draw a channel: two lines, a spline below, an arc above, in any order and direction; and a round island."""
    space.add_line((0, 2), (0, 0))
    space.add_spline([(0, 0), (1, 0.2), (3, -0.2), (4, 0)])
    space.add_line((4, 2), (4, 0))
    space.add_arc((2, 2), 2, 0, 180)
    space.add_circle((2, 1), 0.5)
    space.add_text("a channel")


def test_dxf_curves_are_joined_and_a_circle_inside_is_an_island(tmp_path):
    import ezdxf

    drawing = ezdxf.new()
    channel(drawing.modelspace())
    path = tmp_path / "channel.dxf"
    drawing.saveas(path)
    found = read_content(path)
    assert area(found.points) == pytest.approx(8 + 2 * np.pi, rel=5e-3)
    assert area(found.islands[0]) == pytest.approx(np.pi / 4, rel=1e-3)
    assert np.abs(found.points - (2, 2))[found.points[:, 1] > 2.0].max() <= 2 + 1e-9
    assert gg.Outline.read(path, corners="auto").grid(17, 17).shape == (17, 17)
    path.rename(tmp_path / "channel.drawing")
    assert len(read_content(tmp_path / "channel.drawing").islands) == 1


def test_a_dxf_polyline_and_what_is_refused(tmp_path):
    import ezdxf

    drawing = ezdxf.new()
    drawing.modelspace().add_lwpolyline([(0, 0), (2, 0), (2, 1), (0, 1)], close=True)
    path = tmp_path / "box.dxf"
    drawing.saveas(path)
    assert sorted(gg.Outline.read(path, corners="auto").points.tolist()) == [[0, 0], [0, 1], [2, 0], [2, 1]]
    drawing.modelspace().add_line((2, 1), (3, 3))
    drawing.saveas(path)
    with pytest.raises(gg.GridgenError, match=r"as a DXF drawing: a curve ends at \((3, 3|2, 1)\)"):
        read_content(path)
    ezdxf.new().saveas(path)
    with pytest.raises(gg.GridgenError, match="its model space has none of LINE, LWPOLYLINE"):
        read_content(path)
    path.write_text("0\nSECTION\n2\nENTITIES\n0\nLINE\n8\n0\n10\nx\n")
    with pytest.raises(gg.GridgenError, match=r"box\.dxf as a DXF drawing: "):
        read_content(path)


@pytest.mark.parametrize(
    "inner",
    [
        '<path d="M0 0 H40 V30 H0 Z"/>',
        '<path d="M0 0 H40 V30"/><path d="M0,0 v30 h40"/>',
        '<rect width="40" height="30"/>',
        '<polygon points="0,0 40,0 40,30 0,30"/>',
        '<g transform="translate(10 0)"><g transform="scale(2)"><rect x="-5" width="20" height="15"/></g></g>',
        '<defs><rect width="90" height="90"/></defs><rect width="40" height="30"/><text>t</text>',
    ],
)
def test_svg_shapes_are_curves_with_y_upwards(tmp_path, inner):
    path = tmp_path / "box.svg"
    path.write_text(SVG.format(inner))
    points = gg.Outline.read(path, corners="auto").points
    assert sorted(np.round(points, 9).tolist()) == [[0, -30], [0, 0], [40, -30], [40, 0]]


def test_svg_curves_and_islands(tmp_path):
    path = tmp_path / "pond.svg"
    path.write_text(
        SVG.format('<ellipse cx="50" cy="50" rx="40" ry="20"/><path d="M40 50 a5 5 0 1 0 10 0 a5 5 0 1 0 -10 0z"/>')
    )
    found = read_content(path)
    assert area(found.points) == pytest.approx(np.pi * 800, rel=5e-3)
    assert area(found.islands[0]) == pytest.approx(np.pi * 25, rel=5e-3)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('<!DOCTYPE svg [<!ENTITY a "b">]>' + SVG.format(""), "it declares entities"),
        ("<svg", "it is no XML"),
        (SVG.format("<g/>"), "it draws none of path, rect"),
        (SVG.format('<path d="M0 0 L1 0 L1 1"/>'), r"a curve ends at \(1, -1\)"),
        (SVG.format('<path d="M0 0 L1"/>'), "box.svg as a SVG drawing"),
        (SVG.format('<path d="M0 0 L1 0"/><path d="M0 0 L1 0"/>'), "no closed curve"),
    ],
)
def test_bad_drawings_are_one_clear_error(tmp_path, text, message):
    path = tmp_path / "box.svg"
    path.write_text(text)
    with pytest.raises(gg.GridgenError, match=message):
        read_content(path)
