"""The grid that the command `grid` starts from: a classical domain, an outline or a grid file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from gridgen_sym.errors import GridgenError

if TYPE_CHECKING:
    from gridgen_sym.grids import Grid

_DEFAULT_CELLS = (40, 40)


def start_grid(
    source: str,
    size: tuple[int, int] | None = None,
    *,
    corners: str | None = None,
    sampling: str | None = None,
    reorient: bool = False,
) -> Grid:
    """Return the grid to start from.

    Args:
        source: a domain with its parameters, an outline's file or a grid file.
        size: number of cells; not for a grid file, which has its own.
        corners: of an outline: 'auto', or four indices of its points with commas or blanks between.
        sampling: of an outline: 'features' or 'equal'.
        reorient: accept a clockwise outline or grid file.

    Raises:
        GridgenError: if it is none of these, or cannot be read.
    """
    from gridgen_sym.grids import domain, known_suffixes

    ni, nj = (cells + 1 for cells in size or _DEFAULT_CELLS)
    if min(ni, nj) < 3:
        raise GridgenError(f"--size is the number of cells along xi and eta, at least 2 2; came {ni - 1} {nj - 1}")
    suffix = Path(source).suffix.lower()
    is_file = suffix in known_suffixes() or Path(source).is_file()
    if is_file and suffix == ".csv" and (_has_corners(source) or (corners and _has_points_only(source))):
        return _outline_grid(source, ni, nj, corners, sampling, reorient)
    for option, value in (("--corners", corners), ("--sampling", sampling)):
        if value is not None:
            raise GridgenError(
                f"{option} belongs to an outline (a CSV file with the header x,y), which {source} is not"
            )
    if is_file:
        return _grid_file(source, size, reorient)
    key, _, rest = source.partition(":")
    return domain(key, ni, nj, **assignments(rest.split(",") if rest else [], f"the domain {key!r}"))


def assignments(texts: list[str] | tuple[str, ...], of: str) -> dict[str, float]:
    """Return the values of texts such as `R=4.5`."""
    values = {}
    for text in texts:
        name, equals, value = text.partition("=")
        try:
            if not (name and equals):
                raise ValueError
            values[name.strip()] = float(value)
        except ValueError:
            raise GridgenError(f"a parameter of {of} is written NAME=NUMBER, such as k=0.5; came {text!r}") from None
    return values


def _has_corners(path: str) -> bool:
    return any(line.startswith("#") and line[1:].strip().lower().startswith("corners") for line in _lines(path))


def _has_points_only(path: str) -> bool:
    """Say whether a CSV file has the header x,y of an outline, and not that of a grid."""
    header = next((line for line in _lines(path) if line.strip() and not line.startswith("#")), "")
    return header.replace(" ", "").lower() == "x,y"


def _lines(path: str) -> list[str]:
    from gridgen_sym.atomic import read_bytes

    return read_bytes(path).decode("utf-8-sig", errors="replace").splitlines()


def _outline_grid(path: str, ni: int, nj: int, corners: str | None, sampling: str | None, reorient: bool) -> Grid:
    """Return the grid of an outline's file."""
    from gridgen_sym.grids import Outline

    chosen: Any = corners
    if corners is not None and corners != "auto":
        try:
            chosen = [int(word) for word in corners.replace(",", " ").split()]
        except ValueError:
            chosen = []
        if len(chosen) != 4:
            raise GridgenError(f"--corners is auto or four whole numbers, such as '0,10,20,30'; came {corners!r}")
    # A file without corners gets some in place of its own: others are chosen, and points keep their numbers.
    outline = Outline.read(path, corners=None if _has_corners(path) else (0, 1, 2, 3), reorient=reorient)
    return outline.grid(ni, nj, chosen, sampling or "features")  # type: ignore[arg-type]


def _grid_file(path: str, size: tuple[int, int] | None, reorient: bool) -> Grid:
    """Return the grid of a file; one that runs clockwise is mirrored if that is wished, and it is said."""
    from gridgen_sym.grids import Grid, certificates, read
    from gridgen_sym.messages import say

    if size is not None:
        raise GridgenError(
            f"{path} is read as a grid file, which has its own number of cells: drop --size; if it is an outline, say "
            "--corners auto, or name its corners in a line '# corners: 0 10 20 30'"
        )
    grid = read(path)
    if reorient and any(found.kind == "clockwise" for found in certificates(grid)):
        say(f"{path} runs clockwise: its sides left and right are exchanged")
        return Grid(grid.xy[::-1])
    return grid
