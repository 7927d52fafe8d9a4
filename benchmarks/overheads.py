"""What calls cost beside their kernels, before and now: Hessian, quality, gradient."""

from __future__ import annotations

from collections.abc import Callable

from measure import Table, fastest, start_grid

import gridgen_sym as gg
from gridgen_sym.runtime import kernels

_TEXT = (
    "Processor seconds, the least of several runs. The kernel is called alone in the same run, on the same grid; its "
    "result is new, as that of the call is. `before` was measured before calls were made faster, on the same machine."
)
_HEADER = ("call", "nodes", "before", "now", "wanted", "kernel", "now / kernel")


def run() -> Table:
    """Measure, and return the table."""
    table = Table("Calls beside their kernels", _TEXT, _HEADER)
    for name, size, before, wanted, call, kernel in _rows():
        now, alone = fastest(call, runs=7).cpu, fastest(kernel, runs=15).cpu
        table.add(name, f"{size}²", before, now, wanted or 4 * alone, alone, now / alone)
    return table


def _rows() -> list[tuple[str, int, float, float | None, Callable[[], object], Callable[[], object]]]:
    """Return name, size, the times before and wanted (None: 4 times the kernel), the call and its kernel."""
    large, small = start_grid("wavy", 1025), start_grid("wavy", 257)
    slopes = small.xy
    winslow = kernels(gg.functional("winslow"))
    return [
        ("gg.hessian", 1025, 4.3, None, lambda: gg.hessian(large, "winslow"),
         lambda: winslow.hessian(large.planes)),
        ("gg.quality, folded cells", 1025, 0.69, 0.05, lambda: gg.quality(large).folded_cells,
         lambda: winslow.energy(large.planes)),
        ("gg.quality, all measures", 1025, 0.69, 0.05, lambda: gg.quality(large).summary(),
         lambda: winslow.energy(large.planes)),
        ("gg.gradient", 257, 0.0026, 0.0007, lambda: gg.gradient(small, "winslow"),
         lambda: winslow.energy_gradient(small.planes)),
        ("gg.gradient, out=", 257, 0.0026, 0.0007, lambda: gg.gradient(small, "winslow", out=slopes),
         lambda: winslow.energy_gradient(small.planes)),
    ]  # fmt: skip


if __name__ == "__main__":
    print(run().markdown())
