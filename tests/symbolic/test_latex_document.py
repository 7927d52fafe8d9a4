"""The LaTeX of a report: numbered and labeled equations that say what was derived, words that say how it is known."""

from __future__ import annotations

import re

import pytest
import sympy
from support import BUILTIN, LITERATURE

from gridgen_sym.functionals import functional
from gridgen_sym.functionals.bibliography import REFERENCES
from gridgen_sym.functionals.definition import Functional
from gridgen_sym.functionals.metric import TARGET_NAMES
from gridgen_sym.functionals.references import SOURCES, references_of
from gridgen_sym.functionals.registry import literature_sources
from gridgen_sym.symbolic import classify, corner_model, derive_latex, euler_lagrange
from gridgen_sym.symbolic.coordinates import FIRST_DERIVATIVES, METRIC, SECOND_DERIVATIVES
from gridgen_sym.symbolic.definiteness import almost_everywhere
from gridgen_sym.symbolic.report import prose
from gridgen_sym.symbolic.report.description import sentence
from gridgen_sym.symbolic.report.sections import moving_variants
from tests.support_latex import Value, check, equations, rows, visible

OWN = {
    "rough": Functional(
        "rough", "k*exp(g12) - sqrt(g22)*abs(g11 - g22)", parameters={"k": 1.5}, description="50% & J²"
    ),
    "field": Functional("field", "s*M12*J**2 - M11*g11 + x*xi*g22", fields={"M": "symmetric"}),
    "two": Functional("two", "a*g11 + b*g22", parameters={"a": 1e-9, "b": 2}, constraints=("a > 0", "0 < b <= 3")),
    "choice": Functional("choice", "max(0, k - J)**2 + where(g11 > g22, g11, 2*g22)", parameters={"k": 0.9}),
    "null": Functional("null", "3*J"),
}
QUICK = ("length", "knupp", "two", "null")
#: Of the literature, those that are derived within a second.
CHEAP = ("riemannian_length", "area_at_corners", "unam_area", "tmop_14", "tmop_55", "tmop_56")
#: The reports of the others take many seconds each; the page of every functional is tested in words.
SHORT = tuple(name for name in BUILTIN if name not in ("area_winslow", "modified_liao"))
CASES = [pytest.param(name, marks=() if name in QUICK else pytest.mark.slow) for name in (*SHORT, *CHEAP, *OWN)]


def known(name):
    return OWN.get(name) or functional(name)


@pytest.mark.slow
@pytest.mark.parametrize("name", CASES)
def test_a_fragment_is_latex_whose_lines_fit_and_whose_equations_are_those_derived(name):
    latex = derive_latex(known(name))
    check(latex)
    assert max(map(visible, rows(latex))) <= 66
    shown = equations(latex)
    assert all(label.startswith(f"eq:{name}:") for label in shown)
    values = point(name)
    expected = {label: number(expression, values) for label, expression in derived(known(name)).items()}
    compared = {label.removeprefix(f"eq:{name}:"): sides for label, sides in shown.items()}
    assert expected.keys() <= compared.keys()
    places = ((0, 0), (0, 1), (1, 1))
    values |= {f"a{i + 1}{j + 1}": number(classify(known(name)).symbol[i, j], values) for i, j in places}
    for name_of_indicator, left, sign, right in re.findall(
        r"\$(\\theta_\{\d\}) = 1\$ where \$(.*?) ([<>]) (.*?)\$", latex
    ):
        below, above = (Value(side, values).result for side in ((left, right) if sign == "<" else (right, left)))
        values["theta" + name_of_indicator[8:-1]] = float(below < above)
    for label, value in expected.items():
        left, right = compared[label]
        text = left if right == "0" and "expanded" in label else right
        assert Value(text, values).result == pytest.approx(value, rel=1e-9, abs=1e-9), (label, text)


def point(name):
    """Return values of all symbols with J > 0."""
    jets = {str(p): 0.3 + 0.37 * k for k, p in enumerate((*FIRST_DERIVATIVES, *SECOND_DERIVATIVES))}
    jets |= {"y_eta": 1.9, "x_eta": -0.4}
    values = {
        str(m): float(meaning.subs({p: jets[str(p)] for p in FIRST_DERIVATIVES})) for m, meaning in METRIC.items()
    }
    values |= dict(zip(TARGET_NAMES, values.values(), strict=True))
    assert values["J"] > 0
    definition = known(name)
    others = [*definition.parameters, *definition.components, "s", "x", "y", "xi", "eta", "k1", "k2"]
    others += [f"{v}_{tail}" for v in ("s", *definition.components) for tail in ("xi", "eta", "x", "y")]
    return jets | values | {v: 0.8 + 0.11 * k for k, v in enumerate(others)} | dict(definition.parameters)


def number(expression, values):
    """Return the value of an expression; choices are decided by SymPy."""
    return float(
        sympy.sympify(expression).xreplace(
            {v: sympy.Float(values[str(v)]) for v in sympy.sympify(expression).free_symbols}
        )
    )


def derived(definition):
    """Return what the equations must show, by the ends of their labels."""
    model, found = corner_model(definition, "plain"), classify(definition)
    p = FIRST_DERIVATIVES
    result = {"density": definition.expression(), "energy": model.energy, "symbol-determinant": found.determinant}
    result |= {f"energy-{v}": slope for v, slope in zip(p, model.gradient, strict=True)}
    for label, matrix in (("hessian", model.hessian), ("semidefinite", model.semidefinite_hessian)):
        whole = almost_everywhere(matrix)
        result |= {f"{label}-{p[i]}-{p[j]}": whole[i, j] for i in range(4) for j in range(i, 4)}
    for variant in ("plain", *moving_variants(definition)):
        tail = "" if variant == "plain" else "-frozen" if variant == "frozen" else "-differentiated"
        equation = euler_lagrange(definition, variant)
        result |= {
            f"expanded-{r}{tail}": almost_everywhere(part) for r, part in zip("xy", equation.residual, strict=True)
        }
        if equation.reduction:
            result |= {f"reduced-{r}{tail}": w for r, w in zip("xy", equation.reduction.system, strict=True)}
            result |= {f"determinant{tail}": equation.reduction.operator.determinant}
    return result


@pytest.mark.parametrize("name", ["length", "knupp", "null", pytest.param("field", marks=pytest.mark.slow)])
def test_the_symbols_that_are_used_are_defined_and_no_others(name):
    latex = derive_latex(known(name))
    shown = equations(latex)
    defined = {str(m) for m in METRIC if f"eq:{name}:{m}" in shown}
    text = " ".join(right + left for label, (left, right) in shown.items() if label.split(":")[-1] not in defined)
    symbols = {"g11": "g_{11}", "g22": "g_{22}", "g12": "g_{12}", "J": "J"}
    assert defined == {m for m, sign in symbols.items() if sign in text}
    for sign, words in {"M_{12}": "The field $M$ is symmetric", " s ": "The weight is $s > 0$"}.items():
        assert (sign in text) == (words in latex)


def test_every_statement_says_how_it_is_known():
    claims = ("is positive semidefinite", "are linear and", "invariant under", "homogeneous of", "barrier", r"\ge")
    latex = derive_latex(functional("length")).split("Discrete energy")[1]
    for claim in claims:
        (sentence,) = re.findall(
            rf"[^.]*{re.escape(claim)}[^.]*\.", re.sub(r"\\begin.*?\\end\{\w+\}", "", latex, flags=re.S)
        )
        assert re.search(r"\((proved|by the limit at one pair of lengths)\)", sentence)


def test_parameters_and_constraints_are_in_words():
    text = derive_latex(OWN["two"])
    assert r"default values $a = 1 \cdot 10^{-9}$ and $b = 2$; they must meet $a > 0$ and $0 < b \le 3$." in text
    one = derive_latex(Functional("one", "k*g11", parameters={"k": 1.5}))
    assert "The default value of the parameter is $k = 1.5$, without constraints." in one
    assert "vanish identically (proved): $F$ is a null Lagrangian" in derive_latex(OWN["null"])


@pytest.mark.parametrize("name", [*BUILTIN, *LITERATURE])
def test_the_words_on_every_functional_are_latex(name):
    """Description, parameters, constraints and fields: what depends on no derivation."""
    definition = functional(name)
    check(prose.joined([sentence(definition.description), *prose.fields(definition), prose.parameters(definition)]))
    references = "".join(f"% {line}\n" for one in references_of(definition) for line in one.bibtex().split("\n"))
    check(f"{references}{prose.source(definition)}")


def test_formulas_in_a_description_are_formulas():
    assert sentence("Half: (J² + g12²)/4 = g11 g22/4") == r"Half: $(J^2 + g_{12}^2)/4 = g_{11} g_{22}/4$."
    assert sentence("Stretched by p(xi); J > 0.") == r"Stretched by p($\xi$); $J > 0$."
    assert sentence("Where (as J) > 0 (or so), J**2") == "Where (as $J$) $>$ 0 (or so), $J^2$."
    assert sentence("Just a model") == "Just a model."
    assert sentence("") == ""


def test_a_kink_is_reported():
    text = derive_latex(Functional("kinked", "g11 + g22 + abs(g12)"))
    assert "jump or do not exist where $g_{12} = 0$ (sampled)" in text
    assert r"\delta" not in text


def test_sources_are_cited_and_those_of_the_library_are_complete():
    for name in (*BUILTIN, *LITERATURE):
        assert references_of(functional(name))
    used = [*SOURCES.values(), *map(literature_sources, LITERATURE)]
    assert {key for keys in used for key in keys} == {*REFERENCES}
    for reference in REFERENCES.values():
        assert {"author", "title", "year"} <= {*reference.fields}
        assert reference.bibtex().count("{") == reference.bibtex().count("}")
    length = derive_latex(functional("length"))
    assert r"See~\cite[Section~2.2]{khattri2006}, \cite{steinberg1986} and \cite{castillo1991}." in length
    assert "% @misc{khattri2006,\n%   author = {Khattri, Sanjay Kumar},\n" in length
    assert "\\cite" not in derive_latex(OWN["null"])
    own = Functional("own", "g11", reference="A & B, 2001")
    assert "% @misc{own,\n%   note = {A \\& B, 2001},\n" in derive_latex(own)


def test_a_document_is_complete():
    text = derive_latex(functional("length"), complete=True)
    assert text.startswith("\\begin{filecontents*}{length.bib}\n@misc{khattri2006,")
    assert "\\documentclass{article}\n" in text
    assert text.endswith("\\bibliographystyle{plain}\n\\bibliography{length}\n\\end{document}\n")
    assert "bib" not in derive_latex(OWN["null"], complete=True).replace("BibTeX", "")


def test_the_reader_objects():
    latex = derive_latex(OWN["null"])
    check(latex)
    for old, new in (
        ("{", ""),
        (r"\end{align}", ""),
        (r"\partial", r"\Partial"),
        (r"\label{eq:null:expanded}", ""),
        ("Jacobian", "Jacobián"),
        ("$F$", "$F"),
    ):
        assert old in latex
        with pytest.raises((AssertionError, IndexError)):
            check(latex.replace(old, new, 1))
    values = {"J": 2.0, "g11": 3.0}
    assert Value(r"- \frac{g_{11}}{J^{2}} + 2 \left(J - 1\right)^{3/2}", values).result == 1.25
    assert equations(derive_latex(OWN["null"]))["eq:null:density"] == ("F", "3 J")


def test_a_changed_sign_is_found():
    """The comparison of values objects to a printer that loses a sign."""
    latex = derive_latex(functional("length"))
    shown = equations(latex)["eq:length:expanded-x"][0]
    values = point("length")
    right = number(euler_lagrange(functional("length"), "plain").residual[0], values)
    assert Value(shown, values).result == pytest.approx(right)
    assert Value(shown.replace("+", "-"), values).result != pytest.approx(right)
