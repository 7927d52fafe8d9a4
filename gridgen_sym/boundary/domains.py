"""Classical test domains of grid generation, by formula: one function each gives the four sides."""

from __future__ import annotations

import difflib
import inspect
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..errors import GridgenError, quoted
from ..grids.grid import Grid, check_counts
from .curves import Side, arc, curve, line, polyline
from .sides import Sides, grid_of_sides


@dataclass(frozen=True, slots=True)
class _Domain:
    """A domain of the table: its description, and the maker of its sides."""

    description: str
    sides: Callable[..., Sides[Side]]


_DOMAINS: dict[str, _Domain] = {}


def domain_names() -> list[str]:
    """Return the names of all classical domains, sorted."""
    return sorted(_DOMAINS)


def domain_description(name: str) -> str:
    """Return one line about the domain `name`.

    Raises:
        GridgenError: if no domain has this name.
    """
    return _find(name).description


def domain(name: str, ni: int, nj: int, **parameters: float) -> Grid:
    """Return the transfinite grid of a classical domain, its boundary sampled uniformly in the parameter.

    Args:
        name: one of `domain_names()`.
        ni: nodes along xi (bottom and top), at least 3.
        nj: nodes along eta (left and right), at least 3.
        **parameters: numbers that the domain takes, such as ``R=4.5`` of 'horseshoe_map'.

    Raises:
        GridgenError: for an unknown name (with the closest ones), a parameter that the domain has not, or
            too few nodes.
    """
    maker = _find(name).sides
    known = list(inspect.signature(maker).parameters)
    for key, value in parameters.items():
        if key not in known:
            raise GridgenError(f"the domain '{name}' has no parameter '{key}'; it takes: {', '.join(known) or 'none'}")
        if not np.isfinite(value):
            raise GridgenError(f"the parameter {key} of the domain '{name}' must be finite, but is {value}")
    check_counts(ni, nj)
    sides = maker(**parameters)
    s, t = np.linspace(0.0, 1.0, ni), np.linspace(0.0, 1.0, nj)
    return grid_of_sides(Sides(sides.bottom(s), sides.right(t), sides.top(s), sides.left(t)))


def _find(name: str) -> _Domain:
    """Return the entry of the table, or raise an error with the closest names."""
    if isinstance(name, str) and name in _DOMAINS:
        return _DOMAINS[name]
    close = difflib.get_close_matches(str(name), _DOMAINS, n=3, cutoff=0.4)
    hint = f"did you mean {' or '.join(repr(c) for c in close)}? " if close else ""
    raise GridgenError(f"no classical domain is called {quoted(name)}: {hint}Known: {', '.join(domain_names())}")


def _classical(description: str) -> Callable[[Callable[..., Sides[Side]]], Callable[..., Sides[Side]]]:
    """Register the decorated maker of sides under its own name."""

    def register(maker: Callable[..., Sides[Side]]) -> Callable[..., Sides[Side]]:
        _DOMAINS[maker.__name__] = _Domain(description, maker)
        return maker

    return register


@_classical("the unit square")
def square() -> Sides[Side]:
    """Give the sides of the unit square."""
    return Sides(line((0, 0), (1, 0)), line((1, 0), (1, 1)), line((0, 1), (1, 1)), line((0, 0), (0, 1)))


@_classical("a square with a sagging top and a bulging right side, after a swan's neck")
def swan() -> Sides[Side]:
    """Give the sides of the swan."""
    top = curve(lambda s: s, lambda s: 1 - 3 * s + 3 * s**2)
    right = curve(lambda s: 1 + 2 * s - 2 * s**2, lambda s: s)
    return Sides(line((0, 0), (1, 0)), right, top, line((0, 0), (0, 1)))


@_classical("a band with a corner, its bottom and top bent to a V and an upturned V of equal width")
def chevron() -> Sides[Side]:
    """Give the sides of the chevron."""
    half = [0.0, 0.5, 1.0]
    bottom = polyline([(0, 0), (0.5, -0.5), (1, 0)], half)
    top = polyline([(0, 1), (0.5, 0.5), (1, 1)], half)
    return Sides(bottom, line((1, 0), (1, 1)), top, line((0, 0), (0, 1)))


@_classical("half of an elliptic ring, flat: the horseshoe")
def horseshoe() -> Sides[Side]:
    """Give the sides of the horseshoe: two half ellipses and two straight ends."""
    bottom, top = arc(2, 1, np.pi / 2, np.pi), arc(4, 2, np.pi / 2, np.pi)
    return Sides(bottom, line((0, -1), (0, -2)), top, line((0, 1), (0, 2)))


@_classical("the horseshoe map with the aspect R = 4.5, hard for finite differences")
def horseshoe_map(R: float = 4.5) -> Sides[Side]:
    """Give the sides of x = -(1+eta) cos(pi xi), y = (1 + (2R-1) eta) sin(pi xi).

    The map is linear in eta, so that transfinite interpolation of its sides is the map itself.
    """
    bottom, top = arc(1, 1, np.pi, np.pi), arc(2, 2 * R, np.pi, np.pi)
    return Sides(bottom, line((1, 0), (2, 0)), top, line((-1, 0), (-2, 0)))


@_classical("the unit square with its left side pushed in by half a unit")
def indented_square() -> Sides[Side]:
    """Give the sides of the indented square."""
    left = curve(lambda s: 0.5 * np.sin(np.pi * s), lambda s: s)
    return Sides(line((0, 0), (1, 0)), line((1, 0), (1, 1)), line((0, 1), (1, 1)), left)


@_classical("a band between two sine waves out of step")
def wavy() -> Sides[Side]:
    """Give the sides of the wavy band."""
    lift = 0.35 * np.sin(0.5)
    bottom = curve(lambda s: s, lambda s: 0.35 * np.sin(2 * np.pi * s))
    top = curve(lambda s: s, lambda s: 1 + 0.35 * np.sin(2 * np.pi * s + 0.5))
    return Sides(bottom, line((1, 0), (1, 1 + lift)), top, line((0, 0), (0, 1 + lift)))


@_classical("the whole ring between the radii 1 and 2, cut along the positive x axis")
def annulus() -> Sides[Side]:
    """Give the sides of the ring; left and right are the two banks of one cut."""
    cut = line((1, 0), (2, 0))
    return Sides(arc(1, 1, 0, 2 * np.pi), cut, arc(2, 2, 0, 2 * np.pi), cut)


@_classical("a quarter of the ring between the radii 1 and 2")
def quarter_annulus() -> Sides[Side]:
    """Give the sides of the quarter ring."""
    bottom, top = arc(1, 1, np.pi / 2, np.pi / 2), arc(2, 2, np.pi / 2, np.pi / 2)
    return Sides(bottom, line((1, 0), (2, 0)), top, line((0, 1), (0, 2)))


@_classical("a Z-shaped channel: half of its transfinite cells are inverted")
def zee() -> Sides[Side]:
    """Give the sides of the zee; choose nj - 1 divisible by 4 to have nodes on its corners."""
    strokes, at = [(0.0, 0.0), (0.0, 1.0), (0.6, 0.4), (0.6, 1.4)], [0.0, 0.25, 0.75, 1.0]
    left = polyline(strokes, at)
    right = polyline([(x + 1, y) for x, y in strokes], at)
    return Sides(line((0, 0), (1, 0)), right, line((0.6, 1.4), (1.6, 1.4)), left)


@_classical("an O-grid around a NACA 0012 section out to a circle of radius 2, cut behind the trailing edge")
def naca(thickness: float = 0.12, radius: float = 2.0) -> Sides[Side]:
    """Give the sides of the O-grid: the section inside, the circle outside, the two banks of the cut.

    The formula leaves the trailing edge open by 0.25 % of the chord; both banks start in its middle, (1, 0).
    Source: I. H. Abbott and A. E. von Doenhoff, Theory of Wing Sections (1959),
    section 6.4.
    """

    def height(x: Array) -> Array:
        powers = 0.2969 * np.sqrt(x) - 0.1260 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1015 * x**4
        return np.where(x < 1, 5 * thickness * powers, 0.0)

    def section(s: Array) -> Array:
        x = (0.5 * (1 + np.cos(2 * np.pi * s))).clip(0, 1)  # Dense at both edges; from (1, 0) along the lower side.
        return np.stack((x, np.where(s < 0.5, -1.0, 1.0) * height(x)), axis=-1)

    cut = line((1, 0), (0.5 + radius, 0))
    return Sides(section, cut, arc(radius, radius, 0, 2 * np.pi, center=0.5), cut)
