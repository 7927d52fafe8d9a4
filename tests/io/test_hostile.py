"""Files that lie, are cut short, damaged, or noise: in every format one clear error, in little time and memory."""

from __future__ import annotations

import contextlib
import functools
import io
import struct
import time
import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support_files import SWAN, turned

import gridgen_sym as gg
from gridgen_sym.io import known_formats
from gridgen_sym.io.format import Blocks, Storage

READ = {name: form for name, form in known_formats().items() if form.decode}
MOST_SECONDS, MOST_BYTES = 2.0, 1 << 26
BIG = 10**12


def decoded(name, data):
    """What a format makes of a file."""
    form = READ[name]
    given = ((),) if form.forms else ()
    more = (
        {"beside": lambda file: contextlib.nullcontext(io.BytesIO(whole("vts")))}
        if form.storage is Storage.FILE_AND_FOLDER
        else {}
    )
    found = form.decode(io.BytesIO(data) if form.streamed else data, *given, **more)
    return Blocks((found,)) if isinstance(found, gg.Grid) else found


@functools.cache
def whole(name, words=()):
    """A file of a format, of several blocks where it takes them."""
    form, made = READ[name], turned()
    content = Blocks(made.blocks, made.names, made.bonds, made.boundaries) if form.several else SWAN
    given = (words,) if form.forms else ()
    more = {"stem": "file"} if form.storage is Storage.FILE_AND_FOLDER else {}
    pieces = form.encode(content, *given, **more) if form.encode else OTHERS[name]
    pieces = pieces[""] if more else pieces
    return pieces if isinstance(pieces, bytes) else b"".join(pieces)


#: Files of formats that are not written.
OTHERS: dict[str, bytes] = {}
#: A format whose package is not one of the tests' own is tried with the extras.
MARKS = {name: pytest.mark.extras if form.extra and form.extra[0] != "io" else () for name, form in READ.items()}
NAMES = [pytest.param(name, marks=MARKS[name]) for name in READ]
#: Every format with every form that makes a difference to its reader.
each_whole = pytest.mark.parametrize(
    ("name", "words"),
    [
        pytest.param(name, words, marks=MARKS[name], id=" ".join((name, *words)))
        for name, form in READ.items()
        for words in ((), *((word,) for word in ("binary", "fortran") if word in form.forms and name != "plot3d_plane"))
    ],
)


def is_grid_or_error(name, data):
    """Whether data are blocks, or raise the one error; any other error, or a warning, fails the test."""
    with contextlib.suppress(gg.GridgenError):
        found = decoded(name, data)
        assert all(isinstance(grid, gg.Grid) for grid in found.grids)


@each_whole
@settings(max_examples=20)
@given(data=st.data())
def test_a_damaged_file_is_a_grid_or_one_error(name, words, data):
    damaged = bytearray(whole(name, words))
    for _ in range(data.draw(st.integers(1, 4))):
        damaged[data.draw(st.integers(0, len(damaged) - 1))] = data.draw(st.integers(0, 255))
    is_grid_or_error(name, bytes(damaged))


@each_whole
@settings(max_examples=20)
@given(part=st.floats(0, 1, exclude_max=True), noise=st.binary(max_size=50))
def test_a_file_cut_short_is_an_error(name, words, part, noise):
    """Also one that ends in noise."""
    data = whole(name, words)
    cut = data[: int(part * len(data))]
    is_grid_or_error(name, cut + noise)
    try:
        found = decoded(name, cut)
    except gg.GridgenError:
        return
    if found.grids != decoded(name, data).grids:  # What is cut off may be the end of a tag, or a blank.
        assert b"\0" not in data, "only a text may be cut within its last number"
        assert len(data) - len(cut) < 20


@pytest.mark.parametrize("name", NAMES)
@settings(max_examples=20)
@given(noise=st.binary(min_size=1, max_size=200), begin=st.integers(0, 40))
def test_noise_is_an_error(name, noise, begin):
    is_grid_or_error(name, whole(name)[:begin] + noise)


def h5_that_announces(shape):
    h5py = pytest.importorskip("h5py")
    file = io.BytesIO(whole("cgns"))
    with h5py.File(file, "r+") as root:
        group = root["Base/a/GridCoordinates/CoordinateX"]
        del group[" data"]
        group.create_dataset(" data", shape=shape, dtype="f8", chunks=(1024, 1024))
        del root["Base/a/ data"]
        root["Base/a"].create_dataset(" data", data=np.array([shape[::-1], shape[::-1], (0, 0)], dtype=np.int64))
    return file.getvalue()


def netcdf_that_announces(shape):
    import netCDF4

    made = netCDF4.Dataset("memory.nc", "w", memory=1024)
    for name, size in zip(("eta_psi", "xi_psi"), shape, strict=True):
        made.createDimension(name, size)
    for name in ("lon_psi", "lat_psi"):
        made.createVariable(name, "f8", ("eta_psi", "xi_psi"), chunksizes=(1000, 1000))
    return bytes(made.close())


def vts_that_announces(data, **attributes):
    extra = "".join(f' {key}="{value}"' for key, value in attributes.items())
    return (
        f'<VTKFile type="StructuredGrid" header_type="UInt64"{extra}><StructuredGrid>'
        f'<Piece Extent="0 999999 0 999999 0 0"><Points><DataArray type="Float64" {data}</DataArray></Points></Piece>'
        "</StructuredGrid></VTKFile>"
    ).encode()


def npz_that_announces(shape):
    stream, header = io.BytesIO(), io.BytesIO()
    np.lib.format.write_array_header_1_0(header, {"descr": "<f8", "fortran_order": False, "shape": shape})
    import zipfile

    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("xy.npy", header.getvalue())
    return stream.getvalue()


ENTITIES = "".join(f'<!ENTITY e{k + 1} "{f"&e{k};" * 20}">' for k in range(12))
BOMB = f'<?xml version="1.0"?><!DOCTYPE bomb [<!ENTITY e0 "0 0 0 ">{ENTITIES}]><VTKFile type="KIND">&e12;</VTKFile>'
PLOT3D = [
    f"1\n{10**6} {10**6} 1\n0 0 0\n".encode(),
    f"1\n{10**6} {10**6} 1\n{BIG - 1}*0 0 {BIG - 1}*0 0 {BIG - 1}*0 0".encode(),
    f"{BIG}\n3 3 1\n".encode(),
    b"99999\n" + b"3 3 1\n" * 9,
    struct.pack("<4i", 1, 10**6, 10**6, 1) + b"\0" * 100,
    struct.pack("<4i", 2**31 - 1, 3, 3, 1) + b"\0" * 100,
    struct.pack("<3i3i2i", 4, 1, 4, 12, 10**6, 10**6, 1, 12) + struct.pack("<i", 2**31 - 1) + b"\0" * 100,
]
#: Files that announce what they do not have, and would fill the memory or the day: some for every format.
CLAIMS = {
    "plot3d": PLOT3D,
    "plot3d_plane": PLOT3D,
    "table": [f"i,j,x,y\n{BIG},{BIG},0,0\n".encode(), f"i,j,x,y\n{10**6 - 1},{10**6 - 1},0,0\n".encode()],
    "npz": [npz_that_announces((10**6, 10**6, 2))],
    "vts": [
        vts_that_announces('format="ascii">0 0 0'),
        vts_that_announces(f'format="ascii">{3 * BIG}*0 '),
        vts_that_announces('format="binary">' + "A" * 400),
        vts_that_announces('format="binary">' + "/" * 400, compressor="vtkZLibDataCompressor"),
        vts_that_announces('format="appended" offset="999999999999">'),
        BOMB.replace("KIND", "StructuredGrid").encode(),
        b"<VTKFile>" + b"<a>" * 100_000,
    ],
    "vtm": [BOMB.replace("KIND", "vtkMultiBlockDataSet").encode(), b"<VTKFile>" + b"<a>" * 100_000],
    "tecplot": [
        f'VARIABLES = "x" "y"\nZONE I={10**6} J={10**6}\n0 0\n'.encode(),
        f'VARIABLES = "x" "y"\nZONE I={10**6} J={10**6}\n{BIG}*0 {BIG}*0\n'.encode(),
        f'VARIABLES = "x" "y"\nZONE I={10**18} J={10**18}\n0 0\n'.encode(),
        b'VARIABLES = "x" "y"\nZONE ' + b"A=(" * 10**5 + b"\n0 0\n",
        b'VARIABLES = "x" "y"\n' + b"ZONE I=3\n0\n" * 10**4,
        b"VARIABLES = " + b"x " * 10**5,
    ],
    "netcdf": [lambda: netcdf_that_announces((10**6, 10**6))],
    "cgns": [lambda: h5_that_announces((10**6, 10**6))],
}


@pytest.mark.parametrize("name", NAMES)
def test_what_a_file_announces_is_checked_before_anything_is_allocated(name):
    assert CLAIMS.get(name), f"add files to CLAIMS that announce too much in the format {name}"
    for claim in CLAIMS[name]:
        data = claim() if callable(claim) else claim
        tracemalloc.start()
        begin = time.process_time()
        try:
            with pytest.raises(gg.GridgenError) as caught:
                decoded(name, data)
            seconds, peak = time.process_time() - begin, tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()
        assert seconds < MOST_SECONDS, (seconds, data[:200])
        assert peak < MOST_BYTES, (peak, data[:200])
        assert len(str(caught.value)) < 1000
