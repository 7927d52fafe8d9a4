"""Files of ocean models, opened by xarray and xgcm; lengths against great circles; the command line."""

from __future__ import annotations

import contextlib
import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

import gridgen_sym as gg
from gridgen_sym.cli import main
from gridgen_sym.fields.netcdf_samples import read_samples

pytestmark = pytest.mark.extras

RADIUS = 6371e3
#: A curved sea of 8 by 5 degrees with an island.
PLACES = [[x, 40 + 0.5 * np.sin(x)] for x in np.linspace(0, 8, 17)]
PLACES += [[8, 42], *([x, 45 + 0.5 * np.sin(x)] for x in np.linspace(8, 0, 17)), [0, 42]]
ISLAND = [[3, 42], [4.5, 42], [4.5, 43], [3, 43], [3, 42]]


@pytest.fixture
def sea(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    top = {
        "type": "Feature",
        "properties": {"name": "sea", "corners": [0, 16, 18, 34]},
        "geometry": {"type": "Polygon", "coordinates": [[*PLACES, PLACES[0]], ISLAND]},
    }
    (tmp_path / "sea.geojson").write_text(json.dumps(top))
    return "sea.geojson"


def haversine(lon, lat, to_lon, to_lat):
    """Return the great-circle distance on a sphere, in meters."""
    a, b, c, d = np.radians((lon, lat, to_lon, to_lat))
    half = np.sin((d - b) / 2) ** 2 + np.cos(b) * np.cos(d) * np.sin((c - a) / 2) ** 2
    return 2 * RADIUS * np.arcsin(np.sqrt(half))


def made(sea, **options):
    outline = gg.Outline.read(sea, crs="auto")
    grid = gg.optimize(outline.grid(25, 17), "winslow").grid
    return grid, gg.ocean_grid(grid, projection=outline.projection, islands=outline.islands, **options)


def test_xgcm_and_xarray_open_what_is_written(sea):
    import xarray
    import xgcm

    grid, ocean = made(sea, depth=lambda x, y: 100 + x / 1e5)
    ocean.write("sea.nc", title="a sea")
    with xarray.open_dataset("sea.nc") as data:
        assert dict(data.sizes) == {
            **{"xi_rho": 26, "eta_rho": 18, "xi_psi": 25, "eta_psi": 17},
            **{"xi_u": 25, "eta_u": 18, "xi_v": 26, "eta_v": 17},
        }
        assert data.title == "a sea"
        assert data.spherical.item() == b"T"
        for name in ("h", "f", "pm", "pn", "dndx", "dmde", "angle", "mask_rho", "mask_u", "mask_v", "mask_psi"):
            assert np.isfinite(data[name]).all(), name
        for name in ("lon", "lat", "x", "y"):
            assert {f"{name}_{kind}" for kind in ("rho", "u", "v", "psi")} <= {*data.variables}
        assert set(data.pm.encoding["coordinates"].split()) == {"lon_rho", "lat_rho"}
        np.testing.assert_array_equal(data.x_psi.T, grid.x)
        assert 0 < (data.mask_rho == 0).sum() < 60
        parsed = xgcm.Grid(data)  # From SGRID's description in the file.
        assert {axis.coords["center"] for axis in parsed.axes.values()} == {"xi_rho", "eta_rho"}
        assert {axis.coords["inner"] for axis in parsed.axes.values()} == {"xi_psi", "eta_psi"}
        # The difference of the longitudes of neighboring centers is on the edges between them.
        difference = parsed.diff(data.lon_rho.drop_vars(["lon_rho", "lat_rho"], errors="ignore"), "X")
        np.testing.assert_allclose(difference, np.diff(data.lon_rho, axis=1))
        assert difference.dims == ("eta_rho", "xi_psi")


def test_lengths_are_great_circles_and_directions_are_on_earth(sea):
    _, ocean = made(sea)
    lon, lat = ocean["lon_u"], ocean["lat_u"]
    expected = haversine(lon[:, :-1], lat[:, :-1], lon[:, 1:], lat[:, 1:])
    np.testing.assert_allclose(1 / ocean["pm"][:, 1:-1], expected, rtol=4e-3)  # An ellipsoid is no sphere.
    lon, lat = ocean["lon_v"], ocean["lat_v"]
    expected = haversine(lon[:-1], lat[:-1], lon[1:], lat[1:])
    np.testing.assert_allclose(1 / ocean["pn"][1:-1], expected, rtol=4e-3)
    step = 1e-6 * np.exp(1j * ocean["angle"])  # A step along xi on Earth, in degrees of a great circle.
    along = np.diff(ocean["lon_u"]) * np.cos(np.radians(ocean["lat_rho"][:, 1:-1])) + 1j * np.diff(ocean["lat_u"])
    np.testing.assert_allclose(np.angle(along / step[:, 1:-1]), 0, atol=4e-3)
    np.testing.assert_allclose(ocean["f"], 1.4584e-4 * np.sin(np.radians(ocean["lat_rho"])), rtol=1e-4)


def test_lengths_in_longitude_and_latitude_need_no_plane(sea):
    grid, ocean = made(sea)
    places = gg.Outline.read(sea, crs="auto").projection.grid_to_geographic(grid)
    direct = gg.ocean_grid(places, geographic=True)
    np.testing.assert_allclose(direct["pm"], ocean["pm"], rtol=4e-3)
    gg.write(places, "sea.nc", form="lonlat")
    assert gg.read("sea.nc") == places
    with pytest.raises(gg.GridgenError, match="it has no coordinates of nodes: x_psi, y_psi or x_vert"):
        gg.read("sea.nc", form="plane")


def test_ugrid_lists_all_cells_counter_clockwise(sea):
    import xarray

    _, ocean = made(sea, depth=lambda x, y: 0 * x + 7)
    ocean.write("mesh.nc", "ugrid")
    with xarray.open_dataset("mesh.nc") as data:
        mesh = data[next(name for name, one in data.variables.items() if one.attrs.get("cf_role") == "mesh_topology")]
        lon, lat = (data[name].values for name in mesh.node_coordinates.split())
        faces = data[mesh.face_node_connectivity].values
        assert faces.shape == (24 * 16, 4)
        x, y = lon[faces], lat[faces]
        area = (x * np.roll(y, -1, 1) - y * np.roll(x, -1, 1)).sum(axis=1) / 2
        assert (area > 0).all()
        assert set(faces.ravel()) == set(range(25 * 17))
        assert data.h.sizes == {"mesh_face": 24 * 16}
        np.testing.assert_array_equal(data.mask.values.reshape(24, 16), ocean["mask_rho"].T[1:-1, 1:-1])
    with pytest.raises(gg.GridgenError, match="its faces are a list, by UGRID's conventions"):
        gg.read("mesh.nc")
    with pytest.raises(gg.GridgenError, match="the convention must be 'roms' or 'ugrid'; came 'hycom'"):
        ocean.write("mesh.nc", "hycom")


def test_a_plane_grid_comes_back_bit_by_bit_and_damaged_files_are_refused(tmp_path):
    swan = gg.domain("swan", 9, 7)
    path = tmp_path / "swan.nc"
    gg.write(swan, path)
    assert gg.read(path) == swan
    whole = path.read_bytes()
    for data in (whole[: len(whole) // 2], b"CDF\x01" + b"\xff" * 200, b"\x89HDF\r\n\x1a\n" + b"\0" * 90, b"text"):
        path.write_bytes(data)
        with pytest.raises(gg.GridgenError, match=r"swan\.nc as a netCDF grid of ROMS: it "):
            gg.read(path)


def raster(path, *, name="elevation", missing=False, **attributes):
    """Write a raster of heights in longitude from 0 to 360 degrees, north first, with a time, as data centers do."""
    import netCDF4

    lon, lat = np.arange(-2, 12, 0.25) % 360, np.arange(48, 37, -0.25)
    with netCDF4.Dataset(path, "w") as data:
        data.createDimension("time", 1)
        for axis, values, unit in (("lat", lat, "degrees_north"), ("lon", np.sort(lon), "degrees_east")):
            data.createDimension(axis, len(values))
            data.createVariable(axis, "f8", (axis,))[:] = values
            data[axis].units = unit
        made = data.createVariable(name, "f4", ("time", "lat", "lon"), fill_value=-9999.0)
        made.setncatts(attributes)
        height = -100.0 + 0 * lat[:, None] + 0 * lon
        height[:, np.sort(lon) < 1] = np.nan if missing else 50
        made[0] = np.ma.masked_invalid(height)


def classic(path):
    """Write a raster in a classic file, with scaled whole numbers, of which one is missing; y before x."""
    from scipy.io import netcdf_file

    with netcdf_file(path, "w") as data:
        for axis, size in (("y", 4), ("x", 5)):
            data.createDimension(axis, size)
            data.createVariable(axis, "f8", (axis,))[:] = 10.0 * np.arange(size)
        made = data.createVariable("depth", "i2", ("y", "x"))
        made.scale_factor, made.add_offset, made._FillValue = 0.5, 3.0, np.int16(-1)
        made[:] = np.arange(20).reshape(4, 5)
        made[2, 3] = -1


def test_classic_files_are_read_with_scales_and_missing_values(tmp_path):
    path = tmp_path / "a.nc"
    classic(path)
    found = read_samples(path.read_bytes())
    expected = 3 + 0.5 * np.arange(20.0).reshape(4, 5)
    expected[2, 3] = np.nan
    np.testing.assert_array_equal(found.values, expected.T)
    assert (found.name, found.upward, found.x.tolist(), found.y[-1]) == ("depth", False, [0, 10, 20, 30, 40], 30)


@pytest.mark.parametrize("turn", [1, -1])
def test_samples_around_the_earth_have_no_seam(tmp_path, turn):
    import netCDF4

    lon, lat, path = np.arange(-179.5, 180)[::turn], np.arange(-30, 31.0), tmp_path / "a.nc"
    with netCDF4.Dataset(path, "w") as data:
        for name, axis in (("lat", lat), ("lon", lon)):
            data.createDimension(name, len(axis))
            data.createVariable(name, "f8", (name,))[:] = axis
        data.createVariable("h", "f8", ("lat", "lon"))[:] = np.abs(lon) + 0 * lat[:, None]
    found = read_samples(path.read_bytes())
    assert sorted(found.x[[0, -1]]) == [-180.5, 180.5]
    field = gg.raster_field(found.x, found.y, found.values)
    places = np.array([[179, -20], [181, -20], [181, -15], [179, -15.0]])
    projection = gg.project(places)
    flat = field.on_plane(projection)
    x, y = projection.to_plane(np.stack((np.linspace(179, 181, 9), np.full(9, -17.0)), axis=-1)).T
    assert flat.covers(x, y).all()
    np.testing.assert_allclose(flat(x, y), np.minimum(179.5, 180 - np.abs(np.linspace(-1, 1, 9))), atol=1e-9)


def test_axes_are_told_by_name_unit_or_attribute_in_either_order(tmp_path):
    import netCDF4

    for names, attributes in ((("lon", "lat"), {}), (("a", "b"), {"units": ("degrees_east", "degrees_north")})):
        for order in (names, names[::-1]):
            path = tmp_path / "a.nc"
            with netCDF4.Dataset(path, "w") as data:
                for k, (name, size) in enumerate(zip(names, (3, 2), strict=True)):
                    data.createDimension(name, size)
                    data.createVariable(name, "f8", (name,))[:] = np.arange(size) + 10 * k
                    data[name].setncatts({key: value[k] for key, value in attributes.items()})
                values = np.arange(6.0).reshape(3, 2)
                data.createVariable("h", "f8", order)[:] = values if order == names else values.T
            found = read_samples(path.read_bytes())
            assert (found.x.tolist(), found.y.tolist()) == ([0, 1, 2], [10, 11])
            np.testing.assert_array_equal(found.values, values)


@settings(max_examples=80, deadline=None)
@given(st.data())
def test_damaged_files_are_samples_or_one_clear_error(tmp_path_factory, data):
    """The C library crashes on such classic files."""
    path = tmp_path_factory.mktemp("damaged") / "a.nc"
    classic(path)
    content = bytearray(path.read_bytes())
    for place in data.draw(st.lists(st.integers(4, len(content) - 1), min_size=1, max_size=5)):
        content[place] = data.draw(st.integers(0, 255))
    with contextlib.suppress(gg.GridgenError):
        read_samples(bytes(content[: data.draw(st.integers(5, len(content)))]))


def test_a_variable_that_claims_too_much_is_refused_before_it_is_read(tmp_path):
    import netCDF4

    path = tmp_path / "huge.nc"
    with netCDF4.Dataset(path, "w") as data:
        for axis in "yx":
            data.createDimension(axis, 10**6)
        data.createVariable("h", "f8", ("y", "x"), zlib=True)
    with pytest.raises(gg.GridgenError, match="the variable 'h' would need 8000000000000 bytes of memory"):
        read_samples(path.read_bytes(), "h")


def test_depth_comes_from_the_curved_grid_of_another_file(sea):
    """Points with two coordinates each, as `h` in a file of ROMS."""
    run("grid", sea, "-f", "winslow", "--size", 9, 7, "--crs", "auto", "-o", "coarse.nc", "--coast", sea)
    import netCDF4

    with netCDF4.Dataset("coarse.nc", "a") as data:
        made = data.createVariable("h", "f8", ("eta_rho", "xi_rho"))
        made.coordinates = "lon_rho lat_rho"
        made[:] = 10 * data["lat_rho"][:]
    run("grid", sea, "-f", "winslow", "--size", 9, 7, "--crs", "auto", "-o", "fine.nc", "--depth", "coarse.nc:h")
    with netCDF4.Dataset("fine.nc") as data:
        inner = data["mask_rho"][1:-1, 1:-1] == 1
        np.testing.assert_allclose(data["h"][1:-1, 1:-1][inner], 10 * data["lat_rho"][1:-1, 1:-1][inner], rtol=1e-3)


def run(*arguments, code=0):
    result = CliRunner().invoke(main, [str(one) for one in arguments])
    assert result.exit_code == code, (result.output, result.exception)
    return result.output


@pytest.mark.parametrize("missing", [False, True])
def test_the_command_line_from_a_coast_to_a_file_of_roms(sea, missing):
    import netCDF4

    raster("bathy.nc", missing=missing)
    options = ("--size", 20, 14, "--crs", "auto", "-o", "roms.nc", "--depth", "bathy.nc:elevation")
    said = run("grid", sea, "-f", "winslow", *options)
    assert "bathy.nc:elevation holds heights, positive upwards" in said
    with netCDF4.Dataset("roms.nc") as data:
        lon, mask, h = (data[name][1:-1, 1:-1] for name in ("lon_rho", "mask_rho", "h"))
        assert not mask[lon < 0.85].any()
        island = (lon > 3.1) & (lon < 4.4) & (data["lat_rho"][1:-1, 1:-1] > 42.1) & (data["lat_rho"][1:-1, 1:-1] < 42.9)
        assert island.any()
        assert not mask[island].any()
        assert mask[lon > 5].all()
        np.testing.assert_allclose(h[lon > 5], 100)
        assert h.min() == 1.0
    run("grid", "roms.nc", "-f", "winslow", "--crs", "auto", "-o", "again.nc", "--coast", sea)
    with netCDF4.Dataset("again.nc") as data:  # Without the raster; the coast is the boundary of the grid.
        lon, lat, mask = (data[name][1:-1, 1:-1] for name in ("lon_rho", "lat_rho", "mask_rho"))
        island = (lon > 3) & (lon < 4.5) & (lat > 42) & (lat < 43)
        np.testing.assert_array_equal(mask == 0, island)
    run("grid", "roms.nc", "-f", "winslow", "--crs", "auto", "-o", "again.vts")
    before, after = gg.read("roms.nc"), gg.read("again.vts")
    said = run("quality", "again.vts", "--crs", "auto", "--json")
    assert json.loads(said[said.index("{") :])["mean_jacobian"] == pytest.approx(1.2e9, rel=0.2)  # Square meters.
    np.testing.assert_allclose(after.xy[0], before.xy[0], atol=1e-8)  # The boundary, in longitude and latitude again.
    np.testing.assert_allclose(after.xy, before.xy, atol=2e-3)


def test_a_raster_adapts_a_grid_in_longitude_and_latitude(sea):
    raster("bathy.nc", name="depth", positive="down")
    options = ("--size", 20, 14, "--crs", "auto")
    run("adapt", sea, "--to", "bathy.nc:depth", "--monitor", "gradient", *options, "-o", "out.vts")
    lon = gg.read("out.vts").x
    run("grid", sea, "-f", "winslow", *options, "-o", "even.vts")
    near = [(np.abs(one - 1) < 0.5).sum() for one in (lon, gg.read("even.vts").x)]
    assert near[0] > 1.5 * near[1]  # Nodes gather at the shelf at one degree east.


def test_corners_are_places_on_earth(sea):
    path = Path(sea)
    path.write_text(path.read_text().replace('"corners"', '"other"'))
    places = "-0.1,45 0,40 8,40.4 8,45.4"
    run("grid", sea, "-f", "winslow", "--size", 8, 8, "--crs", "auto", "--corners", places, "-o", "a.vts")
    corners = gg.read("a.vts").xy[[0, -1, -1, 0], [0, 0, -1, -1]]
    np.testing.assert_allclose(corners, [PLACES[k] for k in (34, 0, 16, 18)], atol=1e-9)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--depth", "bathy.nc:elevation", "-o", "a.vts"], "belong to the file of an ocean model: -o FILE.nc"),
        (["--depth", "bathy.nc:none", "-o", "a.nc"], "it has no variable 'none'; it has lat, lon, elevation"),
        (["--depth", "bathy.nc:lat", "-o", "a.nc"], "its variable 'lat' has the axes lat 44; expected two"),
        (["--depth", "1 + x", "-o", "a.nc"], "--depth takes a file with a raster or samples"),
        (["--depth", "missing.nc:h", "-o", "a.nc"], "there is no such file"),
        (["--crs", "EPSG:4326", "-o", "a.nc"], "is no plane"),
        (["--corners", "0,0 1,0 1,1"], "--corners is auto, four whole numbers such as '0,10,20,30', or four places"),
        (["--corners", "0,0 1,0 1,1 a,1"], "came '0,0 1,0 1,1 a,1'"),
    ],
)
def test_mistakes_of_the_command_line_are_named(sea, arguments, message):
    raster("bathy.nc")
    crs = [] if "--crs" in arguments else ["--crs", "auto"]
    assert message in run("grid", sea, "-f", "winslow", "--size", 8, 8, *crs, *arguments, code=2)
