"""Classic netCDF files (versions 1 and 2), read by SciPy in Python: the C library crashes on damaged ones."""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

MAGIC = (b"CDF\x01", b"CDF\x02")


class ClassicFile:
    """A classic file, as far as `NetcdfFile` needs one of netCDF4's."""

    def __init__(self, data: bytes) -> None:
        """Read the header of a file; what a damaged one raises is for the caller."""
        from scipy.io import netcdf_file

        self._file = netcdf_file(io.BytesIO(data), "r", mmap=False, maskandscale=True)
        self.variables: Mapping[str, Any] = {
            name: ClassicVariable(one) for name, one in self._file.variables.items() if isinstance(name, str)
        }


class ClassicVariable:
    """A variable of a classic file, as netCDF4 has it."""

    def __init__(self, variable: Any) -> None:  # noqa: ANN401
        """Hold what SciPy has read."""
        self._variable = variable
        self.dimensions: tuple[str, ...] = variable.dimensions
        self.shape: tuple[int, ...] = variable.data.shape
        self.dtype: np.dtype[Any] = variable.data.dtype

    def ncattrs(self) -> list[str]:
        """Return the names of its attributes."""
        return list(self._variable._attributes)

    def getncattr(self, name: str) -> object:
        """Return an attribute."""
        value = self._variable._attributes[name]
        return value.decode("utf-8", errors="replace") if isinstance(value, bytes) else value

    def __getitem__(self, index: object) -> npt.NDArray[Any]:
        """Return the numbers, masked where they are missing, in the machine's byte order."""
        values = np.ma.asarray(self._variable[index])
        return values.astype(values.dtype.newbyteorder("="))
