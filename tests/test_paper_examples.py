"""Section 3 of the paper, run once: its pictures, its table, and what the numbers say of its claims."""

from pathlib import Path

import numpy as np
import pytest

from gridgen_sym import GridgenError, gradient, quality
from gridgen_sym.paper_examples import Case, Example, run
from gridgen_sym.paper_examples.adaptive import FRACTION, PRODUCT, ROOT_PRODUCT, STOP, STOP_NEGATIVE, spreads
from gridgen_sym.paper_examples.claim import better, decide

#: Section 3 of the paper runs once for all of these.
pytestmark = pytest.mark.slow

pytest.importorskip("matplotlib")

PICTURES = {
    "3_1_adaptive_area.png",
    "3_1_weight_modes.png",
    "3_2_winslow.png",
    "3_3_liao_area.png",
    "3_4_length_area_knupp.png",
    "3_5_length_knupp.png",
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("paper") / "made" / "by run"


@pytest.fixture(scope="module")
def said():
    return []


@pytest.fixture(scope="module")
def examples(folder, said) -> dict[str, Example]:
    return {example.section: example for example in run(folder, said.append)}


def verdicts(example: Example) -> dict[str, str]:
    return {claim.paper: claim.verdict for claim in example.claims}


def verdict(example: Example, words: str) -> str:
    (found,) = (v for paper, v in verdicts(example).items() if words in paper)
    return found


def test_pictures_are_written_and_are_png(examples, folder):
    assert {path.name for path in folder.iterdir()} == PICTURES | {"results.md"}
    for name in PICTURES:
        data = (folder / name).read_bytes()
        assert data.startswith(b"\x89PNG\r\n\x1a\n")
        assert len(data) > 20_000


def test_every_section_is_there_in_order(examples):
    assert list(examples) == ["3.1", "3.2", "3.3", "3.4", "3.5"]


def test_table_has_every_grid_and_every_claim(examples, folder, said):
    _, *sections = (folder / "results.md").read_text().split("\n## ")
    for example, section, screen in zip(examples.values(), sections, said[-6:-1], strict=True):
        assert section.startswith(f"{example.section} {example.title}\n")
        for case in example.cases:
            (row,) = (line for line in section.splitlines() if line.startswith(f"| {case.label} |"))
            assert f"{case.quality.folded_cells} of {case.quality.cells}" in row
            assert row.endswith({True: "| yes |", False: "| no |", None: "| – |"}[case.converged])
            assert case.label in screen
        for claim in example.claims:
            (row,) = (line for line in section.splitlines() if line.startswith(f"| {claim.paper} |"))
            assert row.endswith(f"| {claim.verdict} |")
            assert f"{claim.measured}.\n  The claim {claim.verdict}." in screen
        assert all(f"]({picture.file})" in section for picture in example.pictures)
        assert all(note in section and note in screen for note in example.notes)


def test_markdown_tables_are_rectangular(examples, folder):
    blocks = [b for b in (folder / "results.md").read_text().split("\n\n") if b.startswith("| ")]
    assert len(blocks) == 2 * len(examples)
    for block in blocks:
        assert len({line.replace("\\|", "").count("|") for line in block.splitlines()}) == 1


def test_progress_is_said_before_the_table(examples, said):
    assert [line[:3] for line in said[:6]] == ["3.1", "3.1", "3.2", "3.3", "3.4", "3.5"]
    assert "results.md" in said[-1]


def test_winslow_unfolds_the_swan(examples):
    example = examples["3.2"]
    assert example.case("transfinite interpolation").quality.folded_cells == 57
    winslow = example.case("Winslow")
    assert winslow.quality.folded_cells == 0
    assert example.cases[-1].converged
    assert example.cases[-1].quality.folded_cells == 0
    assert set(verdicts(example).values()) == {"holds"}


def test_liao_folds_and_modified_liao_does_not(examples):
    example = examples["3.3"]
    assert example.case("Liao").quality.folded_cells > 0
    assert example.case("modified Liao").quality.folded_cells == 0
    again = example.case("modified Liao, from Liao's grid")
    assert again.quality.folded_cells == 0
    np.testing.assert_allclose(again.grid.planes, example.case("modified Liao").grid.planes, atol=1e-4)
    assert verdict(example, "Liao functional folds") == "holds"
    assert verdict(example, "remove the inverted") == "holds"


def test_area_is_not_certainly_better_than_modified_liao(examples):
    example = examples["3.3"]
    area, modified = example.case("area (limit)").quality, example.case("modified Liao").quality
    assert area.min_jacobian > 1.3 * modified.min_jacobian
    assert area.mean_condition > 1.02 * modified.mean_condition
    assert verdict(example, "certainly better") == "holds in part"


def test_area_and_knupp_are_better_than_length(examples):
    assert verdict(examples["3.4"], "better than that by the length") == "holds"
    assert all(case.quality.valid for case in examples["3.4"].cases)


def test_length_folds_the_horseshoe_and_knupp_does_not(examples):
    example = examples["3.5"]
    assert example.case("length").quality.folded_cells > 100
    assert example.case("Knupp").quality.folded_cells == 0
    assert verdict(example, "superior") == "holds"


def test_first_weight_is_equidistributed_in_both_modes(examples):
    example = examples["3.1"]
    start, frozen, differentiated = (
        example.case(f"first weight, {name}") for name in ("start", "frozen", "differentiated")
    )
    assert frozen.extra[PRODUCT] < 0.55 * start.extra[PRODUCT]
    assert differentiated.extra[ROOT_PRODUCT] < 0.55 * start.extra[ROOT_PRODUCT]
    assert frozen.extra[PRODUCT] < differentiated.extra[PRODUCT]
    assert differentiated.extra[ROOT_PRODUCT] < frozen.extra[ROOT_PRODUCT]
    assert frozen.quality.valid
    assert differentiated.quality.valid
    assert frozen.energy < start.energy


def test_area_with_a_little_winslow_settles_to_a_grid_that_is_better_than_the_sweeps(examples):
    example = examples["3.1"]
    settled, swept = (example.case(f"first weight, {name}") for name in ("area and winslow", "frozen"))
    assert settled.converged
    assert settled.quality.valid
    assert settled.extra[PRODUCT] < 0.6 * example.case("first weight, start").extra[PRODUCT]
    assert settled.extra[PRODUCT] < swept.extra[PRODUCT]
    assert settled.quality.max_area_ratio < swept.quality.max_area_ratio


def test_too_many_sweeps_make_the_adapted_grid_ragged_and_that_is_said(examples):
    example = examples["3.1"]
    assert example.case("first weight, frozen, continued").extra[PRODUCT] > 0.6
    assert verdict(example, "robust") == "holds in part"
    assert "stopped" in example.setting


def test_negative_weight_is_refused_by_default(examples):
    (refusal,) = (note for note in examples["3.1"].notes if "By default" in note)
    assert "the weight must not be negative: it is -194.4" in refusal


def test_negative_weight_is_cautioned_when_insisted_on(examples):
    case = examples["3.1"].case("second weight, insisted on")
    assert "the energy has no lower bound" in case.message
    assert case.converged is False
    assert case.quality.valid
    assert case.energy < 0 < case.start_energy
    assert any("the energy has no lower bound" in note and "allow_negative" in note for note in examples["3.1"].notes)


def test_energy_of_the_negative_weight_is_unbounded_where_cells_may_fold(examples):
    case = examples["3.1"].case("second weight, differentiated, cells free to fold")
    assert case.energy < -1e3
    assert case.quality.folded_cells > 100
    assert verdict(examples["3.1"], "Implied") == "does not hold here"


def test_no_grid_of_the_sweeps_is_called_converged(examples):
    sweeps = [case for case in examples["3.1"].cases if "area and winslow" not in case.label]
    assert {case.converged for case in sweeps} == {None, False}


@pytest.mark.parametrize(("weight", "sweeps"), [("first", STOP), ("second", STOP_NEGATIVE)])
def test_the_claims_of_what_was_stopped_by_hand_state_the_sweeps(examples, weight, sweeps):
    (claim,) = (claim for claim in examples["3.1"].claims if f"({weight} weight, stopped by hand" in claim.paper)
    assert f"stopped by hand after {sweeps} sweeps" in claim.paper
    assert f"{sweeps} with the {weight}" in examples["3.1"].setting


def test_the_better_way_stands_beside_the_sweeps_and_is_better(examples):
    example = examples["3.1"]
    settled, swept = example.case("second weight, its positive part, area and winslow"), example.cases
    assert settled.converged
    assert settled.quality.valid
    assert settled.extra[FRACTION] > max(case.extra.get(FRACTION, 0) for case in swept if case is not settled)
    beside = [claim for claim in example.claims if "(not in the paper)" in claim.paper]
    assert [claim.verdict for claim in beside] == ["holds", "holds"]
    assert all("by area_winslow" in claim.paper for claim in beside)
    (picture,) = (picture for picture in example.pictures if picture.file == "3_1_adaptive_area.png")
    assert ["Better: area_winslow" in title for title, _ in picture.panels] == [False, False, True, True]


FUNCTIONALS = {
    "Winslow": "winslow",
    "Winslow (limit)": "winslow",
    "Liao": "liao",
    "modified Liao": "modified_liao",
    "modified Liao, from Liao's grid": "modified_liao",
    "area (limit)": "area",
    "length": "length",
    "Knupp": "knupp",
}


@pytest.mark.parametrize("section", ["3.2", "3.3", "3.4", "3.5"])
def test_converged_grids_are_stationary(examples, section):
    checked = 0
    for case in examples[section].cases:
        if case.converged:
            name = FUNCTIONALS[case.label]
            assert np.linalg.norm(gradient(case.grid, name)) * _spacing(case) < 1e-4 * case.energy
            checked += 1
        else:
            assert case.label in ("area", "Winslow", "transfinite interpolation")
            assert case.converged is not True
    assert checked >= 1


def _spacing(case: Case) -> float:
    return float(np.sqrt(quality(case.grid).mean_jacobian))


def test_swept_area_says_that_it_is_not_converged_and_its_limit_is(examples):
    for section in ("3.3", "3.4"):
        swept, limit = examples[section].case("area"), examples[section].case("area (limit)")
        assert swept.converged is False
        assert limit.converged is True
        assert limit.energy <= swept.energy
        assert any("has not converged for area" in note for note in examples[section].notes)


def test_two_runs_write_the_same_table(examples, folder, tmp_path):
    run(tmp_path, lambda _: None)
    assert (tmp_path / "results.md").read_bytes() == (folder / "results.md").read_bytes()


def test_verdicts_are_decided_by_the_conditions():
    assert decide("p", ("a", True), ("b", True)).verdict == "holds"
    assert decide("p", ("a", True), ("b", False)).verdict == "holds in part"
    assert decide("p", ("a", False)).verdict == "does not hold here"


def test_better_is_decided_by_the_measures(examples):
    length, knupp = (examples["3.5"].case(name) for name in ("length", "Knupp"))
    assert [wins for _, wins in better(knupp, length)] == [True]
    assert [wins for _, wins in better(length, knupp)] == [False]
    assert better(knupp, knupp) == [("Knupp against Knupp: alike in every measure", False)]


def test_spreads_of_a_uniform_grid_are_those_of_the_weight(examples):
    start = examples["3.1"].case("first weight, start").grid
    even = spreads(start, "4 + 0*x")
    assert even[PRODUCT] == pytest.approx(0, abs=1e-12)
    assert even[ROOT_PRODUCT] == pytest.approx(0, abs=1e-12)
    centers = (np.arange(29) + 0.5) / 29
    s = 1 + np.broadcast_to(centers[:, None], (29, 29))
    assert spreads(start, "1 + x")[PRODUCT] == pytest.approx(s.std() / s.mean())
    assert spreads(start, "1 + x")[ROOT_PRODUCT] == pytest.approx(np.sqrt(s).std() / np.sqrt(s).mean())


def test_folder_that_cannot_be_made_is_an_error_before_any_work(tmp_path: Path):
    (tmp_path / "file").write_text("")
    said: list[str] = []
    with pytest.raises(GridgenError, match="cannot make the folder"):
        run(tmp_path / "file", said.append)
    assert said == []
