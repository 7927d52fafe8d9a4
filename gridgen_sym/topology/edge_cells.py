"""How many cells every curve of a layout has: numbers are carried over to the opposite sides of blocks."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from ..errors import GridgenError


@dataclass(frozen=True, slots=True)
class EqualSides:
    """Two opposite sides of a block, or two periodic curves, which must have equally many cells.

    Attributes:
        where: what they belong to, such as `block a`.
        sides: what each of both is called, such as `bottom` and `top`.
        curves: the curves of both.
    """

    where: str
    sides: tuple[str, str]
    curves: tuple[tuple[str, ...], tuple[str, ...]]

    @property
    def balance(self) -> dict[str, int]:
        """How often each curve is in the first side, less how often it is in the second, where that is not 0."""
        count = Counter(self.curves[0])
        count.subtract(self.curves[1])
        return {curve: times for curve, times in count.items() if times}


def carried_over(given: Mapping[str, int], pairs: Sequence[EqualSides]) -> dict[str, int]:
    """Return the number of cells of every curve.

    Args:
        given: what is said of some curves.
        pairs: the opposite sides of all blocks, and periodic curves.

    Raises:
        GridgenError: for numbers that contradict each other, and curves whose numbers follow from none; the message
            names the curves.
    """
    known, origin = dict(given), {curve: {curve} for curve in given}
    waiting = list(pairs)
    while waiting:
        left = []
        for pair in waiting:
            balance = pair.balance
            unknown = [curve for curve in balance if curve not in known]
            if len(unknown) > 1:
                left.append(pair)
                continue
            rest = sum(times * known[curve] for curve, times in balance.items() if curve in known)
            sources = set().union(*(origin[curve] for curve in balance if curve in known))
            if unknown:
                cells, over = divmod(-rest, balance[unknown[0]])
                if over or cells < 1:
                    raise _contradiction(pair, known, sources)
                known[unknown[0]], origin[unknown[0]] = cells, sources
            elif rest:
                raise _contradiction(pair, known, sources)
        if len(left) == len(waiting):
            raise _missing({curve for pair in left for curve in pair.balance if curve not in known})
        waiting = left
    curves = {curve for pair in pairs for side in pair.curves for curve in side}
    if curves - known.keys():  # They are opposite themselves, as the cut of an O-grid.
        raise _missing(curves - known.keys())
    return known


def _contradiction(pair: EqualSides, known: Mapping[str, int], sources: set[str]) -> GridgenError:
    sides = " and ".join(
        f"{side} ({' + '.join(f'{curve}: {known[curve]}' if curve in known else curve for curve in curves)})"
        for side, curves in zip(pair.sides, pair.curves, strict=True)
    )
    return GridgenError(
        f"opposite sides have equally many cells, but those of {pair.where} cannot: {sides}. These numbers "
        f"follow from what cells says of {', '.join(sorted(sources))}: change one of them, or leave it out"
    )


def _missing(curves: set[str]) -> GridgenError:
    names = sorted(curves)
    return GridgenError(
        f"no number of cells follows for {', '.join(names)}: cells must name one of every family of opposite curves, "
        f"for example {names[0]} = 16"
    )
