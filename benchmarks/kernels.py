"""Rates of the generated kernels, against the limits of the machine and against kernels written by hand."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterator
from dataclasses import astuple, dataclass
from pathlib import Path

import numpy as np
from limits import Handwritten, Limits, measure_limits
from measure import STYLES, Table, fastest, start_grid, threads

import gridgen_sym as gg
from gridgen_sym.arrays import Array
from gridgen_sym.codegen.backend import find_backend
from gridgen_sym.codegen.facts import KernelFacts
from gridgen_sym.runtime import KernelSet, kernels
from gridgen_sym.runtime.sources import find_sources

Rates = dict[tuple[str, str, int], float]

HAND = "winslow by hand"
_HEADER = ("functional", "kernel", "Mnodes/s, 1 thread", "2 threads", "GFlop/s, 1 thread", "2 threads",
           "fraction of the limit, 1 thread", "2 threads", "set by")  # fmt: skip


@dataclass(frozen=True, slots=True)
class Work:
    """What a kernel does at a node: evaluations of derived programs, and bytes to and from memory."""

    programs: tuple[tuple[str, int], ...]
    bytes: int


#: Bytes: coordinates are read once, results are written and, before that, read by the processor.
_WORK = {
    "energy": Work((("corner_energy", 4),), 16),
    "energy + gradient": Work((("corner_slopes", 4),), 16 + 2 * 16),
    "Hessian": Work((("corner_hessian", 4),), 16 + 2 * 152),
    "semidefinite Hessian": Work((("corner_semidefinite", 4),), 16 + 2 * 152),
    "Hessian times vector": Work((("corner_hessian_vector", 4),), 2 * 16 + 2 * 16),
    "Euler–Lagrange residual": Work((("residual", 1),), 16 + 2 * 16),
    "Euler–Lagrange Jacobian": Work((("residual_slopes", 1),), 16 + 2 * 288),
    "relaxation sweep": Work((("residual_coefficients", 1),), 2 * 16 + 1),
    "local sweep": Work((("corner_hessian", 12), ("corner_energy", 24)), 2 * 16 + 1),
}


def calls(kernel_set: KernelSet, coordinates: Array) -> dict[str, Callable[[], object]]:
    """Return one call of every kernel of a set, with preallocated results."""
    _, ni, nj = coordinates.shape
    # Written once here: the first write to new memory costs more than any kernel.
    gradient, planes, jacobian = (np.full((count, ni, nj), 0.0) for count in (2, 19, 36))
    spacing, fixed = (1 / (ni - 1), 1 / (nj - 1)), np.zeros((ni, nj), dtype=np.uint8)
    fixed[0], fixed[-1], fixed[:, 0], fixed[:, -1] = 1, 1, 1, 1
    moved = coordinates.copy()

    def relax() -> None:
        for color in range(4):
            kernel_set.euler_lagrange_relaxation(moved, None, fixed, color, 0.0, spacing)

    def sweep() -> None:
        for color in range(4):
            kernel_set.sweep(moved, None, fixed, color, floor=0.0)

    found: dict[str, Callable[[], object]] = {
        "energy": lambda: kernel_set.energy(coordinates),
        "energy + gradient": lambda: kernel_set.energy_gradient(coordinates, out=gradient),
        "Hessian": lambda: kernel_set.hessian(coordinates, out=planes),
        "semidefinite Hessian": lambda: kernel_set.hessian(coordinates, semidefinite=True, out=planes),
        "Hessian times vector": lambda: kernel_set.hessian_vector(coordinates, coordinates, out=gradient),
        "Euler–Lagrange residual": lambda: kernel_set.euler_lagrange_residual(coordinates, None, spacing, out=gradient),
        "Euler–Lagrange Jacobian": lambda: kernel_set.euler_lagrange_jacobian(coordinates, None, spacing, out=jacobian),
        "relaxation sweep": relax,
        "local sweep": sweep,
    }
    return found


def divisions_of(functional: gg.Functional) -> dict[str, int]:
    """Return the number of divisions of each derived program, from the facts of the kernel."""
    facts = KernelFacts.from_json(find_sources(functional, "plain", find_backend("c"))[0].read_text(encoding="utf-8"))
    return {name: count["divisions"] for name, count in facts.operations.items()}


def bound(work: Work, kernel_set: KernelSet, divisions: dict[str, int], limits: Limits) -> tuple[float, str]:
    """Return the nodes per second that the machine allows at most, and which limit says so."""
    operations = sum(kernel_set.operations[name] * times for name, times in work.programs)
    divided = sum(divisions[name] * times for name, times in work.programs)
    return min(
        (limits.bandwidth / work.bytes, "memory"),
        (limits.multiply_adds / max(operations, 1), "arithmetic"),
        (limits.divisions / max(divided, 1), "divisions"),
    )


def run(quick: bool, picture: Path | None = None) -> list[Table]:
    """Measure, and return the tables: the limits, then the rates at each size."""
    found: dict[int, Limits] = {}
    tables = []
    for size in (1024,) if quick else (1024, 256):
        rates = _rates(size, 3 if quick else 6, found)
        tables.append(_table(size, rates, found))
        if picture and size == 1024:
            _roofline(picture, rates, found)
    table = Table("Limits of the machine", "Measured between the kernels, the best of all passes.", _LIMITS)
    for count, limits in found.items():
        table.add(count, *(value / 1e9 for value in astuple(limits)))
    return [table, *tables]


_LIMITS = ("threads", "triad GB/s", "GFlop/s", "Gdiv/s")
_TEXT = (
    "The fastest of several runs on `wavy`, with preallocated results. Operations are those of the derived arithmetic "
    "(`KernelSet.operations`) without edges and sums; bytes are the least that must move, writes counted twice. The "
    "limit is the lowest of memory, arithmetic and divisions; grids that fit into the cache may exceed that of memory."
)


def _rates(size: int, passes: int, limits: dict[int, Limits]) -> Rates:
    """Return nodes per second by functional, kernel and threads, and put the limits into `limits`.

    Both are the best of passes that are spread over time: others may have the processor for a while.
    """
    coordinates = np.ascontiguousarray(start_grid("wavy", size).planes)
    rates: Rates = {}
    for _ in range(passes):
        for count in (1, 2):
            again = astuple(measure_limits(count))
            limits[count] = Limits(*map(max, again, astuple(limits[count]) if count in limits else again))
            with threads(count):
                for name, found in _all_calls(coordinates, count):
                    for kernel, call in found.items():
                        rate = size * size / fastest(call, runs=2, seconds=0.1).wall
                        rates[name, kernel, count] = max(rate, rates.get((name, kernel, count), 0.0))
    return rates


def _all_calls(coordinates: Array, count: int) -> Iterator[tuple[str, dict[str, Callable[[], object]]]]:
    """Yield (functional, calls by kernel), the kernels by hand first, after a check that they agree."""
    hand, reference = Handwritten(coordinates, count), kernels(gg.functional("winslow"))
    energy, _, gradient = reference.energy_gradient(coordinates)
    assert abs(hand.energy_gradient() - energy) < 1e-11 * abs(energy)
    assert np.abs(hand.gradient - gradient).max() < 1e-10 * np.abs(gradient).max()
    hand.hessian_vector()
    product = reference.hessian_vector(coordinates, coordinates)
    assert np.abs(hand.product - product).max() < 1e-10 * np.abs(product).max()
    yield (
        HAND,
        {
            "energy": hand.energy,
            "energy + gradient": hand.energy_gradient,
            "Hessian times vector": hand.hessian_vector,
        },
    )
    for name in sorted(gg.functionals(literature=False)):
        yield name, calls(kernels(gg.functional(name)), coordinates)


def _table(size: int, rates: Rates, limits: dict[int, Limits]) -> Table:
    table = Table(f"Kernels at {size} x {size} nodes", _TEXT, _HEADER)
    for name, kernel, count in rates:
        if count == 1:
            functional = gg.functional("winslow" if name == HAND else name)
            kernel_set, divisions, work = kernels(functional), divisions_of(functional), _WORK[kernel]
            pair = [rates[name, kernel, of] for of in (1, 2)]
            flops = sum(kernel_set.operations[program] * times for program, times in work.programs)
            bounds = [bound(work, kernel_set, divisions, limits[of]) for of in (1, 2)]
            table.add(name, kernel, pair[0] / 1e6, pair[1] / 1e6, flops * pair[0] / 1e9, flops * pair[1] / 1e9,
                      *(f"{rate / most:.2f}" for rate, (most, _) in zip(pair, bounds, strict=True)),
                      bounds[0][1])  # fmt: skip
    return table


def _roofline(path: Path, rates: Rates, limits: dict[int, Limits]) -> None:
    """Draw the rates of the Winslow kernels under the roof of memory and arithmetic."""
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(1, 2, figsize=(10.4, 4.2), sharey=True, layout="constrained")
    intensity = np.geomspace(0.05, 100, 200)
    for axis, (count, limit) in zip(axes, limits.items(), strict=True):
        roof = np.minimum(intensity * limit.bandwidth, limit.multiply_adds) / 1e9
        axis.loglog(intensity, roof, color="0.3", label="memory and multiply-adds")
        operations = kernels(gg.functional("winslow")).operations
        for (kernel, work), (color, marker) in zip(_WORK.items(), STYLES[: len(_WORK)], strict=True):
            flops = sum(operations[program] * times for program, times in work.programs)
            rate = flops * rates["winslow", kernel, count] / 1e9
            axis.loglog([flops / work.bytes], [rate], marker, color=color, label=kernel)
        axis.set(title=f"winslow, 1024 x 1024, {count} thread{'s' * (count > 1)}", xlabel="operations per byte")
        axis.grid(True, color="0.88")
    axes[0].set_ylabel("GFlop/s")
    axes[1].legend(fontsize=7, frameon=False)
    figure.savefig(path, dpi=120, metadata={"Software": None})
    pyplot.close(figure)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="1024 x 1024 only, fewer runs")
    for result in run(parser.parse_args().quick):
        print(result.markdown())
