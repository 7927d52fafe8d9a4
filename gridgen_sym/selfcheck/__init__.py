"""Check the derivatives, equations and kernels of one functional, with the weight 1 and smooth fields, against others.

Corner derivatives and Euler–Lagrange equations against differences of the bare formula in 80-digit arithmetic; the
compiled kernels against NumPy's; the Hessian kernel against differences of the gradient kernel; and the discrete
gradient against the Euler–Lagrange residual, to which it must tend at second order.
"""

from __future__ import annotations

from collections.abc import Iterator

from ..functionals import Functional
from .check import Check as Check
from .digits import corner_derivatives, equations
from .kernels import backends, hessian_kernel
from .limit import convergence
from .setting import variants


def checks(functional: Functional) -> Iterator[Check]:
    """Yield the checks of a functional one by one, as they are done: with fields held, and with fields that move."""
    for variant in variants(functional):
        yield from corner_derivatives(functional, variant)
        yield equations(functional, variant)
        yield hessian_kernel(functional, variant)
        yield backends(functional, variant)
        yield convergence(functional, variant)
