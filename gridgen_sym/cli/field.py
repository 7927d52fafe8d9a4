"""Fields and targets on the command line: formulas, or files with a raster, samples, nodal values or a grid."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import GridgenError, quoted
from ..options import SAMPLES
from ..parsing import number_in
from .options import option
from .samples import source_of

if TYPE_CHECKING:
    from ..fields import Field, Target
    from ..fields.outside import Outside
    from ..fields.scalar import Source
    from ..geography import Projection

_OUTSIDE = SAMPLES["outside"]
#: Adds `--outside` to a command.
outside_option = option(_OUTSIDE, more=" of a file, or take the nearest sample", default=_OUTSIDE.default)
_FIELD = (
    "--field is written NAME=VALUE, NAME:logical=VALUE or NAME:differentiated=VALUE, such as M='(1 + x**2, 0, 1)' or "
    "p:logical='1 + xi'"
)
_TARGET = (
    "--target takes a grid file (.vts, .npz, .cgns, ...), alone or with an angle: 'FILE, 90', "
    "or formulas in xi and eta: 'w1, w2' or 'w1, w2, angle'"
)


def fields_of(
    texts: Iterable[str], outside: Outside = "error", projection: Projection | None = None
) -> dict[str, Field]:
    """Return the fields that texts such as `M=(1 + x**2, 0, 1)` give, by name; `outside` is that of samples.

    Samples in files are in longitude and latitude where there is a projection.

    Raises:
        GridgenError: for other texts, a name that comes twice, or a file that cannot be read.
    """
    from ..fields import Field

    found: dict[str, Field] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        name, colon, how = (part.strip() for part in name.partition(":"))
        if not (name.isidentifier() and equals and value.strip()) or (
            colon and how not in ("logical", "differentiated")
        ):
            raise GridgenError(f"{_FIELD}; came {quoted(text)}")
        if name in found:
            raise GridgenError(f"--field gives {name} twice: give each field once")
        smooth = how == "differentiated"
        parts = [source_of(part, smooth=smooth, outside=outside, projection=projection) for part in _parts(value)]
        source: Any = parts[0] if len(parts) == 1 else tuple(parts)
        found[name] = Field(source, "logical" if how == "logical" else "physical", how if smooth else "frozen")  # type: ignore[arg-type]
    return found


def target_of(text: str | None, projection: Projection | None = None) -> Target | dict[str, Target] | None:
    """Return the target that `--target` gives: the cells of a grid file, or two lengths and an angle.

    Of a file of several blocks there is one for each, by name.

    Raises:
        GridgenError: for anything else, or a file that cannot be read.
    """
    from ..fields import Target
    from ..io import known_suffixes

    if text is None:
        return None
    parts = _parts(text)
    if len(parts) in (1, 2) and Path(parts[0]).suffix.lower() in known_suffixes():
        return _target_of_file(projection, *parts)
    if len(parts) in (2, 3):
        return Target(*parts)
    raise GridgenError(f"{_TARGET}; came {quoted(text)}")


def _target_of_file(projection: Projection | None, path: str, angle: str | None = None) -> Target | dict[str, Target]:
    """Return the target of a grid file, at an angle in degrees."""
    from ..fields import Target
    from ..io import read
    from ..topology import MultiBlock

    try:
        degrees = None if angle is None else number_in(angle)
    except ValueError:
        raise GridgenError(f"{_TARGET}; the angle {quoted(angle)} is not a number") from None
    made = read(path)
    if isinstance(made, MultiBlock):
        named = zip(made.names, made.blocks, strict=True)
        return {name: Target.of(block, degrees) for name, block in named}
    return Target.of(made if projection is None else projection.grid_to_plane(made), degrees)


def control_of(text: str) -> Any:  # noqa: ANN401 - two formulas, or a name
    """Return the control functions that `--control` gives: two formulas in xi and eta, or how they are computed.

    Raises:
        GridgenError: for anything else.
    """
    parts = _parts(text)
    if len(parts) == 2:
        return tuple(parts)
    if text.strip() in ("thomas-middlecoff", "hilgenstock-white"):
        return text.strip()
    raise GridgenError(
        "--control takes two formulas in xi and eta, such as '-2*xi, 0', thomas-middlecoff, or with --wall "
        f"hilgenstock-white; came {quoted(text)}"
    )


def field_of(text: str, *, smooth: bool, outside: Outside = "error", projection: Projection | None = None) -> Source:
    """Return what `--to` or `--weight` names, as `as_scalar` takes it: a formula, samples, or numbers of one grid.

    Args:
        text: the name of a .npz or .csv file, `FILE.nc:VARIABLE`, or a formula in x and y.
        smooth: interpolate samples by cubics, whose slopes are continuous.
        outside: whether nodes outside of samples are refused, or have the nearest value.
        projection: onto the plane, of files whose samples are in longitude and latitude.

    Raises:
        GridgenError: for a file that cannot be read, or holds something else.
    """
    found = source_of(text, smooth=smooth, outside=outside, projection=projection)
    if isinstance(found, tuple):
        raise GridgenError(f"cannot read the field {text}: it has {len(found)} values per sample, and one is wanted")
    return found


def _parts(text: str) -> list[str]:
    """Return the parts of a text between commas that stand in no parentheses but those around the whole."""
    text = text.strip()
    depths, depth = [], 0
    for sign in text:
        depth += (sign == "(") - (sign == ")")
        depths.append(depth)
    if text.startswith("(") and 0 in depths and depths.index(0) == len(text) - 1:
        return _parts(text[1:-1])
    cuts = [k for k, sign in enumerate(text) if sign == "," and depths[k] == 0]
    return [text[a + 1 : b].strip() for a, b in zip([-1, *cuts], [*cuts, len(text)], strict=True)]
