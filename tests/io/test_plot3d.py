"""PLOT3D whole: every form by its content, planes anywhere, holes, and files that are none."""

from __future__ import annotations

import io
import struct
from itertools import product

import numpy as np
import pytest

import gridgen_sym as gg
from gridgen_sym.io.format import Blocks
from gridgen_sym.io.formats import plot3d
from gridgen_sym.io.plot3d_writing import written

SWAN, WAVY = gg.domain("swan", 5, 4), gg.domain("wavy", 4, 3)
ROUGH = gg.Grid(np.random.default_rng(0).normal(size=(4, 5, 2)))
KINDS = [("ascii",), *product(("fortran", "binary"), ("little", "big"), ("double", "single"))]
FORMS = list(product(KINDS, ("count", "nocount"), ("space", "plane"), ("noiblank", "iblank")))


def encoded(*blocks, words=(), masks=None):
    return b"".join(written(Blocks(blocks, masks=masks), words))


def decoded(data, words=()):
    return plot3d.decode(io.BytesIO(data), words)


def rounded(grid, words):
    return gg.Grid(grid.xy.astype(np.float32)) if "single" in words else grid


@pytest.mark.parametrize("form", FORMS, ids=lambda form: " ".join([*form[0], *form[1:]]))
def test_every_form_is_read_by_its_content(form, capsys):
    """Without a word of the user's, and without a doubt."""
    words = (*form[0], *form[1:])
    for blocks in ((SWAN,), (ROUGH,), *([] if "nocount" in words else [(SWAN, ROUGH, WAVY)])):
        data = encoded(*blocks, words=words)
        assert decoded(data).grids == tuple(rounded(grid, words) for grid in blocks)
        told = capsys.readouterr().err
        assert told == ("gridgen_sym: the file's iblank is ignored: it marks no holes\n" if "iblank" in words else "")
        assert decoded(data, words).grids == tuple(rounded(grid, words) for grid in blocks)
        short = data.rstrip().rpartition(b"\n")[0] if "ascii" in words else data[:-4]
        for wrong in (short, data + b"1234", data[: len(data) // 2]):
            with pytest.raises(gg.GridgenError):
                decoded(wrong)
        capsys.readouterr()


def by_hand(order, precision, records):
    """A binary file with its header and planes made by `struct`, and no code of the package."""
    head = [struct.pack(f"{order}i", 1), struct.pack(f"{order}3i", 5, 4, 1)]
    planes = (*SWAN.x.T.ravel(), *SWAN.y.T.ravel(), *([0.0] * 20))
    body = struct.pack(f"{order}60{precision}", *planes)
    marker = lambda part: struct.pack(f"{order}{records}", len(part)) if records else b""  # noqa: E731
    return b"".join(marker(part) + part + marker(part) for part in (*head, body))


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("precision", ["d", "f"])
@pytest.mark.parametrize("records", ["i", "q", ""])
def test_binary_files_of_other_writers(order, precision, records):
    data = by_hand(order, precision, records)
    assert decoded(data).grids == (rounded(SWAN, ["single"] * (precision == "f")),)
    if records != "q":
        kind = "fortran" if records else "binary"
        words = (kind, "little" if order == "<" else "big", "single" if precision == "f" else "double")
        assert encoded(SWAN, words=words) == data


def test_fortran_records_of_another_library(tmp_path):
    """SciPy reads what is written, record by record."""
    from scipy.io import FortranFile

    (tmp_path / "swan.x").write_bytes(encoded(SWAN, WAVY, words=("fortran",)))
    with FortranFile(tmp_path / "swan.x") as file:
        assert file.read_ints().tolist() == [2]
        assert file.read_ints().tolist() == [5, 4, 1, 4, 3, 1]
        for grid in (SWAN, WAVY):
            x, y, z = file.read_reals().reshape(3, *grid.shape[::-1])
            assert np.array_equal(x.T, grid.x)
            assert np.array_equal(y.T, grid.y)
            assert not z.any()


def test_a_doubt_is_reported_and_the_user_decides(capsys):
    """One number a line: 10 x 28 nodes, or 10 blocks, of which the first coordinates are the sizes."""
    sizes = [28, 3, 1] + [3, 3, 1] * 8 + [3, 7, 1]
    data = "\n".join(map(str, [10, *sizes, *([0] * 531)])).encode()
    assert len(data.split()) == 562
    assert [grid.shape for grid in decoded(data).grids] == [(28, 3), *[(3, 3)] * 8, (3, 7)]
    told = capsys.readouterr().err
    assert "is read as 10 blocks, the first of 28 x 3 x 1 nodes, in 3 dimensions" in told
    assert "could also be 10 x 28 nodes in 2 dimensions: the form 'ascii nocount plane noiblank' reads it so" in told
    assert [grid.shape for grid in decoded(data, ["ascii", "nocount", "plane", "noiblank"]).grids] == [(10, 28)]
    assert capsys.readouterr().err == ""


def spatial(across, coordinates, depth=1):
    """The swan as a block of three sizes in a text, and what is constant across it."""
    sizes = [0, 0, 0]
    own = [axis for axis in range(3) if axis != across]
    sizes[across], sizes[own[0]], sizes[own[1]] = depth, *SWAN.shape
    values = np.empty((3, *sizes))
    for axis in range(3):
        at = coordinates.index(axis) if axis in coordinates else None
        plane = SWAN.planes[at] if at is not None else np.full(SWAN.shape, 0.25)
        values[axis] = np.stack([plane + (0.5 * layer if at is None else 0) for layer in range(depth)], axis=across)
    flat = " ".join(repr(float(v)) for axis in range(3) for v in values[axis].T.ravel())
    return f"1\n{' '.join(map(str, sizes))}\n{flat}\n".encode()


@pytest.mark.parametrize("depth", [1, 2])
@pytest.mark.parametrize("coordinates", [(0, 1), (0, 2), (1, 2)])
@pytest.mark.parametrize("across", [0, 1, 2])
def test_a_plane_in_any_index_and_coordinates(across, coordinates, depth, capsys):
    assert decoded(spatial(across, coordinates, depth)).grids == (SWAN,)
    told = capsys.readouterr().err
    if (across, coordinates, depth) == (2, (0, 1), 1):
        assert told == ""
        return
    first, second = ("xyz"[axis] for axis in coordinates)
    along = [name for name in "ijk" if name != "ijk"[across]]
    assert f"the grid is the plane {'ijk'[across]} = 1{' of a layer of cells' * (depth == 2)} in {first} and" in told
    assert f"xi runs along {along[0]}, eta along {along[1]}, {first} and {second} are taken as x and y" in told
    assert "its cells run counter-clockwise" in told


def test_a_plane_without_the_count_whose_first_index_is_constant():
    text = spatial(0, (1, 2)).decode().partition("\n")[2]
    assert decoded(text.encode(), ("nocount",)).grids == (SWAN,)
    assert decoded(text.encode()).grids == (SWAN,)


def test_blocks_in_different_planes_are_refused():
    one, other = (spatial(2, axes).decode().split("\n", 2) for axes in ((0, 1), (1, 2)))
    text = f"2\n{one[1]}\n{other[1]}\n{one[2]}{other[2]}"
    with pytest.raises(gg.GridgenError, match="different coordinate planes"):
        decoded(text.encode())


@pytest.mark.parametrize("kind", [(), ("fortran",), ("binary", "big", "single")])
def test_holes_are_refused_or_kept_by_name(tmp_path, kind, capsys):
    masks = (np.ones((5, 4), np.uint8), np.ones((4, 3), np.uint8))
    masks[1][2, 1] = 0
    data = encoded(SWAN, WAVY, words=(*kind, "iblank"), masks=masks)
    path = tmp_path / "grid.xyz"
    path.write_bytes(data)
    with pytest.raises(gg.GridgenError, match=r"block 2: its iblank marks 1 nodes as holes .* node \(2, 1\)"):
        gg.read(path)
    kept = gg.read(path, form="holes")
    assert [block.shape for block in kept.blocks] == [(5, 4), (4, 3)]
    found = gg.read_masks(path)
    assert list(found) == ["0", "1"]
    assert all(np.array_equal(one, other) for one, other in zip(found.values(), masks, strict=True))
    assert "ignored" not in capsys.readouterr().err
    gg.write(SWAN, path)
    assert np.array_equal(gg.read_masks(path)["0"], masks[0])


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ({"big", "little"}, "cannot be both little and big"),
        ({"nocount"}, "the form nocount has one block, and here are 2"),
        ({"single", "binary"}, "block 0 has the coordinate 1.44444e[+]40, and single precision ends at 3.4"),
    ],
)
def test_forms_that_cannot_be_written(tmp_path, words, message):
    large = gg.Grid(SWAN.xy * 1e40)
    with pytest.raises(gg.GridgenError, match=message):
        written(Blocks((large, large)), words)


@pytest.mark.parametrize(
    ("data", "told"),
    [
        (b"1\n5 4\n" + b"0 " * 39, "5 x 4 nodes in 2 dimensions needs 43, so that 1 are missing"),
        (b"1\n5 4\n" + b"0 " * 41, "5 x 4 nodes in 2 dimensions needs 43, so that 1 are too many"),
        (
            encoded(SWAN, words=("fortran",))[:-8],
            "in 3 dimensions in double precision needs 520, so that 8 are missing",
        ),
        (encoded(SWAN, words=("binary",)) + b"12", "in double precision needs 496, so that 2 are too many"),
        (encoded(SWAN, words=("fortran",))[:-4] + b"abcd", "the record of block 1 has 1684234849 bytes; expected 480"),
    ],
)
def test_what_is_too_many_or_missing_is_told(data, told):
    with pytest.raises(gg.GridgenError, match=told):
        decoded(data)


def test_numbers_that_lie_across_pieces(monkeypatch):
    """A text is read in pieces that end between words, wherever they end."""
    whole = encoded(SWAN)
    for piece in (1, 2, 3, 7, 64, 10**6):
        monkeypatch.setattr("gridgen_sym.io.plot3d_numbers._PIECE", piece)
        assert decoded(whole).grids == (SWAN,)
        assert decoded(whole.replace(b"0.25\n", b"2.5D-1,\r\n")).grids == (SWAN,)
        with pytest.raises(gg.GridgenError, match="line 12: could not convert string to float: 'x'"):
            decoded(b"\n".join([*whole.splitlines()[:11], b"x", *whole.splitlines()[12:]]))
