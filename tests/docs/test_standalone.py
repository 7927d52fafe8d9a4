"""`gridgen-sym docs` writes a page of a user's functional that needs nothing beside it."""

from __future__ import annotations

import sys

import pytest
from click.testing import CliRunner

from gridgen_sym.cli import main


@pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::PendingDeprecationWarning")
@pytest.mark.usefixtures("clean_registry")
def test_a_users_functional_gets_its_page(tmp_path):
    for package in ("sphinx", "furo", "myst_parser", "sphinx_copybutton", "matplotlib"):
        pytest.importorskip(package)
    (tmp_path / "mine.py").write_text(
        'import gridgen_sym as gg\ngg.define("mine", "g11 + 2*g22", description="Odd.")\n'
    )
    arguments = ["docs", "mine", "--functionals", str(tmp_path / "mine.py"), "-o", str(tmp_path / "out")]
    told = CliRunner().invoke(main, arguments, catch_exceptions=False)
    assert told.exit_code == 0, told.output
    page = (tmp_path / "out" / "mine.html").read_text(encoding="utf-8")
    assert "treats the two families of grid lines differently" in page
    assert r"2 \left( x_{\xi \xi} + 2 x_{\eta \eta} \right) = 0" in page
    assert "<details" in page
    assert (tmp_path / "out" / "_static" / "mathjax" / "startup.js").exists()
    assert (tmp_path / "out" / "_images" / "mine-1.png").exists()
    assert "https://cdn" not in page


@pytest.mark.usefixtures("clean_registry")
def test_without_sphinx_the_extra_is_named(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "furo", None)
    told = CliRunner().invoke(main, ["docs", "length", "-o", str(tmp_path / "out")])
    assert told.exit_code == 2
    assert "gridgen-sym[docs]" in told.output
