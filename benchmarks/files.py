"""Write and read a large grid in every format: speed against NumPy's own files, and memory.

    python benchmarks/files.py [--nodes 2048] [FORMAT ...]

Binary formats are compared with `numpy.save` to the same disk, flushed as our own files are, in bytes a second; texts
with the numbers that `numpy.savetxt` writes in a second. Memory is the peak of a process of its own above that of the
import, in copies of the coordinates: the grid itself is one of them. Times are the best of three runs, of binary
formats elapsed seconds, to the disk and back, of texts processor seconds.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import gridgen_sym as gg
from gridgen_sym.io import known_formats

RUNS = 3
#: Rows that savetxt writes: its speed does not depend on their number.
SAMPLE = 200_000
HEAD = ("format", "write, s", "of NumPy's speed", "copies", "read, s", "of NumPy's speed", "copies")


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--nodes", type=int, default=2048, help="along each side")
    parser.add_argument("--peak", nargs=3, metavar=("ACTION", "FORM", "FILE"), help=argparse.SUPPRESS)
    parser.add_argument("formats", nargs="*", metavar="FORMAT")
    given = parser.parse_args()
    if given.peak:
        print(peak(*given.peak, given.nodes))
        return
    with tempfile.TemporaryDirectory(dir=".") as folder:
        table(given.nodes, given.formats, Path(folder))


def table(nodes: int, formats: list[str], folder: Path) -> None:
    """Print a row for each format, and each of its forms that are not text."""
    grid = large_grid(nodes)
    size = grid.planes.nbytes
    save = numpy_binary(grid, folder)
    savetxt = numpy_text(grid, folder)
    speeds = f"numpy.save {size / save / 1e6:.0f} MB/s, savetxt {savetxt / 1e6:.2f} million numbers/s"
    print(f"{nodes} x {nodes} nodes: {speeds}\n")
    print(f"| {' | '.join(HEAD)} |\n|{' --- |' * len(HEAD)}")
    for name, form in known_formats().items():
        words = ("", *(word for word in ("binary", "fortran") if word in form.forms))
        for word in words if not formats or name in formats else ():
            title, path = f"{name} {word}".strip(), folder / f"grid{form.suffixes[0]}"
            binary = form.binary or bool(word)
            clock = time.perf_counter if binary else time.process_time
            row = [title]
            for action in ("write", "read")[: 2 if form.decode else 1]:
                seconds = least(lambda action=action, title=title, path=path: act(action, title, path, grid), clock)
                ratio = bytes_of(path) / size * save / seconds if binary else numbers_in(path, grid) / seconds / savetxt
                row += [f"{seconds:.2f}", f"{ratio:.2f}", f"{copies(action, title, path, nodes, size):.1f}"]
            print(f"| {' | '.join(row + [''] * (len(HEAD) - len(row)))} |", flush=True)


def act(action: str, title: str, path: Path, grid: gg.Grid | None) -> None:
    """Write or read a file; what is read must be what was written."""
    if action == "write":
        gg.write(grid, path, form=title)
    else:
        found = gg.read(path, form=title.split()[0])
        assert grid is None or found.shape == grid.shape


def large_grid(nodes: int) -> gg.Grid:
    """Return a grid whose coordinates have all digits."""
    t = np.linspace(0, 1, nodes)
    return gg.Grid.from_planes(t[:, None] + 0.1 * np.sin(3 * t), t + 0.1 * np.cos(2 * t)[:, None])


def numpy_binary(grid: gg.Grid, folder: Path) -> float:
    """Return the seconds of numpy.save, flushed to the disk."""

    def save() -> None:
        with (folder / "numpy.npy").open("wb") as stream:
            np.save(stream, grid.planes)
            stream.flush()
            os.fsync(stream.fileno())

    return least(save, time.perf_counter)


def numpy_text(grid: gg.Grid, folder: Path) -> float:
    """Return the numbers that numpy.savetxt writes in a second."""
    rows = grid.planes.reshape(2, -1)[:, :SAMPLE].T.copy()
    return rows.size / least(lambda: np.savetxt(folder / "numpy.txt", rows), time.process_time)


def numbers_in(path: Path, grid: gg.Grid) -> int:
    """Return how many numbers a text has: those of meshes also have the corners of cells."""
    files = list(path.iterdir()) if path.is_dir() else [path]
    words = 0
    for file in files:
        with file.open("rb") as stream:
            while piece := stream.read(1 << 24):
                blank = np.frombuffer(piece, dtype=np.uint8) <= ord(",")
                words += int(np.count_nonzero(blank[:-1] & ~blank[1:]))
    return max(words, grid.planes.size)


def bytes_of(path: Path) -> int:
    """Return the bytes of what was written: a file, and a folder of the same name, if there is one."""
    folder = path if path.is_dir() else path.with_suffix("")
    inside = sum(file.stat().st_size for file in folder.iterdir()) if folder.is_dir() else 0
    return inside + (path.stat().st_size if path.is_file() else 0)


def least(call: Callable[[], object], clock: Callable[[], float]) -> float:
    """Return the least seconds of some runs."""
    times = []
    for _ in range(RUNS):
        begin = clock()
        call()
        times.append(clock() - begin)
    return min(times)


def copies(action: str, title: str, path: Path, nodes: int, size: int) -> float:
    """Return the memory of another process that does it, over that of the coordinates."""
    command = [sys.executable, __file__, "--nodes", str(nodes), "--peak", action, title, str(path)]
    return int(subprocess.run(command, capture_output=True, text=True, check=True).stdout) / size


def peak(action: str, title: str, path: str, nodes: int) -> int:
    """Return the bytes that this process needs above what it has after a small file of the same kind."""
    small = Path(path).with_name(f"small{Path(path).suffix}")
    for each in ("write", action):
        act(each, title, small, large_grid(5))
    before = highest()
    act(action, title, Path(path), large_grid(nodes) if action == "write" else None)
    return highest() - before


def highest() -> int:
    """Return the most bytes that this process ever had; unlike ru_maxrss without those of the one that started it."""
    (line,) = (line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmHWM"))
    return 1024 * int(line.split()[1])


if __name__ == "__main__":
    main()
