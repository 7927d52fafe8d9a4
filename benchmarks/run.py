"""Run all benchmarks and write docs/benchmarks.md and its plots."""

from __future__ import annotations

import argparse
from pathlib import Path

import kernels
import peers
import solver
import start
from measure import FOLDER, Table, machine

_HEAD = """# Benchmarks

Written by `python benchmarks/run.py{flags}`; [benchmarks/README.md](../benchmarks/README.md)
says what is measured and how.

{facts}

The machine was shared with other work. All times are therefore the smallest of several runs, and processor seconds
stand beside wall seconds: where they differ, others had the processor. Ratios within one table carry over to other
machines, times do not.
"""


def main() -> None:
    """Run the parts that are asked for, all by default."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="fewer cases and runs: some ten minutes")
    parser.add_argument("--largest", type=int, default=1024, help="side of the largest grid, up to 2048")
    parser.add_argument("--docs", type=Path, default=FOLDER.parent / "docs", help="where to write")
    options = parser.parse_args()
    images = options.docs / "images"
    images.mkdir(parents=True, exist_ok=True)
    parts: list[tuple[str, str, list[Table]]] = [
        ("Start", "", start.run(options.quick)),
        ("Kernels", "kernels", kernels.run(options.quick, images / "benchmark_kernels.png")),
        ("Solver", "solver", solver.run(options.quick, options.largest, images / "benchmark_solver.png")),
        ("Peers", "peers", peers.run(options.quick, images / "benchmark_peers.png")),
    ]
    flags = " --quick" * options.quick + f" --largest {options.largest}" * (options.largest != 1024)
    lines = [_HEAD.format(flags=flags, facts="\n".join(f"* {fact}" for fact in machine()))]
    for title, image, tables in parts:
        lines.append(f"## {title}\n")
        if image:
            lines.append(f"![{title}, drawn by the benchmark](images/benchmark_{image}.png)\n")
        lines += [table.markdown() for table in tables]
    target = options.docs / "benchmarks.md"
    target.write_text("\n".join(lines), encoding="utf-8")
    print(f"wrote {target.name} and its plots")


if __name__ == "__main__":
    main()
