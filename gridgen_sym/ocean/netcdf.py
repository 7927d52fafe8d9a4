"""netCDF files in memory, with netCDF4: variables with dimensions and attributes, written and read with bounds."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt

from ..archives import check_packing
from ..arrays import Array
from ..errors import GridgenError, MissingExtraError, quoted, shortened
from . import classic

_HDF5 = b"\x89HDF\r\n\x1a\n"
#: More numbers of one variable take gigabytes, and none of them is beside the grid.
_MOST = 1 << 28
#: What a damaged file raises in the libraries that read it.
_FAULTS = (
    OSError, RuntimeError, ValueError, TypeError, IndexError, KeyError, MemoryError, AttributeError, OverflowError,
    AssertionError,
)  # fmt: skip
_EMPTY: Mapping[str, Any] = MappingProxyType({})


@dataclass(frozen=True, slots=True)
class Variable:
    """A variable of a netCDF file.

    Attributes:
        dimensions: their names, the slowest first.
        values: the numbers, or a character.
        attributes: its attributes.
    """

    dimensions: tuple[str, ...]
    values: npt.NDArray[Any]
    attributes: Mapping[str, Any] = field(default_factory=lambda: _EMPTY)


def encode(variables: Iterable[tuple[str, Variable]], attributes: Mapping[str, Any]) -> bytes:
    """Return a netCDF-4 file with named variables, whose dimensions are as long as their arrays.

    Raises:
        MissingExtraError: if netCDF4 is not installed.
    """
    library = _library("writing a netCDF file")
    # The bytes of a file in memory are marked as open for writing, and no program would append to them.
    with TemporaryDirectory() as folder:
        path = Path(folder) / "grid.nc"
        with library.Dataset(path, "w") as made:
            made.setncatts(dict(attributes))
            for name, variable in variables:
                _add(made, name, variable)
        return path.read_bytes()


def _add(made: Any, name: str, variable: Variable) -> None:  # noqa: ANN401
    """Add a variable to a file that is written."""
    for dimension, size in zip(variable.dimensions, variable.values.shape, strict=True):
        if dimension not in made.dimensions:
            made.createDimension(dimension, size)
    written = made.createVariable(name, variable.values.dtype, variable.dimensions)
    written.setncatts(dict(variable.attributes))
    written[...] = variable.values


class NetcdfFile:
    """A file that is read: variables by name, and their attributes."""

    def __init__(self, dataset: Any) -> None:  # noqa: ANN401
        """Hold what netCDF4 has opened."""
        self._dataset = dataset

    @property
    def variables(self) -> Mapping[str, Any]:
        """What netCDF4 has, by name: with `dimensions`, `shape` and `ncattrs()`."""
        return self._dataset.variables  # type: ignore[no-any-return]

    def attribute(self, variable: str, name: str) -> str:
        """Return an attribute of a variable as text; empty if it has none."""
        found = self.variables[variable]
        return str(found.getncattr(name)) if name in found.ncattrs() else ""

    def numbers(self, name: str, packed: int) -> Array:
        """Return the numbers of a variable, with NaN where there are none.

        Args:
            name: of the variable.
            packed: how long the whole file is.

        Raises:
            GridgenError: if there is no such variable, it holds no numbers, or they would fill the memory.
        """
        if name not in self.variables:
            raise GridgenError(f"it has no variable {quoted(name)}; it has {shortened(', '.join(self.variables))}")
        found = self.variables[name]
        if getattr(found.dtype, "kind", "O") not in "biuf":
            raise GridgenError(f"its variable {quoted(name)} holds no numbers, but {found.dtype}")
        count = int(np.prod(found.shape, dtype=object))
        check_packing(packed, 8 * count, f"the variable {quoted(name)}")
        if count > _MOST:
            raise GridgenError(
                f"the variable {quoted(name)} holds {count} numbers, and at most {_MOST} are read: cut it to the "
                "region first, as with  ncks -d lon,WEST,EAST -d lat,SOUTH,NORTH IN OUT"
            )
        with np.errstate(all="ignore"):  # A damaged file has scales that overflow.
            return np.ma.filled(np.ma.asarray(found[...]).astype(float), np.nan)


@contextmanager
def opened(data: bytes) -> Iterator[NetcdfFile]:
    """Open the bytes of a netCDF file.

    Raises:
        GridgenError: if it is none, or is damaged.
        MissingExtraError: if netCDF4 is not installed.
    """
    if data.startswith(b"CDF\x05"):
        raise GridgenError("it is a classic file of version 5 (CDF-5); convert it with  nccopy -k nc4 IN OUT")
    if not data.startswith((*classic.MAGIC, _HDF5)):
        raise GridgenError("it does not begin as a netCDF file does")
    try:
        if data.startswith(classic.MAGIC):
            yield NetcdfFile(classic.ClassicFile(data))
        else:
            with _library("reading a netCDF file").Dataset("memory.nc", "r", memory=data) as dataset:
                yield NetcdfFile(dataset)
    except MissingExtraError:
        raise
    except _FAULTS as error:
        if isinstance(error, GridgenError):
            raise
        raise GridgenError(f"it is no whole netCDF file ({shortened(error)}); write it again") from error


def _library(purpose: str) -> Any:  # noqa: ANN401
    try:
        import netCDF4
    except ImportError:
        raise MissingExtraError(purpose, "ocean", "netCDF4") from None
    return netCDF4
