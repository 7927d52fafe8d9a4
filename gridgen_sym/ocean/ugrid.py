"""A grid as a list of quadrilaterals, by the UGRID conventions 1.0."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..arrays import Array
from .netcdf import Variable
from .staggered import Staggered

ATTRIBUTES = {"Conventions": "CF-1.8, UGRID-1.0"}


def variables(
    points: Staggered, sea: Array, depth: Array | None, *, geographic: bool
) -> Iterator[tuple[str, Variable]]:
    """Yield the variables by name: nodes, faces counter-clockwise, and mask and depth of the faces.

    Args:
        points: in longitude and latitude, or in a plane.
        sea: 1 at sea, (ni+1, nj+1): at rho points, of which those outside are left out.
        depth: the same, in meters; None if it is not known.
        geographic: whether points are in longitude and latitude.
    """
    axes = ("lon", "lat") if geographic else ("x", "y")
    units = ("degree_east", "degree_north") if geographic else ("meter", "meter")
    standard = ("longitude", "latitude") if geographic else ("projection_x_coordinate", "projection_y_coordinate")
    of = {kind: " ".join(f"mesh_{kind}_{axis}" for axis in axes) for kind in ("node", "face")}
    yield (
        "mesh",
        Variable(
            (),
            np.array(0, dtype="i4"),
            {
                "cf_role": "mesh_topology",
                "topology_dimension": np.int32(2),
                "node_coordinates": of["node"],
                "face_coordinates": of["face"],
                "face_node_connectivity": "mesh_face_nodes",
                "face_dimension": "mesh_face",
            },
        ),
    )
    for kind, at in (("node", points.psi), ("face", points.rho[1:-1, 1:-1])):
        for k, axis in enumerate(axes):
            attributes = {"units": units[k], "standard_name": standard[k], "long_name": f"{axis} of {kind}s"}
            yield f"mesh_{kind}_{axis}", Variable((f"mesh_{kind}",), at[..., k].ravel(), attributes)
    number = np.arange(points.psi[..., 0].size, dtype="i4").reshape(points.psi.shape[:2])
    corners = (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:])
    faces = np.stack([one.ravel() for one in corners], axis=-1)
    yield (
        "mesh_face_nodes",
        Variable(
            ("mesh_face", "mesh_corner"), faces, {"cf_role": "face_node_connectivity", "start_index": np.int32(0)}
        ),
    )
    place = {"mesh": "mesh", "location": "face", "coordinates": of["face"]}
    flags = {"long_name": "mask", "flag_values": [0.0, 1.0], "flag_meanings": "land water"}
    yield "mask", Variable(("mesh_face",), np.asarray(sea[1:-1, 1:-1], dtype=float).ravel(), flags | place)
    if depth is not None:
        attributes = {"long_name": "bathymetry", "units": "meter"}
        yield "h", Variable(("mesh_face",), depth[1:-1, 1:-1].ravel(), attributes | place)
