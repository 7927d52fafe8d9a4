"""What all benchmarks share: the clock, the number of threads, tables, plots, and the facts of the machine."""

from __future__ import annotations

import math
import os
import platform
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib import metadata
from pathlib import Path

import gridgen_sym as gg
from gridgen_sym.runtime import find_compiler

FOLDER = Path(__file__).resolve().parent
OUTLINES = FOLDER.parent / "examples" / "outlines"
#: Colors that remain distinct for color-blind readers.
#: The styles of series: each has its own color and its own marker.
STYLES = (
    ("#0072B2", "o"), ("#D55E00", "s"), ("#009E73", "D"), ("#CC79A7", "^"), ("#56B4E9", "v"), ("#E69F00", "P"),
    ("#000000", "*"), ("#8C8C8C", "X"), ("#7B3F00", "h"), ("#882255", "<"),
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Timing:
    """The fastest of several runs: wall seconds, and processor seconds of the whole process, each the smallest."""

    wall: float
    cpu: float


def fastest(call: Callable[[], object], *, runs: int = 5, seconds: float = 0.3) -> Timing:
    """Run at least once, then until `runs` runs or, if that is later, `seconds` are over; keep the minima."""
    best_wall = best_cpu = float("inf")
    begin, done = time.perf_counter(), 0
    while done == 0 or done < runs or time.perf_counter() - begin < seconds:
        wall, cpu = time.perf_counter(), time.process_time()
        call()
        best_wall, best_cpu = min(best_wall, time.perf_counter() - wall), min(best_cpu, time.process_time() - cpu)
        done += 1
    return Timing(best_wall, best_cpu)


@contextmanager
def threads(count: int) -> Iterator[None]:
    """Let gridgen_sym use this many threads."""
    before = os.environ.get("OMP_NUM_THREADS")
    os.environ["OMP_NUM_THREADS"] = str(count)
    try:
        yield
    finally:
        if before is None:
            del os.environ["OMP_NUM_THREADS"]
        else:
            os.environ["OMP_NUM_THREADS"] = before


def start_grid(name: str, size: int) -> gg.Grid:
    """Return the transfinite grid of a classical domain or of an outline in examples/outlines, size x size nodes."""
    outline = OUTLINES / f"{name}.csv"
    return gg.Outline.read(outline).grid(size, size) if outline.exists() else gg.domain(name, size, size)


@dataclass(slots=True)
class Table:
    """A table of the report.

    Attributes:
        title: its heading.
        text: what is measured, and how to read it.
        header: names of the columns.
        rows: the cells, as text.
        notes: what must be said of the rows, one line each.
    """

    title: str
    text: str
    header: Sequence[str]
    rows: list[Sequence[str]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def add(self, *cells: object) -> None:
        """Add a row, and print it, so that a long run shows what it does."""
        row = [number(cell) if isinstance(cell, float) else str(cell) for cell in cells]
        self.rows.append(row)
        print(" | ".join(row), flush=True)

    def note(self, text: str) -> None:
        """Add a note."""
        self.notes.append(text)
        print(text, flush=True)

    def markdown(self) -> str:
        """Return the table in Markdown."""
        lines = [f"### {self.title}", "", self.text, ""]
        lines += [f"| {' | '.join(self.header)} |", f"|{' --- |' * len(self.header)}"]
        lines += [f"| {' | '.join(row)} |" for row in self.rows]
        if self.notes:
            lines += ["", *(f"* {note}" for note in self.notes)]
        return "\n".join(lines) + "\n"


def number(value: float) -> str:
    """Return three significant digits, without an exponent where that is readable."""
    if not 1e-3 <= abs(value) < 1e6:
        return f"{value:.2e}" if value else "0"
    return f"{value:.0f}" if abs(value) >= 100 else f"{value:#.3g}".rstrip(".")


def machine() -> list[str]:
    """Return the facts that a reader needs, one line each: nothing that names this machine or its folders."""
    compiler = find_compiler()
    names = ("numpy", "scipy", "numba", "mfem")
    versions = ", ".join(f"{name} {version}" for name in names if (version := _version(name)))
    return [
        f"processor: {_processor()}, {os.cpu_count()} logical processors, vectors: {_vectors()}",
        f"system: {platform.system()} {platform.machine()}, Python {platform.python_version()}, {versions}",
        f"compiler: {compiler.version if compiler else 'none'}, OpenMP: {bool(compiler and compiler.openmp)}",
    ]


def _version(name: str) -> str:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return ""


def _information(key: str) -> str:
    path = Path("/proc/cpuinfo")
    lines = path.read_text().splitlines() if path.exists() else []
    return next((line.partition(":")[2].strip() for line in lines if line.startswith(key)), "")


def _processor() -> str:
    return _information("model name") or platform.processor() or platform.machine()


def _vectors() -> str:
    flags = _information("flags").split()
    return next((name for name in ("avx512f", "avx2", "avx", "sse2") if name in flags), "unknown")


Series = Mapping[str, tuple[Sequence[float], Sequence[float]]]


def plot(path: Path, panels: Sequence[tuple[str, Series]], xlabel: str, ylabel: str) -> None:
    """Draw log-log panels side by side, (title, series by name) each, with a common vertical axis."""
    import matplotlib as mpl

    mpl.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(
        1, len(panels), figsize=(5.2 * len(panels), 4.8), sharey=True, squeeze=False, layout="constrained"
    )
    for axis, (title, series) in zip(axes[0], panels, strict=True):
        # Too many series are an error: two of one color could not be distinguished.
        for (name, (x, y)), (color, marker) in zip(series.items(), STYLES[: len(series)], strict=True):
            axis.loglog(x, y, label=name, markersize=5, linewidth=1.5, color=color, marker=marker)
        axis.set(title=title, xlabel=xlabel)
        axis.grid(True, which="major", color="0.88")
        sizes = sorted({value for x, _ in series.values() for value in x})
        axis.set_xticks(sizes, [f"{math.isqrt(int(value))}²" for value in sizes])
        axis.minorticks_off()
        axis.legend(fontsize=8, frameon=False, loc="upper center", bbox_to_anchor=(0.5, -0.16), ncols=2)
    axes[0][0].set_ylabel(ylabel)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=120, metadata={"Software": None})
    pyplot.close(figure)
