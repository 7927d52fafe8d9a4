"""How the names beside the metric enter a kernel: which values move with the nodes, a target, a regularized barrier.

A variant is written as text, whose parts are joined by `+`: `plain` where nothing is said; else, in this order,

- `frozen` or `differentiated`: there is a weight, held at the nodes or differentiated through;
- `M:differentiated`: the declared field M moves with the nodes (else its values are held);
- `target`: the metric is taken relative to a target;
- `control`: the Euler-Lagrange equations have control functions;
- `mixed`: instead of what solvers need, the mixed derivatives, in the nodes and in values and parameters;
- `regularized`: J, or det T relative to a target, is replaced by chi(J) = (J + sqrt(J² + epsilon²))/2; a weight and
  moving fields are not combined with it.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal, TypeAlias

from ..errors import GridgenError, quoted

Variant: TypeAlias = str

_WEIGHTED: tuple[Literal["frozen", "differentiated"], ...] = ("frozen", "differentiated")
_MOVES = ":differentiated"
_NOT_IN_NAMES = re.compile(r"[^A-Za-z0-9_]")


@dataclass(frozen=True, slots=True)
class Modes:
    """What a variant says.

    Attributes:
        weight: how the weight enters; empty where there is none.
        differentiated: names of the declared fields that move with the nodes, in alphabetical order.
        target: whether the metric is taken relative to a target.
        control: whether the equations have control functions.
        mixed: whether it is of the mixed derivatives.
        regularized: whether the barrier is regularized.
    """

    weight: Literal["", "frozen", "differentiated"] = ""
    differentiated: tuple[str, ...] = ()
    target: bool = False
    control: bool = False
    mixed: bool = False
    regularized: bool = False

    @classmethod
    def read(cls, variant: Variant) -> Modes:
        """Return what a variant says.

        Raises:
            GridgenError: for what is no variant.
        """
        modes = cls._of([part for part in variant.split("+") if part != "plain"])
        alone = modes.weight or modes.differentiated or modes.control or modes.mixed
        if modes.variant != variant or (modes.regularized and alone) or (modes.mixed and modes.control):
            raise GridgenError(
                f"unknown variant {quoted(variant)}: it is 'plain', 'regularized', 'target+regularized', or of "
                "'frozen' or 'differentiated' (the weight), 'M:differentiated' (a field), 'target', and 'control' or "
                "'mixed', in this order, joined by '+'"
            )
        return modes

    @classmethod
    def ordered(cls, text: str) -> Modes:
        """Return what a variant says whose parts a user has written in any order.

        Raises:
            GridgenError: for what is no variant.
        """
        parts = [part.strip() for part in text.split("+")]
        variant = cls._of(parts).variant
        return cls.read(variant if sorted(parts) == sorted(variant.split("+")) else text)

    @classmethod
    def _of(cls, parts: list[str]) -> Modes:
        weight: Literal["", "frozen", "differentiated"] = next((mode for mode in _WEIGHTED if mode in parts), "")
        moving = tuple(sorted(part.removesuffix(_MOVES) for part in parts if part.endswith(_MOVES)))
        return cls(weight, moving, *(part in parts for part in ("target", "control", "mixed", "regularized")))

    @property
    def variant(self) -> Variant:
        """The text."""
        parts = [
            *([self.weight] if self.weight else []),
            *(f"{name}{_MOVES}" for name in self.differentiated),
            *(["target"] if self.target else []),
            *(["control"] if self.control else []),
            *(["mixed"] if self.mixed else []),
            *(["regularized"] if self.regularized else []),
        ]
        return "+".join(parts) or "plain"


def kernel_name(functional: str, variant: Variant) -> str:
    """Return the name of the kernel of a functional in one variant: its files, and the prefix of its functions."""
    return functional if variant == "plain" else f"{functional}_{_NOT_IN_NAMES.sub('_', variant)}"
