"""The parts of the derived pages, each by itself: what they say follows from what they are given, and nothing else."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
import sympy
from derived_pages import site
from derived_pages.paper_pages import Shown, _section, _shown, _title, _without_name
from derived_pages.reference_pages import command_helps, public_names
from support import BUILTIN

import gridgen_sym as gg
from gridgen_sym.documentation import derived_page, functional_page, pictures
from gridgen_sym.documentation.advice import consequences
from gridgen_sym.documentation.derived_page import _facts, _parts
from gridgen_sym.documentation.pictures import _panels, trials
from gridgen_sym.functionals import functional
from gridgen_sym.functionals.definition import Functional
from gridgen_sym.symbolic.classify.ellipticity import Ellipticity
from gridgen_sym.symbolic.coordinates import s

pytestmark = pytest.mark.slow


def classification(**properties):
    """The properties that no advice is given for, but for those that are named."""
    usual = {
        "null_lagrangian": False,
        "barrier": True,
        "linear": False,
        "scaling_degree": sympy.Integer(4),
        "translation": True,
        "rotation": True,
        "exchange": True,
        "kinks": (),
        "polyconvex": SimpleNamespace(holds=True, proof="proved"),
        "lower_bound": SimpleNamespace(value=sympy.Integer(2), proof="proved"),
        "ellipticity": Ellipticity("elliptic", "proved"),
        "functional": SimpleNamespace(expression=lambda: sympy.Symbol("J"), parameters={}, constraints=(), fields={}),
        "words": lambda: ("quasilinear", "coupled", "elliptic"),
    }
    return SimpleNamespace(**(usual | properties))


USUAL = ["It has a barrier", "Its equations are elliptic (proved)"]
ADVICE = {
    "the usual": ({}, USUAL),
    "nothing": ({"null_lagrangian": True}, ["It is a null Lagrangian"]),
    "no barrier": ({"barrier": False}, ["It has no barrier", USUAL[1]]),
    "linear": ({"linear": True}, [*USUAL, "Its equations are linear"]),
    "no size": ({"scaling_degree": 0}, [*USUAL, "It depends on the shape of a cell only"]),
    "a direction": ({"rotation": False}, [*USUAL, "It is not invariant under rotation"]),
    "two families": ({"exchange": False}, [*USUAL, "It treats the two families of grid lines differently"]),
    "hills": ({"polyconvex": SimpleNamespace(holds=False)}, [*USUAL, "It is not polyconvex"]),
    "a kink": ({"kinks": (sympy.Symbol("J") - 1,)}, [*USUAL, "Its first derivatives jump"]),
    "no bound": ({"lower_bound": SimpleNamespace(value=None)}, [*USUAL, "No lower bound of its density is known"]),
    "a bound of 0": ({"lower_bound": SimpleNamespace(value=sympy.Integer(0))}, USUAL),
    "a weight": ({"functional": SimpleNamespace(expression=lambda: s)}, [*USUAL, "Its density names the weight"]),
    "sampled": (
        {"ellipticity": Ellipticity("elliptic", "sampled")},
        [USUAL[0], "Its equations are elliptic (at every one of the jets"],
    ),
    "weak": (
        {"ellipticity": Ellipticity("weakly elliptic", "proved")},
        [USUAL[0], "Its equations are weakly elliptic"],
    ),
    "degenerate": (
        {"ellipticity": Ellipticity("degenerate", "proved")},
        [USUAL[0], "Its equations are degenerate"],
    ),
    "changing": (
        {"ellipticity": Ellipticity("changing type", "proved")},
        [USUAL[0], "Its equations change type"],
    ),
}


@pytest.mark.parametrize(("properties", "sentences"), ADVICE.values(), ids=ADVICE)
def test_every_property_has_its_sentence(properties, sentences):
    told = list(consequences(classification(**properties)))
    assert len(told) == len(sentences)
    for sentence, begin in zip(told, sentences, strict=True):
        assert sentence.startswith(begin)
        assert sentence.endswith(".")


def test_facts_are_those_of_the_classification():
    facts = dict(_facts(classification()))
    assert facts == {
        "Equations": "quasilinear, coupled, elliptic where $J > 0$ (proved)",
        "Barrier at $J = 0$": "yes",
        "Invariant under": "translation, rotation, exchange of ξ and η",
        "Scaling": "of degree $4$",
        "Lower bound": "$2$ (proved)",
        "Polyconvex": "yes, where $J > 0$ (proved)",
    }
    other = classification(
        barrier=False,
        translation=False,
        rotation=False,
        exchange=False,
        kinks=(sympy.Symbol("J") - 1,),
        scaling_degree=None,
        lower_bound=SimpleNamespace(value=None),
        polyconvex=SimpleNamespace(holds=False, proof="refuted"),
        ellipticity=Ellipticity("degenerate", "sampled"),
        functional=SimpleNamespace(parameters={"k": 0.5, "m": 2.0}, constraints=("k > 0", "m > k"), fields={}),
    )
    facts = dict(_facts(other))
    assert facts["Equations"].endswith("(sampled)")
    assert facts["Barrier at $J = 0$"] == "no"
    assert facts["Invariant under"] == "none of translation, rotation, exchange of ξ and η"
    assert facts["Scaling"] == "not homogeneous"
    assert facts["Lower bound"] == "none known"
    assert facts["Polyconvex"] == "no (refuted at a point)"
    assert facts["First derivatives jump"] == "where $J - 1 = 0$"
    assert facts["Parameters"] == "`k` = 0.5, `m` = 2, with `k > 0`, `m > k`"


def test_long_formulas_and_details_go_behind_folds(monkeypatch):
    def section(title, subtitle, items, detail=False):
        heading = f"{title}: {subtitle}" if subtitle else title
        return SimpleNamespace(title=title, subtitle=subtitle, heading=heading, items=items, detail=detail)

    longest, longer = "a" * 450, "b" * 451
    made = [
        section("Density", "", ["left out"]),
        section("One", "", ["text", longest, longer]),
        section("Two", "first part", ["x"]),
        section("Two", "second part", ["y"]),
        section("Three", "", ["hidden"], detail=True),
    ]
    monkeypatch.setattr(derived_page, "sections", lambda _: made)
    told = [(part.heading, part.fold, [text for _, text in part.blocks]) for part in _parts(functional("length"))]
    assert told == [
        ("## One", "", ["text", longest]),
        ("", "The long formulas of this section", [longer]),
        ("## Two", "", []),
        ("### First part", "", ["x"]),
        ("### Second part", "", ["y"]),
        ("", "Three", ["hidden"]),
    ]


# ---- pictures ----


def trial(name, start_folds, folds):
    result = SimpleNamespace(grid=f"made of {name}", quality=SimpleNamespace(folded_cells=folds, cells=576))
    return pictures.Trial(name, f"start of {name}", start_folds, result)


def test_the_pictures_are_a_repaired_grid_and_a_folded_one():
    tried = [trial("plain", 0, 0), trial("bad", 3, 5), trial("mended", 7, 0), trial("worse", 9, 9)]
    assert list(_panels(functional("length"), tried)) == [
        ("mended: the start", "Transfinite interpolation of `mended` folds 7 cells (red).", "start of mended"),
        ("mended: length", "`length` makes a grid of `mended` without a folded cell.", "made of mended"),
        ("bad: length", "On `bad` it folds 5 of 576 cells (red).", "made of bad"),
    ]
    (only,) = _panels(functional("length"), [trial("plain", 0, 0), trial("other", 0, 0)])
    assert only[2] == "made of plain"
    (only,) = _panels(functional("winslow"), [trial("bad", 3, 5)])
    assert only[1] == "On `bad` the start could not be untangled; folded are 5 of 576 cells (red)."


def test_pictures_are_numbered_from_one(monkeypatch, tmp_path):
    drawn = []
    monkeypatch.setattr(pictures, "plot_grids", lambda grids, path: drawn.append((grids, path)))
    told = pictures.draw(functional("length"), [trial("mended", 7, 0)], tmp_path)
    assert [file for file, _ in told] == ["length-1.png", "length-2.png"]
    assert [(grids[0][1], path.name) for grids, path in drawn] == [
        ("start of mended", "length-1.png"),
        ("made of mended", "length-2.png"),
    ]


def test_every_domain_is_tried_the_telling_ones_first(monkeypatch):
    monkeypatch.setattr(pictures, "optimize", lambda start, *_, **options: SimpleNamespace(grid=start, told=options))
    tried = trials(functional("length"))
    assert sorted(one.domain for one in tried) == sorted(gg.domain_names())
    assert [one.domain for one in tried[:3]] == ["swan", "horseshoe", "wavy"]
    for one in tried:
        assert one.start == gg.domain(one.domain, 25, 25)
        assert one.start_folds == gg.quality(one.start).folded_cells
        assert not one.result.told["keep_valid"]


# ---- the paper ----


def verdict(place="Section 2.1, second equation", **properties):
    usual = {
        "is_plain": False,
        "agrees": True,
        "status": "agrees",
        "erratum": None,
        "difference": sympy.Integer(0),
        "equation": SimpleNamespace(place=place, key="no such key"),
    }
    return SimpleNamespace(**(usual | properties))


def test_an_equation_is_shown_with_its_answer(monkeypatch):
    monkeypatch.setattr("derived_pages.paper_pages.counterpart", lambda _: None)
    x = sympy.Symbol("x")
    plain = _shown(verdict(is_plain=True))
    assert (plain.color, plain.answer, plain.derived, plain.difference) == ("agrees", "agrees", (), "")
    assert _shown(verdict(difference=x)).color == "condition"
    assert _shown(verdict(difference=x)).difference == ""
    wrong = _shown(verdict(agrees=False, status="differs", erratum="E3", difference=2 * x))
    assert (wrong.color, wrong.answer, wrong.difference) == ("differs", "differs (E3)", "2 x")
    assert _shown(verdict(agrees=False, difference=sympy.Integer(2))).difference == "", "a factor, not a difference"


def test_where_an_equation_stands():
    shown = Shown(verdict(), "", "", (), "")
    assert shown.heading == "Second equation"
    assert Shown(verdict("table of determinants"), "", "", (), "").heading == "Table of determinants"
    sections = [_section(SimpleNamespace(place=place)) for place in ("Section 2.7, x", "Table 1", "Section 2.1")]
    assert sections == ["2.7", "1", "2.1"]
    assert _title("2.5") == "Section 2.5: Winslow"
    assert _title("9.9") == "Section 9.9"
    assert _without_name("left = x") == "x"
    assert _without_name("right = x") == "right = x"


# ---- the site ----


def test_links_to_files_of_the_repository_stay_on_the_site():
    source = ["see [this](../benchmarks/README.md) and [that](../CHANGELOG.md), not [other](../README.md)"]
    site._stay_on_the_site(None, "page", source)
    expected = "see [this](benchmarks_method.md) and [that](reference/changelog.md), not [other](../README.md)"
    assert source == [expected]
    lines = ["the norm |g1|", "plain"]
    site._keep_bars(None, "", "", None, None, lines)
    assert lines == [r"the norm \|g1\|", "plain"]


def test_a_page_of_a_functional_that_is_gone_is_removed(monkeypatch, tmp_path):
    def write(name, folder):
        path = folder / f"{name}.md"
        path.write_text("new")
        return path

    monkeypatch.setattr(site, "write_functional_page", lambda one, folder: write(one.name, folder))
    monkeypatch.setattr(site, "write_literature_page", lambda found, folder: write("literature", folder))
    monkeypatch.setattr(site, "classify", lambda one: SimpleNamespace(functional=one))
    monkeypatch.setattr(site, "render_page", lambda name, found, densities: f"{len(found)} functionals")
    (tmp_path / "pages").mkdir()
    (tmp_path / "pages" / "gone.md").write_text("old")
    site._write_functionals(tmp_path / "pages")
    names = {path.stem for path in (tmp_path / "pages").glob("*.md")}
    assert "gone" not in names
    assert names == {"index", "literature", *BUILTIN}
    assert (tmp_path / "pages" / "index.md").read_text() == f"{len(BUILTIN)} functionals"


def test_a_page_that_says_the_same_is_not_written_again(tmp_path):
    path = functional_page.write_if_changed(tmp_path / "page.md", "text")
    before = path.stat().st_mtime_ns
    functional_page.write_if_changed(path, "text")
    assert path.stat().st_mtime_ns == before
    functional_page.write_if_changed(path, "other")
    assert path.read_text() == "other"


def test_what_is_called_stands_before_what_comes_back():
    for names in public_names().values():
        kinds = [kind == "autofunction" for kind, _ in names]
        assert kinds == sorted(kinds, reverse=True)
    listed = dict(name for names in public_names().values() for name in map(reversed, names))
    assert (listed["optimize"], listed["Grid"], listed["GridgenError"]) == (
        "autofunction",
        "autoclass",
        "autoexception",
    )
    assert "optimize" in dict(map(reversed, public_names()["Solvers"]))


def test_help_fits_on_a_page():
    for _, text in command_helps():
        assert max(map(len, text.splitlines())) <= 86


def test_what_a_page_shows_is_derived_once(monkeypatch):
    mine = Functional("mine", "(g11 + 2*g22)/J", description="Odd.")
    first = derived_page.derived_page(mine)
    assert any("treats the two families" in sentence for sentence in first["consequences"])
    monkeypatch.setattr(derived_page, "_derive", None)
    assert derived_page.derived_page(mine) == first
    # What is written in another way is derived again.
    monkeypatch.setattr(derived_page, "key_of_files", lambda _: "others")
    with pytest.raises(TypeError):
        derived_page.derived_page(mine)


def test_a_page_is_written_with_its_kernels_beside_it(monkeypatch, tmp_path):
    given = {}

    def page(template, **names):
        given.update(names)
        return "the page"

    start = SimpleNamespace(start=gg.domain("wavy", 25, 25))
    monkeypatch.setattr(functional_page, "trials", lambda _: (start,))
    monkeypatch.setattr(functional_page, "draw", lambda *_: ())
    monkeypatch.setattr(functional_page, "render_page", page)
    path = functional_page.write_functional_page(functional("length"), tmp_path)
    assert path == tmp_path / "length.md"
    assert path.read_text() == "the page"
    assert given["cells"] == 24
    assert [(language, fence, file) for language, fence, _, file in given["sources"]] == [
        ("C", "c", "length.c"),
        ("NumPy", "python", "length.py"),
    ]
    for (_, _, text, file), remark, line in zip(
        given["sources"],
        ("/* corner_energy */", "# corner_energy"),
        ("const double energy = ", "energy = "),
        strict=True,
    ):
        assert text.startswith(remark)
        assert f"\n{line}" in text
        assert (tmp_path / file).read_text().count("\n") > 50
    assert [program["name"] for program in given["programs"]][:2] == ["corner_energy", "corner_slopes"]
    assert given["programs"][0]["meaning"] == "energy of a corner"
