"""Every tutorial is followed literally: its blocks run in order, in a folder of their own, and print what it says."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "docs" / "tutorials"
TUTORIALS = [
    *sorted(path for path in FOLDER.glob("*.md") if path.name != "index.md"),
    *(
        ROOT / "docs" / name
        for name in (
            "index.md",
            "explanations/certificates.md",
            "explanations/solvers.md",
            "explanations/walls_through_equations.md",
            "reference/walls.md",
        )
    ),
]
BLOCK = re.compile(
    r"(?P<place><!-- in: repository -->\n)?"
    r"^```(?P<kind>\{code-block\} \w+\n:caption: (?P<file>\S+)|\w+)\n(?P<text>.*?)^```$",
    re.MULTILINE | re.DOTALL,
)
#: A file of the repository that a page offers for download.
DOWNLOAD = re.compile(r"\{download\}`[^`<]*<(?P<path>[^>]+)>`")
#: Pages that need more packages than those of the tests.
EXTRAS = {"ocean"}
#: Runs the Python blocks that it is told, each on a line of its own, with the same names; says when one has ended.
SESSION = """
import sys
names = {}
for line in sys.stdin:
    exec(compile(eval(line), "tutorial", "exec"), names)
    print("\\nthe block has ended", flush=True)
"""


@dataclass
class Block:
    kind: str
    text: str
    file: str | None
    in_repository: bool


def blocks(path):
    """Return the fenced blocks of a page: `file` to be written, `bash` and `python` to be run, `text` to be printed."""
    return [
        Block("file" if m["file"] else m["kind"], m["text"], m["file"], bool(m["place"]))
        for m in BLOCK.finditer(path.read_text(encoding="utf-8"))
    ]


def environment(folder):
    """Return an environment in which `gridgen-sym` and `python` are those of this test."""
    programs = folder / "bin"
    programs.mkdir()
    for program, module in (("gridgen-sym", " -m gridgen_sym"), ("python", "")):
        (programs / program).write_text(f'#!/bin/sh\nexec "{sys.executable}"{module} "$@"\n')
        (programs / program).chmod(0o755)
    path = os.pathsep.join([str(programs), str(Path(sys.executable).parent), os.environ["PATH"]])
    author = {f"GIT_{who}_{what}": "tutorial" for who in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")}
    return os.environ | author | {"PATH": path, "PYTHONPATH": str(ROOT), "GRIDGEN_SYM_QUIET": "1", "MPLBACKEND": "Agg"}


def clone(folder):
    """Make what a clone of the repository has, as far as a functional needs it."""
    repository = folder / "repository"
    for part in ("gridgen_sym", "templates", "generated"):
        ignored = shutil.ignore_patterns("__pycache__", "mathjax")
        shutil.copytree(ROOT / part, repository / part, ignore=ignored)
    # One of the built-in functionals is enough here: to generate all of them takes half a minute.
    for file, kept in (("library.py", 1), ("adaptive.py", 0)):
        library = repository / "gridgen_sym" / "functionals" / file
        parts = library.read_text(encoding="utf-8").split("\n\n\n@builtin(")
        library.write_text("\n\n\n@builtin(".join(parts[: kept + 1]).rstrip() + "\n", encoding="utf-8")
    for command in (["git", "init", "--quiet"], ["git", "add", "."]):
        subprocess.run(command, cwd=repository, check=True)
    return repository


class Session:
    """One Python for all blocks of a page, as a reader has it open beside the shell."""

    def __init__(self, folder, variables):
        self.program = subprocess.Popen(
            [sys.executable, "-c", SESSION],
            cwd=folder,
            env=variables,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )

    def run(self, block):
        """Run a block and return what it prints."""
        self.program.stdin.write(f"{block!r}\n")
        self.program.stdin.flush()
        printed = []
        for line in self.program.stdout:
            if line == "the block has ended\n":
                return "".join(printed) or "nothing"
            printed.append(line)
        raise AssertionError("".join(printed))

    def __enter__(self):
        return self

    def __exit__(self, *error):
        self.program.__exit__(*error)


def run(command, folder, variables):
    told = subprocess.run(
        command, cwd=folder, env=variables, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False
    )
    assert told.returncode == 0, told.stdout
    return told.stdout


def test_there_are_tutorials():
    assert len(TUTORIALS) >= 6


@pytest.mark.parametrize(
    "tutorial",
    [
        pytest.param(path, id=path.stem, marks=pytest.mark.extras if path.stem in EXTRAS else pytest.mark.slow)
        for path in TUTORIALS
    ],
)
def test_a_tutorial_can_be_followed(tutorial, tmp_path):
    pytest.importorskip("matplotlib")
    if shutil.which("cc") is None and "cc -std" in tutorial.read_text(encoding="utf-8"):
        pytest.skip("needs a C compiler")
    work = tmp_path / "work"
    work.mkdir()
    for offered in DOWNLOAD.finditer(tutorial.read_text(encoding="utf-8")):
        shutil.copy(tutorial.parent / offered["path"], work)
    variables, printed, repository = environment(tmp_path), "", None
    with Session(work, variables) as session:
        for block in blocks(tutorial):
            if block.in_repository:
                repository = repository or clone(tmp_path)
            folder = repository if block.in_repository else work
            here = variables | ({"PYTHONPATH": str(repository)} if block.in_repository else {})
            if block.kind == "file":
                (work / block.file).write_text(block.text, encoding="utf-8")
            elif block.kind == "bash":
                printed += run(["bash", "-euo", "pipefail", "-c", block.text], folder, here)
            elif block.kind == "python":
                assert not block.in_repository
                printed += session.run(block.text)
            elif block.kind == "text":
                missing = [line for line in block.text.splitlines() if line not in printed]
                assert not missing, f"{tutorial.name} says {missing}; printed was:\n{printed}"
    assert printed


def test_a_wrong_claim_is_found(tmp_path):
    page = tmp_path / "wrong.md"
    page.write_text("```bash\necho one\n```\n\n```text\ntwo\n```\n")
    assert [block.kind for block in blocks(page)] == ["bash", "text"]
    with pytest.raises(AssertionError, match="two"):
        test_a_tutorial_can_be_followed(page, tmp_path)


def test_a_block_that_fails_is_told(tmp_path):
    with Session(tmp_path, {**os.environ}) as session:
        assert session.run("a = 1\nprint(a)\n") == "1\n\n"
        with pytest.raises(AssertionError, match="ZeroDivisionError"):
            session.run("1/(a - 1)\n")
