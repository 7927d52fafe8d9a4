"""The LaTeX of `gridgen-sym derive --document` compiles, where there is a LaTeX."""

from __future__ import annotations

import shutil
import subprocess

import pytest

from gridgen_sym.functionals import functional
from gridgen_sym.functionals.definition import Functional
from gridgen_sym.symbolic import derive_latex

CASES = {
    "winslow": functional("winslow"),
    "area": functional("area"),
    "own": Functional("my_own", "g11 + 2*g22 + k*exp(g12)", parameters={"k": 1.0}, description="50% & a half: J², _x_"),
}


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="needs pdflatex")
@pytest.mark.parametrize("name", CASES)
def test_a_document_compiles_and_no_line_is_too_long(name, tmp_path):
    (tmp_path / "page.tex").write_text(derive_latex(CASES[name], complete=True), encoding="utf-8")
    command = ["pdflatex", "-halt-on-error", "-interaction=nonstopmode", "page.tex"]
    for _ in range(2):  # The second run knows the numbers of the equations.
        told = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, errors="replace", check=False)
        assert told.returncode == 0, told.stdout[-2000:]
    assert "Overfull" not in told.stdout
    assert "Reference" not in "".join(line for line in told.stdout.splitlines() if "Warning" in line)
