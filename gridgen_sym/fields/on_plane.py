"""Fields whose samples are in longitude and latitude, as functions of a plane."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..arrays import Array
from ..geography import Projection
from .sampled import SampledField


def on_plane(field: SampledField, projection: Projection) -> SampledField:
    """Return a field that is known in longitude and latitude as one in the plane of a projection, in its unit.

    Samples may count longitudes from 0 to 360 or from -180 to 180. Derivatives are taken by differences.
    """

    def places(x: Array, y: Array) -> tuple[Array, Array]:
        lon, lat = np.moveaxis(projection.to_geographic(np.stack((x, y), axis=-1)), -1, 0)
        return field.middle + (lon - field.middle + 180) % 360 - 180, lat

    return replace(
        field,
        _derivative=None,
        _value=lambda x, y: field(*places(x, y)),
        _covers=lambda x, y: field.covers(*places(x, y)),
        _missing=lambda x, y: field.missing(*places(x, y)),
    )
