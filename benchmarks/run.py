"""Run all benchmarks and write docs/benchmarks.md and its plots."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

import full_approximation
import kernels
import peers
import solver
import start
from measure import FOLDER, Table, machine

PARTS = ("start", "kernels", "solver", "full-approximation", "peers")
_HEAD = """# Benchmarks

Written by `python benchmarks/run.py{flags}`; [benchmarks/README.md](../benchmarks/README.md)
says what is measured and how. Grids with walls have [a page of their own](benchmarks_walls.md).

{facts}

The machine was shared with other work. All times are therefore the smallest of several runs, and processor seconds
stand beside wall seconds: where they differ, others had the processor. Ratios within one table carry over to other
machines, times do not. Two threads that wait for each other suffer most: their rows show the machine's load, too.
"""


def main() -> None:
    """Run the parts that are asked for, all by default."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer cases and runs: some ten minutes")
    parser.add_argument("--largest", type=int, help="side of the largest grid; 1024 if quick, else 2048")
    parser.add_argument("--part", action="append", choices=PARTS, help="measure this part only, keep the others")
    parser.add_argument("--docs", type=Path, default=FOLDER.parent / "docs", help="where to write")
    options = parser.parse_args()
    images, target = options.docs / "images", options.docs / "benchmarks.md"
    images.mkdir(parents=True, exist_ok=True)
    parts: dict[str, Callable[[], list[Table]]] = {
        "Start": lambda: start.run(options.quick),
        "Kernels": lambda: kernels.run(options.quick, images / "benchmark_kernels.png"),
        "Solver": lambda: solver.run(options.quick, options.largest, images / "benchmark_solver.png"),
        "Full approximation": lambda: full_approximation.run(options.quick),
        "Peers": lambda: peers.run(options.quick, images / "benchmark_peers.png"),
    }
    sections = _sections(target) if options.part else {}
    for title, measure in parts.items():
        part = title.lower().replace(" ", "-")
        if not options.part or part in options.part:
            drawn = part in ("kernels", "solver", "peers")
            image = f"![{title}, drawn by the benchmark](images/benchmark_{part}.png)\n\n" * drawn
            sections[title] = image + "\n".join(table.markdown() for table in measure())
    flags = " --quick" * options.quick + f" --largest {options.largest}" * (options.largest is not None)
    head = _HEAD.format(flags=flags, facts="\n".join(f"* {fact}" for fact in machine()))
    body = [f"## {title}\n\n{sections[title].strip()}\n" for title in parts if title in sections]
    target.write_text("\n".join([head, *body]), encoding="utf-8")
    print(f"wrote {target.name} and its plots")


def _sections(path: Path) -> dict[str, str]:
    """Return the sections of an earlier report by title."""
    text = path.read_text(encoding="utf-8") if path.exists() else ""
    return {title: body for title, _, body in (part.partition("\n") for part in text.split("\n## ")[1:])}


if __name__ == "__main__":
    main()
