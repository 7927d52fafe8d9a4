"""A report as LaTeX: a section with numbered, labeled equations for an appendix, or a document of its own.

Labels are `sec:NAME` and `eq:NAME:WHAT`; nothing but amsmath is needed.
"""

from __future__ import annotations

from collections.abc import Iterator

import sympy
from sympy import Expr

from ...functionals.definition import Functional
from ...functionals.references import references_of
from ...version import __version__
from ..classify.classification import Classification, classify
from ..classify.principal_symbol import k1, k2
from ..coordinates import FIRST_DERIVATIVES, METRIC, J
from ..derive.discrete import corner_model
from . import findings, prose
from .breaking import Piece
from .description import sentence
from .displays import Equation, group, one
from .equations import Equations
from .fields import what_drops_out
from .latex import latex_sentence
from .printer import symbol_name
from .stationary import stationary, stationary_variants, weightless
from .tidy import tidy_quadratic, without_common_terms

_INTEGRAL = r"\int_0^1 \int_0^1 F \, d\xi \, d\eta"
_MAP = r"""Let $x(\xi, \eta)$ and $y(\xi, \eta)$ map the unit square onto the domain. Subscripts denote partial
derivatives, such as $x_\xi = \partial x / \partial \xi$ and
$x_{\xi\eta} = \partial^2 x / \partial \xi \, \partial \eta$."""
_CORNER = r"""The discrete functional is, up to a constant factor, the sum of a corner energy $E$ over the corners of
all cells. At a corner, $x_\xi$, $y_\xi$, $x_\eta$ and $y_\eta$ are one-sided difference quotients along the two edges
that meet there, in the direction of increasing $\xi$ and $\eta$; on a valid grid, $J > 0$ at every corner."""
_SPLITTING = r"""Write $E = P(A, J)$ with the Jacobian matrix $A$ of the map and with $J = \det A$ as an argument of
its own. Without the term $(\partial P / \partial J) \, \partial^2 J$ the Hessian is the matrix $H^+$ with the
entries"""


def fragment(functional: Functional) -> str:
    r"""Return the report as a section of LaTeX that any document with amsmath can \input."""
    name, entries = functional.name, _bibtex(functional)
    head = f"% The functional {name}, derived by gridgen-sym {__version__}. The document must load amsmath.\n"
    sources = "".join(f"% {line}\n" for line in ["BibTeX entries of the sources:", *entries.split("\n")] if entries)
    parts = "\n\n".join(part for part in _parts(functional) if part)
    return f"{head}\\begingroup\n\\allowdisplaybreaks\n{parts}\n\\endgroup\n{sources}"


def document(functional: Functional) -> str:
    """Return the report as a document that compiles by itself, with its bibliography."""
    name, entries = functional.name, _bibtex(functional)
    file = f"\\begin{{filecontents*}}{{{name}.bib}}\n{entries}\n\\end{{filecontents*}}\n" if entries else ""
    end = f"\\bibliographystyle{{plain}}\n\\bibliography{{{name}}}\n" if entries else ""
    start = "\\documentclass{article}\n\\usepackage[utf8]{inputenc}\n\\usepackage{amsmath}\n\\begin{document}\n"
    return f"{file}{start}{fragment(functional)}{end}\\end{{document}}\n"


def _bibtex(functional: Functional) -> str:
    return "\n".join(reference.bibtex() for reference in references_of(functional))


def _parts(functional: Functional) -> Iterator[str]:
    """Yield the paragraphs; the notation is that of the symbols which the others use."""
    equations = Equations(functional.name)
    density = one(equations.named("density", "F", functional.expression()))
    rest = [*_corner(functional, equations), *stationary(functional, "plain", equations)]
    rest += [*_classification(functional, equations), *stationary_variants(functional, equations)]
    name = functional.name.replace("_", r"\_")
    yield f"\\section{{The functional \\texttt{{{name}}}}}\n\\label{{sec:{functional.name}}}"
    yield prose.joined([sentence(functional.description), prose.source(functional)])
    yield "\\subsection{Density}"
    yield _notation(equations)
    integral = one(Equation(equations.label("integral"), "I", (Piece(_INTEGRAL),)), ",")
    yield f"The functional is\n{integral}\nwith the density\n{density}"
    yield prose.joined([*prose.fields(functional), prose.parameters(functional), equations.indicators.sentence()])
    yield from rest


def _notation(equations: Equations) -> str:
    """Return the definitions of the metric's components that the report uses."""
    used = [name for name in METRIC if name in equations.used]
    metric = [equations.named(str(name), symbol_name(name), METRIC[name]) for name in used]
    tensor, jacobian = [name for name in used if name != J], J in used
    what = ["the components of the metric tensor"] * bool(tensor) + ["the Jacobian"] * jacobian
    verb = "are" if tensor else "is"
    if not metric:
        return _MAP
    shown = group(metric, equations.label("metric")) if len(metric) > 1 else one(metric[0])
    head = prose.listed(what)
    return f"{_MAP} {head[0].upper()}{head[1:]} {verb}\n{shown}"


def _corner(functional: Functional, equations: Equations) -> Iterator[str]:
    """Yield the corner energy and its derivatives."""
    model = corner_model(functional, "plain")
    yield "\\subsection{Discrete energy}"
    energy = one(equations.named("energy", "E", model.energy))
    yield f"{_CORNER} {weightless(functional, 'the corner energy is')}\n{energy}"
    slopes = [
        equations.named(f"energy-{p}", rf"\frac{{\partial E}}{{\partial {symbol_name(p)}}}", equations.tidied(part))
        for p, part in zip(FIRST_DERIVATIVES, model.gradient, strict=True)
    ]
    yield f"Its gradient is\n{group(slopes, equations.label('gradient'))}"
    left = r"\frac{{\partial^2 E}}{{\partial {} \, \partial {}}}"
    entries = equations.entries("hessian", left, equations.tidied(model.hessian))
    yield f"The Hessian is symmetric, with the entries\n{group(entries, equations.label('hessian'))}"
    kept = equations.entries("semidefinite", r"H^+_{{{}\,{}}}", equations.tidied(model.semidefinite_hessian))
    yield f"{_SPLITTING}\n{group(kept, equations.label('semidefinite'))}"
    yield findings.splitting(functional, model.splitting)


def _classification(functional: Functional, equations: Equations) -> Iterator[str]:
    """Yield the principal symbol, the type of the equations and the properties of the density."""
    found = classify(functional)
    yield "\\subsection{Classification}"
    whole = equations.indicators.write(found.symbol)
    entries = whole.applyfunc(lambda entry: tidy_quadratic(entry, k1, k2))
    symbol = equations.matrix("symbol", "A(k)", entries, ".", entry="a")
    determinant = equations.named("symbol-determinant", r"\det A(k)", _determinant(found, symbol, equations))
    yield prose.joined(
        [
            findings.judged_at(functional),
            f"The principal symbol of the Euler--Lagrange equations in the direction $k = (k_1, k_2)$ is\n{symbol}",
        ]
    )
    yield f"Its determinant is\n{one(determinant)}"
    yield prose.joined(
        [
            findings.type_of_equations(found, equations.reference("expanded")),
            *findings.properties(found),
            *map(latex_sentence, what_drops_out(functional)),
        ]
    )


def _determinant(found: Classification, symbol: str, equations: Equations) -> Expr:
    """Return the determinant of the symbol: by the names of its entries, where these are shown and it is no simpler."""
    (a, b), (c, d) = found.symbol.tolist()
    if found.determinant == a * d - b * c and "a_{11}" in symbol:
        a, b, d = (sympy.Symbol(f"a{place}") for place in ("11", "12", "22"))
        return a * d - b**2
    return without_common_terms(equations.indicators.write(found.determinant))
