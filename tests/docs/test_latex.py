"""The LaTeX of `gridgen-sym derive --latex` compiles, where there is a LaTeX."""

from __future__ import annotations

import re
import shutil
import subprocess

import pytest

from gridgen_sym.functionals import functional
from gridgen_sym.functionals.definition import Functional
from gridgen_sym.symbolic import derive_latex

HEAD = r"\documentclass{article}\usepackage[utf8]{inputenc}\usepackage{amsmath}\begin{document}"
CASES = {
    "winslow": functional("winslow"),
    "area": functional("area"),
    "own": Functional("my_own", "g11 + 2*g22 + k*exp(g12)", parameters={"k": 1.0}, description="50% & a half: J², _x_"),
}


@pytest.mark.parametrize("name", CASES)
def test_a_fragment_compiles(name, tmp_path):
    fragment = derive_latex(CASES[name])
    opened = re.findall(r"\\begin\{(\w+\*?)\}", fragment)
    assert sorted(opened) == sorted(re.findall(r"\\end\{(\w+\*?)\}", fragment))
    assert not re.search(r"[^\x00-\x7f]", fragment)
    if shutil.which("pdflatex") is None:
        pytest.skip("needs pdflatex to go on")
    (tmp_path / "page.tex").write_text(HEAD + fragment + r"\end{document}", encoding="utf-8")
    command = ["pdflatex", "-halt-on-error", "-interaction=nonstopmode", "page.tex"]
    told = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert told.returncode == 0, told.stdout[-2000:]
