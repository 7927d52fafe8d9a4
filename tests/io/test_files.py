"""Grid files: round trips, files of other programs, and files that are none."""

from __future__ import annotations

import base64
import errno
import io
import math
import os
import struct
import sys
import tracemalloc
import zipfile
import zlib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from gridgen_sym.boundary import Outline, domain
from gridgen_sym.errors import GridgenError
from gridgen_sym.grids import Grid
from gridgen_sym.io import read, write
from gridgen_sym.io.format import Blocks
from gridgen_sym.io.formats import npz, plot3d, table, vts
from gridgen_sym.io.plot3d_writing import written

DATA = Path(__file__).parent / "data"


def one_block(data):
    """The grid of a PLOT3D file of one block."""
    (grid,) = plot3d.decode(io.BytesIO(data)).grids
    return grid


def encoded(*grids):
    """A PLOT3D file."""
    return b"".join(written(Blocks(grids)))


def vts_file(grid, words=()):
    """A VTK XML structured grid."""
    return b"".join(vts.encode(grid, words))


def vts_grid(data):
    return vts.decode(io.BytesIO(data))


def table_file(grid):
    """A table of nodes."""
    return b"".join(table.encode(grid))


def table_grid(data):
    return table.decode(io.BytesIO(data))


def npz_file(grid):
    """A NumPy archive."""
    return b"".join(npz.encode(grid))


def npz_grid(data):
    return npz.decode(io.BytesIO(data))


CODECS = {
    ".vts": (vts_file, vts_grid),
    "binary.vts": (lambda grid: vts_file(grid, ["binary"]), vts_grid),
    ".xyz": (encoded, one_block),
    ".p2dfmt": (lambda grid: b"".join(written(Blocks((grid,)), {"plane"})), one_block),
    ".csv": (table_file, table_grid),
    ".npz": (npz_file, npz_grid),
}
SWAN = domain("swan", 5, 4)  # What tests/grids/data holds, written by VTK 9.

grids = hnp.arrays(
    np.float64,
    st.tuples(st.integers(3, 5), st.integers(3, 5), st.just(2)),
    elements=st.floats(allow_nan=False, allow_infinity=False),
).map(Grid)


@pytest.mark.parametrize("suffix", CODECS)
def test_round_trip_through_the_disk(tmp_path, suffix):
    path = tmp_path / f"grid{suffix.upper()}"
    SWAN.write(path)
    assert read(path) == SWAN
    domain("wavy", 7, 9).write(str(path))
    assert read(str(path)) == domain("wavy", 7, 9)
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


@pytest.mark.parametrize("suffix", CODECS)
@given(grid=grids)
def test_round_trip_is_exact(suffix, grid):
    encode, decode = CODECS[suffix]
    back = decode(encode(grid))
    assert back == grid
    assert np.array_equal(np.signbit(back.planes), np.signbit(grid.planes))


@pytest.mark.parametrize("suffix", CODECS)
@settings(max_examples=30)
@given(data=st.data())
def test_a_file_cut_short_is_an_error(suffix, data):
    encode, decode = CODECS[suffix]
    whole = encode(SWAN)
    cut = whole[: data.draw(st.integers(0, len(whole) - 1))]
    if cut == whole.rstrip() and suffix != ".csv":
        assert decode(cut) == SWAN  # Only the newline at the end is gone.
    else:
        with pytest.raises(GridgenError):
            decode(cut)


@pytest.mark.parametrize("suffix", CODECS)
@given(noise=st.binary(min_size=1, max_size=60) | st.text("0123456789 .,-\nnaife", min_size=1).map(str.encode))
def test_noise_is_an_error(suffix, noise):
    with pytest.raises(GridgenError):
        CODECS[suffix][1](noise)


@pytest.mark.parametrize("suffix", CODECS)
def test_bad_places(tmp_path, suffix):
    name = f"grid{suffix}"
    with pytest.raises(GridgenError, match="no such file"):
        read(tmp_path / name)
    with pytest.raises(GridgenError, match="does not exist; make it first"):
        write(SWAN, tmp_path / "none" / name)
    (tmp_path / "file").write_text("a file")
    with pytest.raises(GridgenError, match="does not exist"):
        write(SWAN, tmp_path / "file" / name)
    with pytest.raises(GridgenError, match="cannot read"):
        read(tmp_path / "file" / name)
    (tmp_path / name).mkdir()
    for action in (lambda: read(tmp_path / name), lambda: write(SWAN, tmp_path / name)):
        with pytest.raises(GridgenError, match="is a folder"):
            action()
    (tmp_path / f"empty{suffix}").write_bytes(b" \n")
    with pytest.raises(GridgenError, match="is empty"):
        read(tmp_path / f"empty{suffix}")
    (tmp_path / f"text{suffix}").write_text("not a grid\n")
    with pytest.raises(GridgenError, match=f"cannot read .*text{suffix} as a "):
        read(tmp_path / f"text{suffix}")
    with pytest.raises(GridgenError, match="cannot write"):
        write(SWAN, tmp_path / ("long" * 100 + suffix))


@pytest.mark.parametrize("path", ["grid.stl", "grid", "grid.vts.gz", ".csv"])
def test_an_unknown_suffix_lists_the_known(path):
    with pytest.raises(GridgenError, match=r"use one of .*\.npz .*\.xyz .*\.csv .*\.vts"):
        write(SWAN, path)
    with pytest.raises(GridgenError, match="suffix"):
        read(path)


@pytest.mark.parametrize("path", [None, 3, b"grid.vts", "a\0.vts"])
def test_a_name_that_is_none(path):
    with pytest.raises(GridgenError, match="must be text or a path"):
        read(path)


@pytest.mark.parametrize("stage", ["fsync", "replace"])
@pytest.mark.parametrize("failure", [OSError(errno.ENOSPC, "No space left on device"), KeyboardInterrupt()])
def test_a_failed_write_leaves_the_old_file_and_nothing_else(tmp_path, monkeypatch, stage, failure):
    path = tmp_path / "grid.csv"
    SWAN.write(path)

    def fail(*_):
        raise failure

    monkeypatch.setattr(os, "fsync", fail) if stage == "fsync" else monkeypatch.setattr(Path, "replace", fail)
    expected = (GridgenError, "No space left") if isinstance(failure, OSError) else (KeyboardInterrupt, None)
    with pytest.raises(expected[0], match=expected[1]):
        domain("wavy", 5, 5).write(path)
    monkeypatch.undo()
    assert [p.name for p in tmp_path.iterdir()] == ["grid.csv"]
    assert read(path) == SWAN


OUTLINE = Outline([[0, 0], [1, 0], [1, 1], [0, 1]], (0, 1, 2, 3), "box")
each_writer = pytest.mark.parametrize(
    ("thing", "name"), [(SWAN, f"grid{suffix}") for suffix in CODECS] + [(OUTLINE, "outline.csv")]
)


@each_writer
@pytest.mark.parametrize("code", [errno.EACCES, errno.EROFS, errno.EPERM])
def test_a_folder_closed_to_us_is_an_error(tmp_path, monkeypatch, thing, name, code):
    """Nobody is kept from root's own folders, so that the refusal is played."""

    def refuse(path, mode="r", *_):
        assert mode == "xb"
        raise OSError(code, os.strerror(code), path)

    monkeypatch.setattr(Path, "open", refuse)
    with pytest.raises(GridgenError) as caught:
        thing.write(tmp_path / name)
    assert f"cannot write {tmp_path / name}: {os.strerror(code)}; check the permissions" in str(caught.value)
    assert not list(tmp_path.iterdir())


@each_writer
@pytest.mark.parametrize("folder", ["/sys", "/proc", "/dev/null", __file__])
def test_a_folder_that_takes_no_files_is_an_error_even_for_root(thing, name, folder):
    if not os.path.exists(folder):
        pytest.skip(f"{folder} is not here")
    with pytest.raises(GridgenError, match=f"cannot write {folder}/{name}: .*(check the permissions|make it first)"):
        thing.write(Path(folder) / name)


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="permissions do not bind root")
@each_writer
def test_permissions_that_forbid_are_told(tmp_path, thing, name):
    thing.write(tmp_path / name)
    (tmp_path / name).chmod(0)
    tmp_path.chmod(0o500)
    try:
        with pytest.raises(GridgenError, match=r"cannot write .*: Permission denied; check the permissions"):
            thing.write(tmp_path / name)
        with pytest.raises(GridgenError, match=r"cannot read .*: Permission denied; check its permissions"):
            (read if thing is SWAN else Outline.read)(tmp_path / name)
    finally:
        tmp_path.chmod(0o700)


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX permissions and links")
def test_permissions_follow_the_umask_and_links_are_followed(tmp_path):
    SWAN.write(tmp_path / "grid.csv")
    (tmp_path / "plain").write_text("")
    assert (tmp_path / "grid.csv").stat().st_mode == (tmp_path / "plain").stat().st_mode
    (tmp_path / "link.csv").symlink_to(tmp_path / "grid.csv")
    domain("wavy", 5, 5).write(tmp_path / "link.csv")
    assert (tmp_path / "link.csv").is_symlink()
    assert read(tmp_path / "grid.csv") == domain("wavy", 5, 5)


@pytest.mark.parametrize(
    "path", sorted(set(DATA.glob("*.vts")) - {DATA / "inline_lz4.vts"}), ids=lambda path: path.stem
)
def test_files_written_by_vtk(path):
    tolerance = 1e-8 if path.stem == "ascii" else 0.0  # VTK's own ASCII has fewer digits.
    assert read(path).xy == pytest.approx(SWAN.xy, abs=tolerance, rel=0)


def test_an_unknown_compressor_is_named():
    with pytest.raises(GridgenError, match="vtkLZ4DataCompressor"):
        read(DATA / "inline_lz4.vts")


def test_the_vts_text():
    text = vts_file(SWAN).decode()
    assert 'WholeExtent="0 4 0 3 0 0"' in text
    rows = text.split('format="ascii">\n')[1].splitlines()
    assert rows[0] == "0 0 0"
    assert [float(word) for word in rows[1].split()] == [0.25, 0.0, 0.0]  # The first index runs fastest.
    assert [float(word) for word in rows[5].split()] == [*SWAN.xy[0, 1], 0.0]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('type="StructuredGrid" v', 'type="ImageData" v', "expected a VTKFile of type StructuredGrid"),
        ('<Piece Extent="0 4 0 3 0 0">', '<Piece Extent="0 4 0 3 0 1">', "one k plane"),
        (
            '<Piece Extent="0 4 0 3 0 0">',
            '<Piece Extent="0 4 0 2 0 0">',
            "its points have 60 numbers, and its extent asks for 45",
        ),
        ('<Piece Extent="0 4 0 3 0 0">', '<Piece Extent="0 4 0">', "six whole numbers"),
        ("</Piece>", "</Piece><Piece></Piece>", "2 pieces"),
        ("0.25 0 0\n", "0.25 0 1\n", "surface in space"),
        ("0.25 0 0\n", "nan 0 0\n", r"node \(1, 0\)"),
        ("0.25 0 0\n", "x 0 0\n", "could not convert string to float: 'x'"),
        ("0.25 0 0\n", "1_0 0 0\n", "'1_0' is not a number"),
        ("0.25 0 0\n", "0.25 0 inf\n", r"every z must be finite, but that of node \(1, 0\) is inf"),
        ('<Piece Extent="0 4 0 3 0 0">', '<Piece Extent="0 4 0 3 0 0_0">', "six whole numbers"),
        ('<?xml version="1.0"?>', "<!DOCTYPE a [<!ENTITY b 'bb'>]>", "declares a document type"),
        ('format="ascii"', 'format="hex"', "format 'hex'"),
        ('format="ascii"', 'format="binary"', "cannot be decoded"),
        ('format="ascii"', 'format="appended" offset="0"', "cannot be decoded"),
        ('type="Float64"', 'type="Int8"', "type 'Int8'"),
        ("Points>", "Dots>", "no Points/DataArray"),
    ],
)
def test_a_vts_with_a_fault(old, new, message):
    text = vts_file(SWAN).decode()
    assert old in text
    with pytest.raises(GridgenError, match=message):
        vts_grid(text.replace(old, new).encode())


def compressed(blocks, announced, extent="0 2 0 2 0 0"):
    """A .vts file of compressed blocks."""
    packed = [zlib.compress(block, 9) for block in blocks]
    head = struct.pack(f"<{3 + len(blocks)}Q", len(blocks), announced, 0, *map(len, packed))
    data = (base64.b64encode(head) + base64.b64encode(b"".join(packed))).decode()
    return (
        f'<VTKFile type="StructuredGrid" header_type="UInt64" compressor="vtkZLibDataCompressor"><StructuredGrid>'
        f'<Piece Extent="{extent}"><Points><DataArray type="Float64" format="binary">{data}</DataArray></Points>'
        "</Piece></StructuredGrid></VTKFile>"
    ).encode()


def test_compressed_blocks_of_any_size_are_read():
    points = np.zeros((4, 5, 3))
    points[..., :2] = SWAN.xy.transpose(1, 0, 2)
    data = points.tobytes()
    assert vts_grid(compressed([data[:200], data[200:201], b"", data[201:]], 200, "0 4 0 3 0 0")) == SWAN


@pytest.mark.parametrize("blocks", [[b"\0" * (1 << 26)], [b"\0" * 216, b"\0" * (1 << 26)], [b"\0" * 217]])
def test_decompression_stops_at_what_the_extent_allows(blocks):
    """A megabyte may hold a gigabyte."""
    tracemalloc.start()
    with pytest.raises(GridgenError, match="hold more than the 216 bytes that its extent allows"):
        vts_grid(compressed(blocks, 216))
    assert tracemalloc.get_traced_memory()[1] < 1 << 23
    tracemalloc.stop()


def test_an_extent_that_asks_for_more_than_a_grid_would_is_refused():
    with pytest.raises(GridgenError, match="no grid can be packed so tightly"):
        vts_grid(compressed([b"\0" * (1 << 20)], 1 << 20, "0 99999 0 99999 0 0"))


def plot3d_text(*, count=True, three=True, words="{}"):
    """The swan as a PLOT3D file of another writer."""
    planes = [SWAN.x.T.ravel(), SWAN.y.T.ravel()] + [np.zeros(20)] * three
    head = "1\n" * count + "5 4" + " 1" * three
    body = "\n".join(words.format(repr(value)) for value in np.concatenate(planes).tolist())
    return f"{head}\n{body}\n".encode()


@pytest.mark.parametrize("count", [True, False])
@pytest.mark.parametrize("three", [True, False])
def test_all_forms_of_plot3d(count, three):
    assert one_block(plot3d_text(count=count, three=three)) == SWAN
    with pytest.raises(GridgenError, match="do not fit its header"):
        one_block(plot3d_text(count=count, three=three) + b"1.0\n")


def test_the_written_form_of_plot3d():
    lines = encoded(SWAN).decode().splitlines()
    assert lines[:4] == ["1", "5 4 1", "0", "0.25"]
    assert len(lines) == 2 + 60
    assert lines[-20:] == ["0"] * 20


def test_a_header_without_lines_of_its_own():
    for count in (True, False):
        for three in (True, False):
            text = plot3d_text(count=count, three=three)
            assert one_block(text.replace(b"\n", b" ")) == SWAN
            assert one_block(b"\n".join(text.split())) == SWAN
            assert one_block(text.replace(b"\n", b"\r\n")) == SWAN


def test_a_spatial_file_cut_short_does_not_pass_for_a_plane_one():
    words = encoded(SWAN).decode().splitlines()
    with pytest.raises(GridgenError, match="43 numbers do not fit"):
        one_block("\n".join([*words[:2], *words[2:41], ""]).encode())


def test_fortran_shorthands():
    body = plot3d_text().decode().replace("0.0\n" * 20, "20*0.0\n").replace("0.25\n", "2.5D-1,\n")
    assert "20*" in body
    assert "D-1" in body
    assert one_block(body.encode()) == SWAN
    with pytest.raises(GridgenError, match="repeat count"):
        one_block(b"1 5 4 1 99999999999*0.0")


@pytest.mark.parametrize(
    ("word", "value"),
    [("1.5-120", 1.5e-120), ("1.5+120", 1.5e120), ("-1.5-120", -1.5e-120), ("1.5+2", 150.0), ("-.5-003", -0.5e-3),
     ("2.D-1", 0.2), ("2.5d+02", 250.0), ("2.5Q2", 250.0), ("-7", -7.0), ("1e-3", 1e-3), ("15-1", 1.5)],
)  # fmt: skip
@pytest.mark.parametrize("after", [" ", ",", "\n", "\r\n"])
def test_exponents_of_fortran(word, value, after):
    """Its E and D descriptors leave the letter out where the exponent has three digits."""
    words = ["0", "1", "2"] * 3 + [word] * 3 + ["1"] * 3 + [f"2*{word} {word}"]
    text = "3 3\n" + " ".join(words[:9]) + " " + after.join(words[9:]) + after
    assert one_block(text.encode()).y.T.tolist() == [[value] * 3, [1.0] * 3, [value] * 3]
    with pytest.raises(GridgenError, match=r"could not convert string to float: '0\.1-0\.2'"):
        one_block(text.replace(word, "0.1-0.2 ").encode())  # Two numbers without a blank between them.


def with_iblank(values, *, three):
    """The swan with a plane of iblank."""
    return plot3d_text(three=three) + " ".join(map(str, values)).encode()


@pytest.mark.parametrize("three", [True, False])
@pytest.mark.parametrize("values", [[1] * 20, [1] * 17 + [2, -3, 1]], ids=["fields", "walls and other grids"])
def test_an_iblank_without_holes_is_ignored_which_is_said(three, values, capsys):
    assert one_block(with_iblank(values, three=three)) == SWAN
    assert "the file's iblank is ignored" in capsys.readouterr().err


@pytest.mark.parametrize("three", [True, False])
def test_an_iblank_with_holes_is_refused(three):
    with pytest.raises(GridgenError, match=r"iblank marks 2 nodes as holes \(0\), the first of which is node \(1, 1\)"):
        one_block(with_iblank([1] * 6 + [0, 1, 0] + [1] * 11, three=three))
    with pytest.raises(GridgenError, match="plane of iblank would fit its header, but its numbers are not whole"):
        one_block(with_iblank([1] * 19 + [0.5], three=three))


def test_repeat_counts_are_bounded_by_the_header_before_anything_is_allocated():
    """A few bytes could announce gigabytes, in agreement with the header or not."""
    big = 10**11
    for data, message in (
        (f"1\n3 3 1\n{f'{big}*0 ' * 40}", "its 4000000000004 numbers, repeat counts included, do not fit"),
        (f"1\n{10**6} {10**5} 1\n{f'{big}*0 ' * 3}", "no grid can be packed so tightly"),
        (f"1\n{10**6} {10**12} 1\n{f'{10**12 - 1}*0 ' * 3}", "do not fit its header"),
        ("3 3 1 9999999999999*0", "the repeat count in '9999999999999.0' is not a number of at most 12 digits"),
    ):
        with pytest.raises(GridgenError, match=message):
            one_block(data.encode())


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"1\n3 3 2\n" + b"0 " * 54, "two planes of nodes that agree in z: cut out"),
        (b"1\n3 3 1\n" + b"0 " * 18 + b"0 0 0 0 1 0 0 0 0", "its z varies"),
        (b"2\n3 3 1\n3 3 1\n" + b"0 " * 53, "2 blocks, the first of 3 x 3 x 1 nodes, in 3 dimensions needs 61"),
        (b"3 3\n" + b"0 " * 17, "do not fit its header"),
        (b"-3 -3\n" + b"0 " * 18, "do not fit its header"),
        (b"3 3\n" + b"0 " * 17 + b"x", "could not convert"),
        (b"3 3\n" + b"0 " * 17 + b"1_0", "'1_0' is not a number"),
        (b"3 3\n" + b"0 " * 17 + b"x" * 10**5, r"could not convert.*\.\.\. \(100000 characters\); expected"),
        (b"3 3 1\n" + b"0 " * 26 + b"1e999", r"every z must be finite, but that of node \(2, 2\) is inf"),
        (b"3 3 1\n" + b"1e999 " * 27, r"every node must be finite, but node \(0, 0\) is \(inf, inf\)"),
        (b"3 3 1\n" + b"0 " * 18 + b"1e308 -1e308 0 0 0 0 0 0 0", "its z varies"),
        (b"\x05\x00\x00\x80\x04", "its 5 bytes fit no header of PLOT3D"),
        (b"3 3 \x80" + b"0 " * 18, "byte 4 is not ASCII text, so the file may be binary"),
    ],
)
def test_a_plot3d_file_with_a_fault(data, message):
    with pytest.raises(GridgenError, match=message):
        one_block(data)


def test_the_csv_text_and_rows_in_any_order():
    header, *rows = table_file(SWAN).decode().splitlines()
    assert header == "i,j,x,y"
    assert rows[0].startswith("4,3,1,1")
    assert rows[-5] == "1,0,0.25,0"
    assert table_grid("\r\n".join([" I, J, X, Y", *rows[::-1], ""]).encode("utf-8-sig")) == SWAN


def test_columns_in_any_order_among_others():
    rows = [line.split(",") for line in table_file(SWAN).decode().splitlines()]
    text = "".join(f"{y}, 7, {j},{x},{i}\n" for i, j, x, y in rows).replace(" 7,", " depth,", 1)
    assert text.startswith("y, depth, j,x,i\n")
    assert table_grid(text.encode()) == SWAN


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("i,j,x,y", "x,y", "line 1 is 'x,y'; expected the header 'i,j,x,y'"),
        ("1,0,0.25,0\n", "", "reach 5 x 4 nodes, but it has 19 rows"),
        ("1,0,0.25,0\n", "0,0,0.25,0\n", r"node \(1, 0\) is missing"),
        ("1,0,0.25,0\n", "999999999,0,0.25,0\n", "but it has 20 rows"),
        ("1,0,0.25,0\n", "-1,0,0.25,0\n", "whole numbers from 0"),
        ("1,0,0.25,0\n", "1.5,0,0.25,0\n", "whole numbers from 0"),
        ("1,0,0.25,0\n", "1,0,0.25\n", "four numbers a row"),
        ("1,0,0.25,0\n", "1,0,a,0\n", "four numbers a row"),
        ("1,0,0.25,0\n", "1,0,1_0,0\n", "four numbers a row"),
        ("1,0,0.25,0\n", "1e300,0,0.25,0\n", "whole numbers from 0 on, below 2147483648"),
        ("1,0,0.25,0\n", "1e999,0,0.25,0\n", "must hold whole numbers from 0 on"),
        ("1,0,0.25,0\n", "1,0,nan,0\n", r"node \(1, 0\) is \(nan"),
    ],
)
def test_a_csv_file_with_a_fault(old, new, message):
    text = table_file(SWAN).decode()
    assert old in text
    with pytest.raises(GridgenError, match=message):
        table_grid(text.replace(old, new).encode())


def archive(**arrays):
    """A NumPy archive as bytes."""
    stream = io.BytesIO()
    np.savez_compressed(stream, **arrays)
    return stream.getvalue()


def test_npz_of_other_writers():
    assert npz_grid(archive(xy=SWAN.xy, note=np.array("more"))) == SWAN
    with pytest.raises(GridgenError, match="it holds points, z; expected the array 'xy'"):
        npz_grid(archive(points=SWAN.xy, z=SWAN.x))
    with pytest.raises(GridgenError, match=r"no whole NumPy archive.*allow_pickle"):
        npz_grid(archive(xy=np.array([{}, {}], dtype=object)))
    stream = io.BytesIO()
    np.save(stream, SWAN.xy)
    with pytest.raises(GridgenError, match="no whole NumPy archive"):
        npz_grid(stream.getvalue())


def test_npz_with_x_and_y():
    assert npz_grid(archive(x=SWAN.x, y=np.asfortranarray(SWAN.y))) == SWAN
    assert npz_grid(archive(x=SWAN.x, y=SWAN.y, xy=SWAN.xy)) == SWAN
    with pytest.raises(GridgenError, match="one shape"):
        npz_grid(archive(x=SWAN.x, y=SWAN.y[1:]))
    with pytest.raises(GridgenError, match=r"it holds x; expected the array 'xy' .*, or 'x' and 'y'"):
        npz_grid(archive(x=SWAN.x))
    with pytest.raises(GridgenError, match="holds numbers of type complex128, not real numbers"):
        npz_grid(archive(xy=SWAN.xy * 1j))


@pytest.mark.parametrize("method", [zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_an_archive_that_numpy_would_not_write_is_refused(method):
    stream, array = io.BytesIO(), io.BytesIO()
    np.save(array, SWAN.xy)
    with zipfile.ZipFile(stream, "w", method) as file:
        file.writestr("xy.npy", array.getvalue())
    with pytest.raises(GridgenError, match="compressed otherwise than NumPy does"):
        npz_grid(stream.getvalue())


def npz_that_announces(shape, size=None, head=b""):
    """An archive of zeros: a header, and a size of its own."""
    header = io.BytesIO()
    np.lib.format.write_array_header_1_0(header, {"descr": "<f8", "fortran_order": False, "shape": shape})
    stream = io.BytesIO()
    with (
        zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as file,
        file.open("xy.npy", "w") as member,
    ):
        member.write(head or header.getvalue())
        for _ in range((8 * math.prod(shape) if size is None else size) >> 24):
            member.write(bytes(1 << 24))
    return stream.getvalue()


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (lambda: npz_that_announces((1 << 12, 1 << 12, 3)), "no grid can be packed so tightly"),
        (lambda: npz_that_announces((1 << 20, 1 << 20, 2), 0), "bytes are announced for"),
        (lambda: npz_that_announces((3, 3, 2), 1 << 26), "bytes are announced for"),
        (lambda: npz_that_announces((), 1 << 26, b"\x93NUMPY\x02\x00\xff\xff\xff\x7f"), "no whole NumPy archive"),
    ],
)
def test_an_archive_is_not_unpacked_before_its_size_is_known(data, message):
    packed = data()
    tracemalloc.start()
    with pytest.raises(GridgenError, match=message):
        npz_grid(packed)
    assert tracemalloc.get_traced_memory()[1] < 1 << 23
    tracemalloc.stop()


@pytest.mark.extras
@pytest.mark.parametrize("words", ["", "fortran", "fortran big", "binary", "binary big single"])
def test_vtk_reads_what_is_written(tmp_path, words):
    """Reading back by the reference implementation."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOParallel import vtkMultiBlockPLOT3DReader
    from vtkmodules.vtkIOXML import vtkXMLStructuredGridReader

    write(SWAN, tmp_path / "grid.vts", form="binary" if words else "ascii")
    write(SWAN, tmp_path / "grid.xyz", form=words)
    vts = vtkXMLStructuredGridReader()
    vts.SetFileName(str(tmp_path / "grid.vts"))
    vts.Update()
    p3d = vtkMultiBlockPLOT3DReader()
    p3d.SetFileName(str(tmp_path / "grid.xyz"))
    (p3d.BinaryFileOn if words else p3d.BinaryFileOff)()
    (p3d.HasByteCountOn if "fortran" in words else p3d.HasByteCountOff)()
    (p3d.SetByteOrderToBigEndian if "big" in words else p3d.SetByteOrderToLittleEndian)()
    (p3d.DoublePrecisionOff if "single" in words else p3d.DoublePrecisionOn)()
    p3d.MultiGridOn()
    p3d.Update()
    for block, tolerance in (
        (vts.GetOutput(), 0.0),
        (p3d.GetOutput().GetBlock(0), 1e-7 if "single" in words else 1e-15),
    ):
        assert block.GetExtent() == (0, 4, 0, 3, 0, 0)
        points = vtk_to_numpy(block.GetPoints().GetData()).reshape(4, 5, 3)
        assert points[..., :2].transpose(1, 0, 2) == pytest.approx(SWAN.xy, abs=tolerance, rel=0)
