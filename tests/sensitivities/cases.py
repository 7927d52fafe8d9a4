"""Results as functions of a number t, and the tangents of their data there: what derivatives of grids are tested on."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

import gridgen_sym as gg
from gridgen_sym.boundary.slide_curve import SlideCurve

#: Converged to rounding, so that differences of whole solves have nine digits.
TIGHT = {"tolerance": 1e-13}
SHAPE = 9, 8
ODD = gg.Functional(
    "odd_sensitivities",
    "(M11*g11 + 2*M12*g12 + M22*g22)/J + k*s*J**2 + k*p*g11",
    parameters={"k": 0.2},
    fields={"M": "symmetric", "p": "scalar"},
)


@dataclass(frozen=True, slots=True)
class Case:
    """A result for each t, the tangents of what it is made of at t = 0, and their products with gradients."""

    solve: Callable[[float], Any]
    tangents: Mapping[str, Any]
    product: Callable[[gg.Gradients], float]
    step: float = 1e-3


def _random(seed: int) -> np.random.Generator:
    return np.random.default_rng(seed)


def start(shape: tuple[int, int] = SHAPE) -> np.ndarray:
    """Return the nodes (ni, nj, 2) of a bent band, with two curved sides and two straight ones."""
    i, j = np.meshgrid(*(np.linspace(0, 1, n) for n in shape), indexing="ij")
    radius, angle = 1 + j**1.1 + 0.1 * np.sin(3 * i), 1.2 * i + 0.05 * np.sin(2 * i * j)
    return np.stack((-radius * np.cos(angle), radius * np.sin(angle)), axis=-1)


def boundary_change(place: np.ndarray) -> np.ndarray:
    """Return a smooth displacement of the boundary nodes, zero inside."""
    change = 0.3 * np.stack((np.sin(2 * place[..., 1]), place[..., 0] * place[..., 1]), axis=-1)
    change[1:-1, 1:-1] = 0.0
    return change


# ---- a user's functional, on one block ----


def odd(change: Mapping[str, Any], tangents: Mapping[str, Any], product: Callable, **given: Any) -> Case:
    """Return a case of the user's functional; `change` maps arguments to functions of t."""
    random = _random(1)
    usual = {
        "weight": 1 + 0.3 * random.random(SHAPE),
        "fields": {
            "M": gg.Field(("1.2 + 0.05*x", "0.1", "1 + 0.02*y*y"), mode="differentiated"),
            "p": gg.Field("1 + xi", "logical"),
        },
        "parameters": {"k": 0.2},
        **given,
    }
    base = settled(usual)

    def solve(t: float) -> gg.Result:
        changed = {name: of(t) for name, of in change.items()}
        grid = changed.pop("grid", base)
        return gg.optimize(grid, ODD, backend="numpy", **{**usual, **changed}, **TIGHT)

    return Case(solve, tangents, product)


def settled(given: Mapping[str, Any]) -> gg.Grid:
    """Return a minimum, from which those of other data are near."""
    return gg.optimize(gg.Grid(start()), ODD, backend="numpy", **given, **TIGHT).grid


def odd_boundary() -> Case:
    moved = boundary_change(start())
    base = start()
    return odd(
        {"grid": lambda t: gg.Grid(base + t * moved)},
        {"boundary": moved},
        lambda g: (g.boundary * moved).sum(),
    )


def odd_parameter() -> Case:
    return odd({"parameters": lambda t: {"k": 0.2 + t}}, {"parameters": {"k": 1.0}}, lambda g: g.parameters["k"])


def odd_weight(kind: str) -> Case:
    """Return a case of a weight per node, per cell or per corner."""
    ni, nj = SHAPE
    shape = {"node": (ni, nj), "cell": (ni - 1, nj - 1), "corner": (4, ni - 1, nj - 1)}[kind]
    weight, along = 1 + 0.3 * _random(2).random(shape), _random(3).standard_normal(shape)
    return odd(
        {"weight": lambda t: weight + t * along},
        {"weight": along},
        lambda g: (g.weight * along).sum(),
        weight=weight,
    )


def raster() -> tuple[np.ndarray, np.ndarray]:
    return np.linspace(-3, 1.5, 8), np.linspace(3, -1, 7)


def held_samples() -> Case:
    """Return a case of the samples of a frozen weight, which is evaluated where nodes come to."""
    (x, y), along = raster(), 0.1 * _random(5).standard_normal((8, 7))

    def solve(t: float) -> gg.Result:
        weight = gg.Weight.on_raster(x, y, 1 + 0.05 * x[:, None] + 0.03 * y + t * along)
        return gg.optimize(gg.Grid(start()), "winslow", weight=weight, backend="numpy", **TIGHT)

    return Case(solve, {"weight": along}, lambda g: (g.weight * along).sum(), step=1e-4)


def odd_field() -> Case:
    """Return a case of a differentiated field of three components on a raster, and of a frozen formula."""
    samples = np.stack([np.full((8, 7), c) for c in (1.2, 0.1, 1.0)]) + 0.05 * _random(6).random((3, 8, 7))
    along = 0.3 * _random(7).standard_normal(samples.shape)

    def fields(t: float) -> dict[str, Any]:
        return {
            "M": gg.Field.on_raster(*raster(), samples + t * along, "differentiated"),
            "p": gg.Field(f"1 + xi + {t!r}*sin(eta)", "logical"),
        }

    def product(g: gg.Gradients) -> float:
        return float((g.fields["M"] * along).sum() + (g.fields["p"] * np.sin(np.linspace(0, 1, SHAPE[1]))).sum())

    return odd({"fields": fields}, {"fields": {"M": list(along), "p": "sin(eta)"}}, product, fields=fields(0.0))


def odd_lengths() -> Case:
    """Return a case of a target of two lengths and an angle."""
    w1, along = 0.2 + 0.05 * _random(8).random(SHAPE), 0.1 * _random(9).standard_normal(SHAPE)

    def target(t: float) -> gg.Target:
        return gg.Target(w1 + t * along, 0.15 + 0.1 * t, 80 + 20 * t)

    def product(g: gg.Gradients) -> float:
        in_w1, in_w2, in_angle = g.target
        return float((in_w1 * along).sum() + 0.1 * in_w2 + 20 * in_angle)

    return odd({"target": target}, {"target": (along, 0.1, 20.0)}, product, target=target(0.0))


def held_values(backend: str) -> Case:
    """Return a case of the boundary, with a target and a weight that are evaluated where nodes come to."""
    moved, base = 0.3 * boundary_change(start()), start()
    target = gg.Target.matrix(("0.2 + 0.02*x", "0.03*y", "0", "0.15 + 0.01*x*y"), "physical")

    def solve(t: float) -> gg.Result:
        grid = gg.Grid(base + t * moved)
        return gg.optimize(grid, "winslow", target=target, weight="1 + 0.1*sin(x)", backend=backend, **TIGHT)

    return Case(solve, {"boundary": moved}, lambda g: (g.boundary * moved).sum())


def reference_grid() -> Case:
    """Return a case of a reference grid, of winslow in compiled kernels."""
    base, along = gg.optimize(gg.Grid(start()), "winslow", **TIGHT).grid, 0.3 * _random(10).standard_normal((*SHAPE, 2))

    def solve(t: float) -> gg.Result:
        return gg.optimize(base, "winslow", target=gg.Grid(base.xy + 0.1 * t * along), **TIGHT)

    return Case(solve, {"target": 0.1 * along}, lambda g: (g.target * 0.1 * along).sum())


# ---- walls and sliding, on one block ----


def sliding_boundary() -> Case:
    """Return a case of the boundary nodes, on the splines through which all sides slide."""
    base = start()
    moved = 0.3 * boundary_change(base)
    return Case(
        lambda t: gg.optimize(gg.Grid(base + t * moved), "winslow", slide="all", **TIGHT),
        {"boundary": moved},
        lambda g: (g.boundary * moved).sum(),
        step=5e-4,
    )


def moved_turn() -> Case:
    """Return a case of the boundary, one sharp turn of which another node holds than at the start."""
    s, t = np.linspace(0, 1, 25)[:, None], np.linspace(0, 1, 17)[:, None]
    first, turn, last = np.array([0.0, 0.0]), np.array([2.0, 0.0]), np.array([3.0, 1.0])
    up = np.array([0.0, 2.0])
    before, after = np.linspace(0, 1, 5)[:-1, None], np.linspace(0, 1, 21)[:, None]
    bottom = np.concatenate((first + (turn - first) * before, turn + (last - turn) * after))
    base = gg.transfinite(bottom, up + (last - first) * s, first + up * t, last + up * t).xy
    moved = 0.3 * boundary_change(base)
    return Case(
        lambda step: gg.optimize(gg.Grid(base + step * moved), "winslow", slide="all", **TIGHT),
        {"boundary": moved},
        lambda g: (g.boundary * moved).sum(),
        step=3e-4,
    )


def sliding_curve(*, points: bool, backwards: bool = False) -> Case:
    """Return a case of the curve of one side: points, or a function."""
    base, s = start(), np.linspace(0, 1, 30)

    def curve(s: np.ndarray, t: float = 0.0) -> np.ndarray:
        angle = 1.2 * s
        radius = 1 + 0.1 * np.sin(3 * s)
        place = np.stack((-radius * np.cos(angle), radius * np.sin(angle)), axis=-1)
        return place + t * change(s)

    def change(s: np.ndarray) -> np.ndarray:
        return 0.1 * np.stack((np.sin(np.pi * s), np.sin(2 * np.pi * s)), axis=-1)

    def solve(t: float) -> gg.Result:
        nodes, at = base.copy(), np.linspace(0, 1, SHAPE[0])
        through = SlideCurve.of_points(curve(s, t)).point if points else lambda s: curve(s, t)
        nodes[1:-1, 0] = through(at)[1:-1]
        given: Any = curve(s, t) if points else lambda s: curve(s, t)
        if backwards:
            given = given[::-1] if points else lambda s: curve(1 - s, t)
        return gg.optimize(gg.Grid(nodes), "winslow", slide={"bottom": given}, **TIGHT)

    if points:
        along = change(s)[::-1] if backwards else change(s)
        return Case(solve, {"slide": {"bottom": along}}, lambda g: (g.slide["bottom"] * along).sum())
    turned = (lambda s: change(1 - s)) if backwards else change
    return Case(solve, {"slide": {"bottom": turned}}, lambda g: g.slide["bottom"].along(turned))


def walled(change: str) -> Case:
    """Return a case of walls beside sides that slide: of first heights and growth, or of the boundary."""
    base = start()
    first, along = 0.05 * (1 + 0.2 * _random(11).random(SHAPE[0])), 0.01 * _random(12).random(SHAPE[0])
    moved = 0.3 * boundary_change(base)
    data = change == "data"

    def solve(t: float) -> gg.Result:
        own = t if data else 0.0
        walls = {"bottom": gg.Wall(first + own * along, growth=1.1 + 0.05 * own, nodes=None), "top": gg.Wall(0.08)}
        grid = gg.Grid(base + (0.0 if data else t) * moved)
        return gg.optimize(grid, "winslow", walls=walls, slide=("left", "right"), **TIGHT)

    if not data:
        return Case(solve, {"boundary": moved}, lambda g: (g.boundary * moved).sum())
    return Case(
        solve,
        {"walls": {"bottom": {"first": along, "growth": 0.05}}},
        lambda g: (g.walls["bottom"].first * along).sum() + 0.05 * float(g.walls["bottom"].growth),
    )


# ---- several blocks ----


def sliding_blocks() -> Case:
    """Return a case of the boundary of two blocks, whose nodes slide from the one into the other."""
    base = start()
    moved, cut = 0.3 * boundary_change(base), 4

    def parts(nodes: np.ndarray) -> dict[str, np.ndarray]:
        return {"a": nodes[: cut + 1], "b": nodes[cut:]}

    def solve(t: float) -> gg.LayoutResult:
        grids = {name: gg.Grid(nodes) for name, nodes in parts(base + t * moved).items()}
        weight = gg.Weight("1 + 0.1*x", "differentiated")  # Blocks with a weight are not put together.
        return gg.optimize(gg.MultiBlock(grids, "auto"), "winslow", slide="all", weight=weight, **TIGHT)

    along = parts(moved)
    return Case(
        solve,
        {"boundary": along},
        lambda g: sum((g.boundary[name] * one).sum() for name, one in along.items()),
        step=5e-4,
    )


def sliding_blocks_curve() -> Case:
    """Return a case of the curve of one side of two blocks, a function."""
    base, cut = start(), 4

    def curve(s: np.ndarray, t: float) -> np.ndarray:
        place = np.stack(
            (-(1 + 0.1 * np.sin(3 * s)) * np.cos(1.2 * s), (1 + 0.1 * np.sin(3 * s)) * np.sin(1.2 * s)), -1
        )
        return place + t * change(s)

    def change(s: np.ndarray) -> np.ndarray:
        return 0.1 * np.stack((np.sin(np.pi * s), np.sin(2 * np.pi * s)), axis=-1)

    def solve(t: float) -> gg.LayoutResult:
        nodes = base.copy()
        nodes[1:-1, 0] = curve(np.linspace(0, 1, SHAPE[0]), t)[1:-1]
        blocks = {"a": gg.Grid(nodes[: cut + 1]), "b": gg.Grid(nodes[cut:])}
        named = {"floor": [("a", "bottom"), ("b", "bottom")]}
        layout = gg.MultiBlock(blocks, "auto", boundaries=named)
        return gg.optimize(layout, "winslow", slide={"floor": lambda s: curve(s, t)}, **TIGHT)

    return Case(solve, {"slide": {"floor": change}}, lambda g: g.slide["floor"].along(change))


def blocks(change: str) -> Case:
    """Return a case of a pipe of five blocks: its boundary, or the samples of a weight."""
    layout = gg.optimize(gg.layout("pipe", across=4, outwards=4), "winslow", **TIGHT).grid
    samples, along = 2 + 0.3 * _random(13).random((8, 7)), _random(14).standard_normal((8, 7))
    moved = {
        name: np.stack((np.sin(grid.x + grid.y), grid.x**2), axis=-1)
        for name, grid in zip(layout.names, layout.blocks, strict=True)
    }

    def solve(t: float) -> gg.LayoutResult:
        if change == "boundary":
            changes = [np.moveaxis(one, -1, 0) for one in moved.values()]
            places = [grid.planes + t * one for grid, one in zip(layout.blocks, changes, strict=True)]
            return gg.optimize(layout.moved(places), "winslow", **TIGHT)
        weight = gg.Weight.on_raster(*raster(), samples + t * along, "differentiated", outside="nearest")
        return gg.optimize(layout, "area_winslow", weight=weight, **TIGHT)

    if change == "boundary":
        return Case(solve, {"boundary": moved}, lambda g: sum((g.boundary[name] * moved[name]).sum() for name in moved))
    return Case(solve, {"weight": along}, lambda g: sum((one * along).sum() for one in g.weight.values()))
