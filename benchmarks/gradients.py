"""The gradient of a grid: its processor time, over that of the solve in the same run, and its growth with parameters.

    python benchmarks/gradients.py [NODES]

Prints a row for each case of NODES x NODES nodes (512 by default): the time of `optimize`, that of `vjp` with the
gradient in the boundary and all further data, as a part of it, and that with 50 shape parameters over that with one.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator

import numpy as np

import gridgen_sym as gg


def cases(count: int) -> Iterator[tuple[str, Callable[[], gg.Result]]]:
    """Yield names, and what solves for grids of so many nodes along each side."""
    wavy, swan = gg.domain("wavy", count, count), gg.domain("swan", count, count)
    yield "wavy, winslow", lambda: gg.optimize(wavy, "winslow")
    yield "swan, winslow", lambda: gg.optimize(swan, "winslow")
    yield "wavy, all sides slide", lambda: gg.optimize(wavy, "winslow", slide="all")
    weight = gg.Weight("1 + 5*exp(-50*(x - 0.5)**2)", "differentiated")
    yield "wavy, weight", lambda: gg.optimize(wavy, "winslow", weight=weight)
    walls = {"bottom": gg.Wall(0.1 / count), "top": gg.Wall(0.1 / count)}
    yield "wavy, two walls", lambda: gg.optimize(wavy, "winslow", walls=walls)
    yield "wavy, two walls, two sides slide", lambda: gg.optimize(wavy, "winslow", walls=walls, slide=("left", "right"))


def timed(work: Callable[[], object]) -> tuple[float, object]:
    """Return the processor time of some work, and its result."""
    begin = time.process_time()
    result = work()
    return time.process_time() - begin, result


def everything(result: gg.Result, cotangent: np.ndarray, shapes: np.ndarray) -> object:
    """Return the gradient in shape parameters, of which the displacements (m, ni, nj, 2) are given, and in all else."""
    gradients = result.vjp(cotangent)
    boundary = gradients.boundary
    return [(boundary * shape).sum() for shape in shapes], gradients.weight, gradients.walls


def main() -> None:
    """Measure and print."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 512
    random = np.random.default_rng(0)
    for _, solve in cases(33):  # Compiles all kernels.
        everything(solve(), np.ones((33, 33, 2)), np.ones((1, 33, 33, 2)))
    print("| case | optimize, s | vjp, s | part | 50 parameters over one |\n| --- | --- | --- | --- | --- |")
    for name, solve in cases(count):
        seconds, result = timed(solve)
        x, y = result.grid.x, result.grid.y
        cotangent = np.stack((np.sin(3 * x + y), x * y), axis=-1)
        shapes = random.standard_normal((50, 1, 1, 2)) * np.cos(np.arange(50.0))[:, None, None, None]
        shapes = np.broadcast_to(shapes, (50, count, count, 2))
        one = timed(lambda result=result, c=cotangent, s=shapes[:1]: everything(result, c, s))[0]
        many = timed(lambda result=result, c=cotangent, s=shapes: everything(result, c, s))[0]
        print(f"| {name} | {seconds:.2f} | {one:.2f} | {100 * one / seconds:.0f} % | {many / one:.2f} |", flush=True)


if __name__ == "__main__":
    main()
