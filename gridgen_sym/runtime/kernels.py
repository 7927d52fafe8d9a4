"""Find, load and bind the kernels of a functional: the way from its sources to a `KernelSet`."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

import numpy as np

from ..codegen.backend import Function, find_backend
from ..codegen.facts import KernelFacts
from ..errors import GridgenError
from ..functionals.definition import Functional
from ..functionals.variant import Modes, Variant
from .backend import choose_backend
from .kernel_set import KernelSet
from .sources import find_sources


def kernels(
    functional: Functional,
    variant: Variant = "plain",
    parameters: Mapping[str, float] | None = None,
    backend: str | None = None,
) -> KernelSet:
    """Return the kernels of a functional.

    Args:
        functional: what to evaluate.
        variant: how the weight, fields and a target enter, or `regularized` (then `parameters` must have `epsilon`).
        parameters: values of the functional's parameters; defaults for those left out.
        backend: `c`, `numpy` or the name of another; by default GRIDGEN_SYM_BACKEND, else C where there is a compiler.

    Raises:
        GridgenError: for unknown parameters or backends, or if the compiler rejects the kernels.
    """
    given, extra = parameters, []
    if Modes.read(variant).regularized:
        given = dict(parameters or {})
        if "epsilon" not in given:
            raise GridgenError(
                f"the regularized barrier of {functional.name!r} needs the parameter epsilon, a small Jacobian"
            )
        extra = [given.pop("epsilon")]
    values = np.array([*functional.values(given).values(), *extra], dtype=float)
    chosen = choose_backend(backend)
    facts, functions = _load(functional, variant, chosen.name)
    return KernelSet(
        functional=functional.name,
        variant=variant,
        backend=chosen.name,
        barrier=facts.barrier,
        equation_type=facts.equation_type,
        null_lagrangian=facts.null_lagrangian,
        polyconvex=facts.polyconvex,
        planes=facts.planes,
        moving=facts.moving,
        operations={name: sum(count.values()) for name, count in facts.operations.items()},
        _parameters=values,
        _functions=functions,
    )


@lru_cache(maxsize=128)
def _load(functional: Functional, variant: Variant, backend: str) -> tuple[KernelFacts, Mapping[str, Function]]:
    found = find_backend(backend)
    facts_path, source_path = find_sources(functional, variant, found)
    facts = KernelFacts.from_json(facts_path.read_text(encoding="utf-8"))
    return facts, found.load(facts, source_path.read_text(encoding="utf-8"))
