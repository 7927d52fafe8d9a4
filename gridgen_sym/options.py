"""What an option is: the arguments that public functions share with the command line, each said once.

The command line makes its options of these rows (`cli/options.py`). Signatures and docstrings stay where they are read,
in the functions; `tests/test_options.py` holds them to the rows: the same defaults and choices, and an entry of the
docstring that begins with the row's help.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any


@dataclass(frozen=True, slots=True)
class Option:
    """An argument of a public function that is an option of the command line, too.

    Attributes:
        name: of the argument.
        help: what it is, a sentence without its period; the command line may add how it is written there.
        kind: what a value is on the command line: `str`, `float`, `int` or `bool`.
        default: of the signature; None where every function has its own.
        unset: what None means, for readers.
        choices: the words that are allowed, if only some are.
    """

    name: str
    help: str
    kind: type = str
    default: Any = None
    unset: str = ""
    choices: tuple[str, ...] = ()

    @property
    def shown_default(self) -> str:
        """The default as users write it, or what happens without one; empty if neither is to be said."""
        if self.default is None or self.kind is bool:
            return self.unset
        values = self.default if isinstance(self.default, tuple) else (self.default,)
        return " ".join(f"{value:g}".replace("e-0", "e-") if self.kind is float else str(value) for value in values)


def _table(*rows: Option) -> Mapping[str, Option]:
    return MappingProxyType({row.name: row for row in rows})


#: Of `optimize` and `solve_euler_lagrange`.
SOLVERS = _table(
    Option("functional", "What is minimized"),
    Option("weight", "Adaptive weight s(x, y)"),
    Option("fields", "Values of the fields that the density declares"),
    Option("target", "What cells should be like"),
    Option("walls", "First heights, growth and angles that are asked for at sides of the block"),
    Option("slide", "Sides whose nodes slide along their curves"),
    Option("control", "Control functions (P, Q)"),
    Option("parameters", "Values of the functional's parameters"),
    Option("tolerance", "Factor by which the norm of the gradient or the residual must fall", float),
    Option("max_iterations", "Newton steps, or sweeps", int),
    Option("time_limit", "Seconds after which the best grid is returned", float),
    Option("keep_valid", "Keep a valid grid valid", bool, default=True),
    Option("interior_only", "Sum over corners at inner nodes only", bool, default=False),
    Option("spacing", "Logical steps", default="unit", choices=("unit", "index")),
    Option("backend", "c, numpy, or one that is installed", unset="c if possible"),
)

#: Of `adapt`, which shares some with the solvers, and `Monitor`.
ADAPTATION = _table(
    Option(
        "monitor",
        "What the density of nodes is made of",
        default="curvature",
        choices=("curvature", "gradient", "arc_length", "recovery_error", "hierarchical_error", "values"),
    ),
    Option("feature_fraction", "Fraction of the nodes that features get", float, default=0.75),
    Option("smoothing", "How often the density is averaged over 3 x 3 nodes", int, default=2),
    Option("functional", "What is minimized", default="area_winslow"),
    Option("max_iterations", "At most so many steps", int, default=30),
    Option("boundary", "Where boundary nodes slide", default="straight", choices=("straight", "all", "fixed")),
    *(SOLVERS[name] for name in ("fields", "target", "parameters", "time_limit", "backend")),
)

#: Of `Weight`.
WEIGHT = _table(
    Option(
        "mode",
        "Hold the weight at the nodes, or differentiate through it",
        default="frozen",
        choices=("frozen", "differentiated"),
    ),
    Option("allow_negative", "Accept a weight that is negative somewhere", bool, default=False),
)

#: Of fields known by samples: `raster_field`, `scattered_field`.
SAMPLES = _table(
    Option("outside", "Refuse nodes outside the samples", default="error", choices=("error", "nearest")),
)

#: Of `plot_grid` and `view_grid`.
PICTURES = _table(
    Option("under", "A field that is drawn with the grid"),
)

#: Of `Outline` and its methods.
OUTLINE = _table(
    Option("corners", "Corners of the outline"),
    Option(
        "sampling",
        "Boundary nodes on sharp turns of the outline, or at equal arc lengths",
        default="features",
        choices=("features", "equal"),
    ),
    Option("spacing", "Laws for the boundary nodes of sides"),
    Option("reorient", "Whether a clockwise curve is reversed", bool, default=True, unset="reorient"),
    Option("crs", "Plane onto which longitude and latitude are projected"),
)

#: Of `read` and `write`.
FILES = _table(
    Option("layout", "Connect the sides of a file of one block, too: the cut of a C- or O-grid", bool, default=False),
    Option("form", "Words that select a format, or a variant of one"),
)

#: Of `ocean_grid`.
OCEAN = _table(
    Option("depth", "Depth in meters, positive downwards"),
    Option("min_depth", "Least depth in meters, also on land", float, default=1.0),
    Option("coast", "Coast around the water, outside of which is land"),
    Option("land", "Where there is land, too"),
)

#: Of `airfoil_grid`.
AIRFOIL = _table(
    Option("kind", "Type of the grid: C, with a cut along the wake, or O", default="C", choices=("C", "O")),
    Option("first", "Height of the first cells at the airfoil, in the unit of the section", float, default=1e-5),
    Option("growth", "Factor from one height to the next", float, unset="what reaches the outer boundary"),
    Option("far", "Distance of the outer boundary from the airfoil, in chords", float, default=20.0),
    Option("cells", "Numbers of cells on the airfoil, which is even, and outwards", int, default=(96, 64)),
    Option("wake", "Number of cells along the wake of a C-grid", int, default=40),
    Option("leading", "Length of the cells at the leading edge, in chords", float, unset="1/8 of the mean"),
    Option("trailing", "Length of the cells at the trailing edge, in chords", float, unset="1/6 of the mean"),
    Option("blunt", "Whether a section of a NACA number has the published thickness of its trailing edge", bool, False),
    SOLVERS["backend"],
)
