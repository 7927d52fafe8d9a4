"""GCC vectorizes every loop that is marked for it: that is a factor of 3 to 4, and nothing else tells of its loss."""

from __future__ import annotations

import platform
import re
import shutil
import subprocess

import pytest

from gridgen_sym.resources import resource_folder

FOLDER = resource_folder("generated") / "c"
LOOPS = (FOLDER / "loops.h").read_text(encoding="utf-8").splitlines()
FLAGS = (
    "-std=c99",
    "-O2",
    "-march=x86-64-v3",
    "-ffp-contract=fast",
    "-fno-math-errno",
    "-fno-trapping-math",
    "-fopenmp",
)

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(platform.machine() != "x86_64" or not shutil.which("gcc"), reason="needs GCC on x86-64"),
]


def gcc(path, *flags):
    return subprocess.run(["gcc", *FLAGS, *flags, path], capture_output=True, text=True, check=True)


def end_of(first):
    """Return the number of the line of `loops.h` that ends, with a brace or a semicolon, what begins on a line."""
    depth = 0
    for number in range(first, len(LOOPS) + 1):
        line = LOOPS[number - 1]
        depth += line.count("{") - line.count("}")
        if depth == 0 and line.rstrip().endswith((";", "}")):
            return number
    raise AssertionError(f"nothing that begins in line {first} ends")


def marked_loops(path):
    """Return the lines of `loops.h` at which loops of this kernel are marked: what the preprocessor leaves."""
    file, line, found = "", 0, set()
    for text in gcc(path, "-E").stdout.splitlines():
        if marker := re.match(r'# (\d+) "(.*)"', text):
            file, line = marker[2], int(marker[1])
            continue
        if file.endswith("loops.h") and text.startswith("#pragma omp simd"):
            found.add(line)
        line += 1
    return found


def places_of(mark):
    """Return the lines that a report may name for the loop under a mark: its own; of one line, also what it calls.

    The line of the mark is that of what sets up a reduction.
    """
    last = end_of(mark + 1)
    lines = {*range(mark + 1, last + 1)}
    called = set(re.findall(r"\b(\w+)\(", LOOPS[last - 1])) if last == mark + 1 else set()
    for number, line in enumerate(LOOPS, 1):
        if (head := re.match(r"INLINE \w+ (\w+)\(", line)) and head[1] in called:
            lines |= {*range(number, end_of(number) + 1)}
    return lines


def vectorized_lines(path):
    told = gcc(path, "-fopt-info-vec-optimized", "-c", "-o", "/dev/null").stderr
    return {int(line) for line in re.findall(r"loops\.h:(\d+):\d+: optimized: +loop vectorized", told)}


def missed(path, vectorized):
    return [mark for mark in sorted(marked_loops(path)) if not places_of(mark) & vectorized]


def test_marked_loops_are_vectorized():
    path = FOLDER / "area_winslow_differentiated.c"
    assert len(marked_loops(path)) >= 15
    assert missed(path, vectorized_lines(path)) == []


def test_values_are_read_in_rows_and_not_one_by_one():
    """A vector of values read one by one is put together of halves, by dozens of such instructions; it was so once."""
    code = gcc(FOLDER / "area_winslow_frozen.c", "-S", "-o", "-").stdout
    assert len(re.findall(r"\b(?:vmovhpd|vinsertf128|vgather)", code)) < 10


def test_a_loop_that_is_not_vectorized_is_found(tmp_path):
    folder = shutil.copytree(FOLDER, tmp_path / "c")
    shared, statement = folder / "loops.h", "      sum += cell.energy;\n"
    text = shared.read_text()
    assert text.count(statement) == 1
    shared.write_text(text.replace(statement, statement.replace("\n", ' __asm__ volatile("");\n')))
    (mark,) = missed(folder / "winslow.c", vectorized_lines(folder / "winslow.c"))
    assert "reduction(+ : sum)" in LOOPS[mark - 1]
