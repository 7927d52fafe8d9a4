"""The files at the top of the repository agree with each other."""

from __future__ import annotations

import re
import subprocess
import tomllib
from pathlib import Path

import pytest

import gridgen_sym

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def lower_bounds(requirements):
    """Return the pins of the oldest versions that requirements allow; each names exactly one lower bound."""
    found = set()
    for requirement in requirements:
        match = re.fullmatch(r"([a-z0-9-]+)>=([0-9.]+)", requirement)
        assert match, f"{requirement!r} must be 'name>=version', so that its oldest version can be tested"
        found.add("{}=={}".format(*match.groups()))
    return found


def test_the_oldest_versions_are_the_lower_bounds():
    lines = (ROOT / ".ci" / "oldest.txt").read_text(encoding="utf-8").splitlines()
    pinned = [line for line in lines if line and not line.startswith("#")]
    extras = PROJECT["optional-dependencies"]
    required = lower_bounds([*PROJECT["dependencies"], *extras["plot"], *extras["io"], *extras["test"]])
    assert set(pinned) == required
    assert len(pinned) == len(set(pinned))


@pytest.mark.parametrize("requirement", ["numpy", "numpy>=1,<3", "numpy==1.26"])
def test_a_requirement_without_one_lower_bound_is_noticed(requirement):
    with pytest.raises(AssertionError, match="oldest version"):
        lower_bounds([requirement])


def test_the_version_of_the_citation_is_the_packages():
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert re.findall(r"^version: (.*)$", citation, re.MULTILINE) == [gridgen_sym.__version__]
    (address,) = re.findall(r'^url: "(.*)"$', citation, re.MULTILINE)
    assert PROJECT["urls"]["Source"] == address


def test_the_classifiers_name_the_pythons_that_are_tested():
    named = {line.split(" :: ")[-1] for line in PROJECT["classifiers"] if re.search(r"Python :: 3\.\d+$", line)}
    tested = set(re.findall(r'"(3\.\d+)"', (ROOT / "noxfile.py").read_text(encoding="utf-8")))
    assert named == tested
    assert PROJECT["requires-python"] == f">={min(named, key=lambda version: int(version.split('.')[1]))}"


def test_contributing_names_paths_that_exist():
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    named = re.findall(r"`((?:gridgen_sym|tests|templates|docs|generated|\.ci)/[\w./]*)`", text)
    assert len(named) > 20
    missing = [name for name in named if not (ROOT / name).exists() and not name.startswith("docs/_build")]
    # Names of templates to come have a placeholder in capitals.
    assert [name for name in missing if not re.search(r"/(?:X\.|NAME)", name)] == []


def test_the_top_holds_what_a_newcomer_expects():
    # Committed files only: the README's first example writes its grid and its picture here.
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    names = {name for name in listed.split("\0") if name and "/" not in name and (ROOT / name).exists()}
    documents = {"CHANGELOG.md", "CITATION.cff", "CONTRIBUTING.md", "LICENSE", "README.md", "SECURITY.md"}
    settings = {".gitattributes", ".gitignore", ".pre-commit-config.yaml", "noxfile.py", "pyproject.toml"}
    assert names == documents | settings
