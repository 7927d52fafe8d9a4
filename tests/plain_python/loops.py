"""Loops over cells and nodes. Derivatives in edge vectors go to nodes through INCIDENCE; nothing is shared or fast."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from types import SimpleNamespace
from typing import Any

Corner = tuple[tuple[int, int], tuple[int, int], tuple[int, int], int, int]
#: Planes of the stored block of a node with that so many nodes farther along i and j, by the components of both.
BLOCKS = {
    (0, 0): {(0, 0): 0, (0, 1): 1, (1, 1): 2},
    **{
        step: {(p, q): first + 2 * p + q for p in range(2) for q in range(2)}
        for step, first in (((1, 0), 3), ((0, 1), 7), ((1, 1), 11), ((1, -1), 15))
    },
}


def bind(facts: Any, source: str) -> Mapping[str, Callable[..., None]]:
    """Return the functions that there are for these facts: no clamped eigenvalues, and no values that move."""
    if facts.moving:
        return {}
    names: dict[str, Any] = {}
    exec(source, names)
    arithmetic = SimpleNamespace(**{name: value for name, value in names.items() if not name.startswith("__")})
    found = {
        "energy": partial(energy, arithmetic.corner_energy),
        "energy_gradient": partial(energy_gradient, arithmetic.corner_hessian),
        "hessian": partial(hessian, arithmetic.corner_hessian),
    }
    return found | (
        {"semidefinite_hessian": partial(hessian, arithmetic.corner_semidefinite)} if facts.polyconvex else {}
    )


def corners(block: Any) -> Iterator[Corner]:
    """Yield for each corner of each cell its node, its neighbors along xi and eta, and the signs of its two edges."""
    for i in range(block.row_begin, min(block.row_end, block.ni - 1)):
        for j in range(block.nj - 1):
            for p, q in ((0, 0), (1, 0), (0, 1), (1, 1)):
                yield (i + p, j + q), (i + 1 - p, j + q), (i + p, j + 1 - q), 1 - 2 * p, 1 - 2 * q


def counts(block: Any, node: tuple[int, int]) -> bool:
    """Return whether the corners at a node count."""
    inside = 0 < node[0] < block.ni - 1 and 0 < node[1] < block.nj - 1
    return inside or not block.interior_only


def evaluate(
    program: Callable[..., dict[str, float]], block: Any, corner: Corner, xy: Any, values: Any, parameters: Any
) -> Any:
    """Return the results of a program at a corner, in its edges; not a number where Python raises an error."""
    node, along_xi, along_eta, sign_xi, sign_eta = corner
    steps = block.h_xi, block.h_xi, block.h_eta, block.h_eta
    a = [sign_xi * float(xy[c][along_xi] - xy[c][node]) for c in range(2)]
    b = [sign_eta * float(xy[c][along_eta] - xy[c][node]) for c in range(2)]
    p, q = (1 - sign_xi) // 2, (1 - sign_eta) // 2
    planes = [float(plane[p + 2 * q][node[0] - p, node[1] - q]) for plane in values.corners]
    edges = [entry / step for entry, step in zip((*a, *b), steps, strict=True)]
    try:
        found = program(*edges, *planes, [float(value) for value in parameters])
    except (ArithmeticError, ValueError):
        names = [f"d{k}" for k in range(4)] + [f"h{p}{q}" for p in range(4) for q in range(p, 4)]
        found = dict.fromkeys(["energy", *names], math.nan)
    # Each digit of a name is a component of an edge vector that was divided by its step.
    over = {name: math.prod(steps[int(k)] for k in name if k.isdigit()) for name in found}
    found = {name: block.h_xi * block.h_eta * value / over[name] for name, value in found.items()}
    return found | {"jacobian": a[0] * b[1] - a[1] * b[0]}


def incidence(corner: Corner) -> Sequence[tuple[tuple[int, int], int, int]]:
    """Return (node, first of its two components among the four of the edge vectors, sign with which it enters)."""
    node, along_xi, along_eta, sign_xi, sign_eta = corner
    return ((along_xi, 0, sign_xi), (node, 0, -sign_xi), (along_eta, 2, sign_eta), (node, 2, -sign_eta))


def energy(program: Any, block: Any, xy: Any, values: Any, parameters: Any, row_energy: Any, row_least: Any) -> None:
    """Sum the energies of each row of cells, and find its smallest Jacobian."""
    row_energy[:], row_least[:] = 0.0, math.inf
    for number, corner in enumerate(corners(block)):
        row = block.row_begin + number // (4 * (block.nj - 1))
        found = evaluate(program, block, corner, xy, values, parameters)
        row_energy[row] += found["energy"] if counts(block, corner[0]) else 0.0
        row_least[row] = min(row_least[row], found["jacobian"])


def energy_gradient(
    program: Any,
    block: Any,
    xy: Any,
    values: Any,
    parameters: Any,
    row_energy: Any,
    row_least: Any,
    gradient: Any,
) -> None:
    """Add the gradient in all nodes."""
    energy(program, block, xy, values, parameters, row_energy, row_least)
    gradient[:] = 0.0
    for corner in corners(block):
        if counts(block, corner[0]):
            found = evaluate(program, block, corner, xy, values, parameters)
            for node, first, sign in incidence(corner):
                for c in range(2):
                    gradient[c][node] += sign * found[f"d{first + c}"]


def hessian(program: Any, block: Any, xy: Any, values: Any, parameters: Any, planes: Any) -> None:
    """Add the blocks of each pair of nodes; of two that are each other's transpose, one is stored."""
    planes[:] = 0.0
    for corner in corners(block):
        if counts(block, corner[0]):
            found = evaluate(program, block, corner, xy, values, parameters)
            for one, first, sign in incidence(corner):
                for other, second, its in incidence(corner):
                    place = BLOCKS.get((other[0] - one[0], other[1] - one[1]), {})
                    for (p, q), plane in place.items():
                        low, high = sorted((first + p, second + q))
                        planes[plane][one] += sign * its * found[f"h{low}{high}"]
