"""What follows for a user from the derived properties of a functional."""

from __future__ import annotations

from collections.abc import Iterator

from ..symbolic import Classification
from ..symbolic.coordinates import s


def consequences(found: Classification) -> Iterator[str]:
    """Yield sentences in Markdown; none of them looks at the functional's name."""
    if found.null_lagrangian:
        yield "It is a null Lagrangian: its energy depends on the boundary alone, and it moves no node. Combine it."
        return
    yield _barrier(found)
    yield _type(found)
    if found.kinks:
        yield "Its first derivatives jump on some valid grids: a minimum may sit in a kink, where no equations hold."
    if found.linear:
        yield "Its equations are linear: one Newton step solves them."
    if found.scaling_degree == 0:
        yield "It depends on the shape of a cell only, not on its size: the unit of length does not matter."
    if not found.rotation:
        yield "It is not invariant under rotation: a rotated domain does not give the rotated grid."
    if not found.exchange:
        yield "It treats the two families of grid lines differently: exchanging xi and eta changes the result."
    if not found.polyconvex.holds:
        yield (
            "It is not polyconvex: where its Hessian is not positive, Newton's method shifts it just enough, and there "
            "may be more than one minimum."
        )
    if found.lower_bound.value is None:
        yield "No lower bound of its density is known: watch the energy, and do not expect a minimum on every domain."
    if found.functional.expression().has(s):
        yield "Its density names the weight `s`: it is made to adapt."


def _barrier(found: Classification) -> str:
    if found.barrier:
        return (
            "It has a barrier: its energy is infinite where a cell's Jacobian is zero. A valid grid stays valid, and a "
            "folded start is untangled first."
        )
    return (
        "It has no barrier: nothing in it keeps cells from folding. From a valid start the solvers stop before a cell "
        "folds, and say so; look at `folded_cells` of every result."
    )


def _type(found: Classification) -> str:
    match found.ellipticity.type:
        case "elliptic":
            known = "proved" if found.ellipticity.proof == "proved" else "at every one of the jets that were tried"
            return f"Its equations are elliptic ({known}): kinks of the boundary are smoothed inside the domain."
        case "weakly elliptic":
            return "Its equations are weakly elliptic: kinks of the boundary may run along lines into the domain."
        case "degenerate":
            return (
                "Its equations are degenerate: the boundary does not determine the grid. Many grids have the same "
                "energy, and the start decides which one is found."
            )
        case _:
            return (
                "Its equations change type: lines may kink or crowd, more than one minimum is common, and Newton's "
                "method may need many steps."
            )
