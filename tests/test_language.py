"""README stays short, and prose uses the field's terms and American spelling."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
TOP = [
    ROOT / name
    for name in ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md", "CITATION.cff", "noxfile.py")
]
#: Pages that are written by hand; derived ones are built from the package's own texts.
PAGES = [
    path
    for path in sorted((ROOT / "docs").rglob("*.md"))
    if path.relative_to(ROOT / "docs").parts[0] not in ("_build", "functionals", "paper", "gallery")
]
SCRIPTS = sorted(
    [*(ROOT / "examples").glob("*.py"), *(ROOT / "benchmarks").glob("*.py"), *(ROOT / "benchmarks").glob("*.md")]
)
#: Code: names, docstrings, comments and messages. Two files here name what they must not use.
CODE = [
    path
    for folder in ("gridgen_sym", "templates", "tests", "docs/_ext")
    for path in sorted((ROOT / folder).rglob("*"))
    if path.suffix in (".py", ".jinja", ".c", ".h")
    and "mathjax" not in path.parts
    and path.name not in ("test_language.py", "test_public_names.py")
]
FILES = [*TOP, *PAGES, *SCRIPTS, *CODE]

BRITISH = re.compile(
    r"(?:(?:(?:mini|maxi|opti)m|regular|linear|normal|initial|general|parametr|parameter|organ|recogn|summar|symmetr"
    r"|factor|vector|real|util|penal|stabil|visual|serial|local|special|synchron|discret)is(?:e|ing|ation)|neighbour"
    r"|colour|behaviour|favour|honour|artefact|modelled|modelling|labelled|labelling|travell|learnt|spelt|whilst"
    r"|programme\b|licence|grey\b|\bcentre|\bmetre|analyse|catalogue|towards\b)",
    re.IGNORECASE,
)
#: Files and keywords of OpenFOAM, which are British.
NAMES = re.compile(r"\"neighbour\"|\"neighbourPatch\"|\bneighbourPatch |\brotationCentre\b")
#: Words of our own, and what the field says.
INVENTED = {
    r"\blets? expect": "predicted from the boundary spacing",
    r"\b(?:tells?|told|telling) (?:\w+ )?apart\b": "branch",
    r"\bcalm(?:s|ed|ing)?\b": "relax locally",
    r"\bthat there may be\b": "that exist",
    r"\bis no proof\b|\bno certificate is not": "does not imply",
    r"\bworks? for long\b": "long-running stage",
    r"\bless folded cells\b": "fewer folded cells",
    r"\bwithout a place\b": "with an empty feasible region",
    r"\bplaces? (?:is|are) (?:contracted|halved|cut)\b": "constraints are propagated, the region is bisected",
    r"\bso that it is told\b": "report",
}


def slips(text):
    """Return the words of a text that are British or our own, as a list of (what, line)."""
    text = NAMES.sub("", text)
    found = [(match[0], text.count("\n", 0, match.start()) + 1) for match in BRITISH.finditer(text)]
    for pattern, better in INVENTED.items():
        for match in re.finditer(pattern.replace(" ", r"\s+"), text, re.IGNORECASE):
            found.append((f"{match[0]!r}: write '{better}'", text.count("\n", 0, match.start()) + 1))
    return found


def test_the_readme_is_short():
    assert len((ROOT / "README.md").read_text(encoding="utf-8").splitlines()) <= 120


@pytest.mark.parametrize("folder", sorted({path.relative_to(ROOT).parts[0] for path in FILES}))
def test_prose_uses_the_fields_words(folder):
    found = {
        path.relative_to(ROOT).as_posix(): slips(path.read_text(encoding="utf-8"))
        for path in FILES
        if path.relative_to(ROOT).parts[0] == folder
    }
    assert {path: words for path, words in found.items() if words} == {}


@pytest.mark.parametrize(
    "text",
    [
        "We minimise the energy.",
        "a Neighbour",
        "regularisation",
        "the licence",
        "what the edges let expect there",
        "places are\ncontracted",
        "two cases are told apart",
    ],
)
def test_a_slip_is_found(text):
    assert len(slips(text)) == 1


@pytest.mark.parametrize(
    "text", ["We minimize it.", "precise, otherwise, promise", "a likewise surprising metric", "parameters"]
)
def test_good_words_are_kept(text):
    assert slips(text) == []
