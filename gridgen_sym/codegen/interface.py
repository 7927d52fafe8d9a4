"""The functions of a kernel: their names, the programs that they evaluate, and their arguments, in every language.

The first argument of each is a block: `ni` x `nj` nodes, the rows `row_begin` to `row_end` of them to work on (the
rows beside those are read), `stride` and `plane` (doubles from a row, and from a component, to the next),
`interior_only` (leave out corners at nodes of the block's edge), `threads`, and the steps `h_xi`, `h_eta` of the
logical coordinates from a node to the next. Coordinates, values and parameters follow. A function writes into arrays
that it is given, and only for its own rows.

An energy is h_xi h_eta times the sum over corners, of edge vectors over the steps; gradients and Hessians are its
derivatives in the coordinates. The smallest Jacobians are those of the edge vectors themselves.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Signature:
    """One function of a kernel.

    Attributes:
        program: what it evaluates; a kernel without that program has no such function.
        arguments: kinds of the arguments after the block: (a)rray, (i)nteger, (d)ouble.
    """

    program: str
    arguments: str


#: By name. Every list begins with coordinates (2, ni, nj), values (a `runtime.Values`; in C four addresses for each
#: plane) and parameters.
FUNCTIONS: Mapping[str, Signature] = {
    # row_energy, row_min_jacobian
    "energy": Signature("corner_energy", "aaaaa"),
    # row_energy, row_min_jacobian, gradient (2, ni, nj)
    "energy_gradient": Signature("corner_slopes", "aaaaaa"),
    # planes (19, ni, nj)
    "hessian": Signature("corner_hessian", "aaaa"),
    "semidefinite_hessian": Signature("corner_semidefinite", "aaaa"),
    # vector, product (2, ni, nj)
    "hessian_vector": Signature("corner_hessian_vector", "aaaaa"),
    "semidefinite_hessian_vector": Signature("corner_semidefinite_vector", "aaaaa"),
    # vector (2, ni, nj), mixed (planes and parameters, 4, ni-1, nj-1)
    "mixed": Signature("corner_mixed", "aaaaa"),
    # fixed, color, floor, reach, row_step
    "sweep": Signature("corner_hessian", "aaaaidda"),
    # residual (2, ni, nj); planes (36, ni, nj)
    "euler_lagrange_residual": Signature("residual", "aaaa"),
    "euler_lagrange_jacobian": Signature("residual_slopes", "aaaa"),
    "euler_lagrange_frozen_jacobian": Signature("residual_coefficients", "aaaa"),
    # fixed, color, relaxation
    "euler_lagrange_relaxation": Signature("residual_coefficients", "aaaaid"),
}
