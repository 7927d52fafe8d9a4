"""What a package that is not installed would read or project is one error with the command that installs it."""

from __future__ import annotations

import sys

import numpy as np
import pytest

import gridgen_sym as gg
from gridgen_sym.outlines import read_content

FILES = {
    "lake.wkt": (b"POLYGON ((0 0, 1 0, 1 1, 0 0))", "shapely"),
    "lake.shp": (b"\x00\x00\x27\x0a" + bytes(100), "pyshp"),
    "box.dxf": (b"0\nSECTION\n", "ezdxf"),
    "box.svg": (b"<svg/>", "svgelements"),
}


@pytest.fixture(autouse=True)
def _nothing_is_installed(monkeypatch):
    for module in ("shapely", "shapefile", "ezdxf", "svgelements", "pyproj", "netCDF4"):
        monkeypatch.setitem(sys.modules, module, None)


@pytest.mark.parametrize("name", FILES)
def test_a_file_names_the_package_that_reads_it(tmp_path, name):
    content, package = FILES[name]
    (tmp_path / name).write_bytes(content)
    with pytest.raises(gg.MissingExtraError, match=rf"needs the package '{package}'.*gridgen-sym\[geo\]"):
        read_content(tmp_path / name)


def test_projections_and_netcdf_name_theirs(tmp_path):
    grid = gg.domain("square", 4, 4)
    with pytest.raises(gg.MissingExtraError, match=r"'pyproj'.*gridgen-sym\[geo\]"):
        gg.project([[0, 0], [1, 1]])
    with pytest.raises(gg.MissingExtraError, match=r"'pyproj'.*gridgen-sym\[geo\]"):
        assert gg.ocean_grid(grid, geographic=True)["pm"]
    with pytest.raises(gg.MissingExtraError, match=r"'netCDF4'.*gridgen-sym\[ocean\]"):
        gg.ocean_grid(grid).write(tmp_path / "a.nc")
    (tmp_path / "b.nc").write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(100))
    with pytest.raises(gg.MissingExtraError, match=r"'netCDF4'.*gridgen-sym\[ocean\]"):
        gg.read(tmp_path / "b.nc")
    np.testing.assert_array_equal(gg.ocean_grid(grid)["mask_rho"], 1)  # A plane needs neither.
