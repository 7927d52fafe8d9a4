"""Outlines in longitude and latitude: the plane into which they are projected."""

from __future__ import annotations

from ..arrays import Array
from ..errors import GridgenError
from ..geography import Projection, project
from ..messages import report
from ..outlines import OutlineContent


def projected(found: OutlineContent, crs: str | None) -> tuple[Projection | None, Array, tuple[Array, ...]]:
    """Return the projection that `crs` names, and points and islands in its plane; without one these as they are.

    Longitude and latitude that stay as they are, and the plane that is chosen for others, are reported.

    Raises:
        GridgenError: for coordinates that are no places on Earth, or a system that does not show them.
        MissingExtraError: if pyproj is not installed.
    """
    if crs is None:
        if found.geographic:
            report(
                "longitude and latitude are taken for x and y of a plane, so that cells are not orthogonal on Earth: "
                "project them with crs='auto' (--crs auto)"
            )
        return None, found.points, found.islands
    if found.geographic is False:
        raise GridgenError(f"its coordinates are those of a plane already: drop crs={crs!r} (--crs)")
    projection = project(found.points, crs)
    if crs == "auto":
        report(f"the plane is that of the projection {projection.name}")
    return projection, projection.to_plane(found.points), tuple(map(projection.to_plane, found.islands))
