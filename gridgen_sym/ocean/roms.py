"""ROMS' grid file, which is an SGRID file, too: names, dimensions and attributes of its variables.

Sources: ROMS' grid.cdl (myroms.org), and the SGRID conventions 0.3, whose example of ROMS' C-grid is followed.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from ..arrays import Array
from .metric import ROTATION, lengths
from .netcdf import Variable
from .staggered import KINDS, Staggered, masks

ATTRIBUTES = {"Conventions": "CF-1.8, SGRID-0.3", "type": "GRID file", "title": "ROMS grid"}
#: Of longitude, latitude, x and y: name in words, unit, CF's name.
_AXES = {
    "lon": ("longitude", "degree_east", "longitude"),
    "lat": ("latitude", "degree_north", "latitude"),
    "x": ("x", "meter", "projection_x_coordinate"),
    "y": ("y", "meter", "projection_y_coordinate"),
}
#: Points in words, where CF needs them.
_POINTS = {"rho": "RHO-points", "u": "U-points", "v": "V-points", "psi": "PSI-points"}


def variables(
    plane: Staggered | None, places: Staggered | None, sea: Array, depth: Array | None
) -> Iterator[tuple[str, Variable]]:
    """Yield the variables by name.

    Args:
        plane: points in a plane, in meters; None if there is none.
        places: points in longitude and latitude; None if there are none.
        sea: 1 at sea, 0 on land, (ni+1, nj+1): at rho points.
        depth: in meters, at rho points; None if it is not known.
    """
    prefix = ("x", "y") if places is None else ("lon", "lat")
    yield "grid", _topology(prefix)
    yield (
        "spherical",
        Variable(
            (),
            np.array(b"F" if places is None else b"T", dtype="S1"),
            {"long_name": "grid type logical switch", "flag_values": "T, F", "flag_meanings": "spherical Cartesian"},
        ),
    )
    for axes, points in ((("x", "y"), plane), (("lon", "lat"), places)):
        for kind in KINDS if points is not None else ():
            for k, axis in enumerate(axes):
                words, unit, standard = _AXES[axis]
                attributes = {"long_name": f"{words} of {_POINTS[kind]}", "units": unit, "standard_name": standard}
                yield f"{axis}_{kind}", _at(kind, getattr(points, kind)[..., k], attributes)
    yield from _metric(places or plane, prefix, geographic=places is not None)  # type: ignore[arg-type]
    if places is not None:
        f = 2 * ROTATION * np.sin(np.radians(places.rho[..., 1]))
        yield "f", _at("rho", f, {"long_name": "Coriolis parameter", "units": "second-1"}, prefix)
    for kind, mask in masks(sea).items():
        flags = {"long_name": f"mask on {_POINTS[kind]}", "flag_values": [0.0, 1.0], "flag_meanings": "land water"}
        yield f"mask_{kind}", _at(kind, mask, flags, prefix)
    if depth is not None:
        yield "h", _at("rho", depth, {"long_name": "bathymetry at RHO-points", "units": "meter"}, prefix)


def _metric(points: Staggered, prefix: tuple[str, str], *, geographic: bool) -> Iterator[tuple[str, Variable]]:
    """Yield what lengths and directions of the cells give: pm, pn, their derivatives, angle, xl and el."""
    dx, angle = lengths(points.u_all[:-1], points.u_all[1:], geographic=geographic)
    dy, _ = lengths(points.v_all[:, :-1], points.v_all[:, 1:], geographic=geographic)
    dndx, dmde = np.zeros_like(dy), np.zeros_like(dx)
    dndx[1:-1], dmde[:, 1:-1] = (dy[2:] - dy[:-2]) / 2, (dx[:, 2:] - dx[:, :-2]) / 2
    for name, values, words, unit in (
        ("pm", 1 / dx, "curvilinear coordinate metric in XI", "meter-1"),
        ("pn", 1 / dy, "curvilinear coordinate metric in ETA", "meter-1"),
        ("dndx", dndx, "XI-derivative of inverse metric factor pn", "meter"),
        ("dmde", dmde, "ETA-derivative of inverse metric factor pm", "meter"),
        ("angle", angle, f"angle between XI-axis and {'EAST' if geographic else 'x'}", "radians"),
    ):
        yield name, _at("rho", values, {"long_name": words, "units": unit}, prefix)
    for name, along, length in (("xl", "XI", dx[1:-1].sum(axis=0)), ("el", "ETA", dy[:, 1:-1].sum(axis=1))):
        attributes = {"long_name": f"mean domain length in the {along}-direction", "units": "meter"}
        yield name, Variable((), np.array(length[1:-1].mean()), attributes)


def _at(kind: str, values: Array, attributes: Mapping[str, object], prefix: tuple[str, str] | None = None) -> Variable:
    """Return a variable at points of a kind, eta first; `prefix` names its coordinates."""
    place = {"coordinates": " ".join(f"{axis}_{kind}" for axis in prefix)} if prefix else {}
    locations = {"rho": "face", "u": "edge1", "v": "edge2", "psi": "node"}
    more = {"grid": "grid", "location": locations[kind]}
    return Variable((f"eta_{kind}", f"xi_{kind}"), np.asarray(values.T, dtype=float), {**attributes, **place, **more})


def _topology(prefix: tuple[str, str]) -> Variable:
    """Return SGRID's description of the staggering: all rho points beyond the outer nodes are padding."""
    pairs = {kind: " ".join(f"{axis}_{kind}" for axis in prefix) for kind in KINDS}
    return Variable(
        (),
        np.array(0, dtype="i4"),
        {
            "cf_role": "grid_topology",
            "topology_dimension": np.int32(2),
            "node_dimensions": "xi_psi eta_psi",
            "face_dimensions": "xi_rho: xi_psi (padding: both) eta_rho: eta_psi (padding: both)",
            "edge1_dimensions": "xi_u: xi_psi eta_u: eta_psi (padding: both)",
            "edge2_dimensions": "xi_v: xi_psi (padding: both) eta_v: eta_psi",
            "node_coordinates": pairs["psi"],
            "face_coordinates": pairs["rho"],
            "edge1_coordinates": pairs["u"],
            "edge2_coordinates": pairs["v"],
        },
    )
