"""A report as LaTeX: a section with numbered, labeled equations for an appendix, or a document of its own.

Labels are `sec:NAME` and `eq:NAME:WHAT`; nothing but amsmath is needed.
"""

from __future__ import annotations

from collections.abc import Iterator

import sympy
from sympy import Expr

from ...functionals.definition import Functional
from ...functionals.references import references_of
from ...functionals.variant import Variant
from ...version import __version__
from ..classify.classification import Classification, classify
from ..classify.equidistribution import equidistribution
from ..classify.principal_symbol import k1, k2
from ..coordinates import FIRST_DERIVATIVES, METRIC, J, s
from ..derive.continuous import EulerLagrange, euler_lagrange
from ..derive.discrete import corner_model
from . import findings, prose
from .breaking import Piece
from .description import sentence
from .displays import Equation, group, one
from .equations import Equations
from .fields import matrix_name, simple_control, what_drops_out
from .latex import latex_sentence
from .printer import latex, symbol_name
from .sections import moving_variants
from .tidy import tidy, tidy_quadratic

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
    rest = [*_corner(functional, equations), *_euler_lagrange(functional, "plain", equations)]
    rest += [*_classification(functional, equations), *_variants(functional, equations)]
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
    what = ["components of the metric tensor"] * bool(tensor) + ["Jacobian"] * jacobian
    verb = "are" if tensor else "is"
    if not metric:
        return _MAP
    shown = group(metric, equations.label("metric")) if len(metric) > 1 else one(metric[0])
    return f"{_MAP} The {prose.listed(what)} {verb}\n{shown}"


def _weightless(functional: Functional, text: str) -> str:
    return f"With $s = 1$, {text}" if functional.expression().has(s) else text[0].upper() + text[1:]


def _corner(functional: Functional, equations: Equations) -> Iterator[str]:
    """Yield the corner energy and its derivatives."""
    model = corner_model(functional, "plain")
    yield "\\subsection{Discrete energy}"
    energy = one(equations.named("energy", "E", model.energy))
    yield f"{_CORNER} {_weightless(functional, 'the corner energy is')}\n{energy}"
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


def _euler_lagrange(functional: Functional, variant: Variant, equations: Equations) -> Iterator[str]:
    """Yield the Euler-Lagrange equations of a variant."""
    derived, plain = equations.equation(euler_lagrange(functional, variant)), variant == "plain"
    tail = "" if plain else f"-{variant}"
    yield "\\subsection{Euler--Lagrange equations}" if plain else f"\\subsection{{{prose.variant_title(variant)}}}"
    yield prose.joined(prose.held(functional, variant))
    head = "a stationary map satisfies, in divergence form,"
    forms = [equations.divergence(derived, row, f"divergence-{r}{tail}") for row, r in enumerate("xy")]
    head = _weightless(functional, head) if plain else head.capitalize()
    yield f"{head}\n{group(forms, equations.label(f'divergence{tail}'))}"
    forms = [equations.expanded(derived, row, f"expanded-{r}{tail}") for row, r in enumerate("xy")]
    yield f"Expanded, these equations are\n{group(forms, equations.label(f'expanded{tail}'))}"
    yield _reduced(derived, tail, equations)


def _reduced(derived: EulerLagrange, tail: str, equations: Equations) -> str:
    """Return the simpler system that the equations are equivalent to; nothing where none was found."""
    if derived.reduction is None:
        return ""
    reduction, name = derived.reduction, matrix_name(derived.functional)
    operator = reduction.operator
    matrix = equations.matrix(f"matrix{tail}", name, operator.matrix.applyfunc(tidy), ",", entry=name.lower())
    determinant = one(equations.named(f"determinant{tail}", rf"\det {name}", operator.determinant), ",")
    system = [
        equations.named(f"reduced-{r}{tail}", f"w_{r}", part) for r, part in zip("xy", reduction.system, strict=True)
    ]
    reference = equations.reference(f"expanded{tail}")
    return (
        f"The left sides of {reference} are the components of ${name} \\, (w_x, w_y)^T$, where the matrix\n{matrix}\n"
        f"has the determinant\n{determinant}\nand\n{group(system, equations.label(f'reduced{tail}'))}\n"
        f"Wherever $\\det {name}$ is not zero, the equations {reference} hold if and only if $w_x = w_y = 0$ (proved)."
        f"{_control(derived, tail, equations)}"
    )


def _control(derived: EulerLagrange, tail: str, equations: Equations) -> str:
    """Return the control functions of a reduced system; nothing where it has none."""
    control = derived.reduction.control if derived.reduction else None
    if control is None:
        return ""
    functions = [equations.named(f"control-{n}{tail}", n, part) for n, part in zip("PQ", control, strict=True)]
    shown = group(functions, equations.label(f"control{tail}"))
    text = (
        " The terms of first order are $\\alpha P r_\\xi + \\gamma Q r_\\eta$, where $\\alpha$ and $\\gamma$ multiply"
    )
    text += f" $r_{{\\xi\\xi}}$ and $r_{{\\eta\\eta}}$ for $r = x, y$, with the control functions\n{shown}"
    simple = simple_control(derived)
    if simple is None:
        return text
    where = " = ".join([*map(symbol_name, simple[0]), "0"])
    values = " and ".join(f"${n} = {latex(part)}$" for n, part in zip("PQ", simple[1], strict=True))
    return f"{text}\nWhere ${where}$, they are {values}."


def _classification(functional: Functional, equations: Equations) -> Iterator[str]:
    """Yield the principal symbol, the type of the equations and the properties of the density."""
    found = classify(functional)
    yield "\\subsection{Classification}"
    whole = equations.indicators.write(found.symbol)
    entries = whole.applyfunc(lambda entry: tidy_quadratic(entry, (k1, k2)))
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
    return sympy.factor_terms(equations.indicators.write(found.determinant))


def _variants(functional: Functional, equations: Equations) -> Iterator[str]:
    """Yield the equations with a weight, or with fields that move, and the law that their solutions follow."""
    for variant in moving_variants(functional):
        yield from _euler_lagrange(functional, variant, equations)
        law = equidistribution(functional, variant)
        if law is not None:
            c = one(equations.named(f"law-{variant}", "c", law.law), "")
            q = one(equations.named(f"multiplier-{variant}", "q", law.multiplier))
            reference = equations.reference(f"expanded-{variant}")
            yield (
                f"Multiplied by $A^T / J$, where $A$ is the Jacobian matrix of the map, the left sides of {reference} "
                f"are the components of $q \\, (c_\\xi, c_\\eta)^T$ with\n{c}\nand\n{q}\nStationary maps keep $c$ "
                "constant (proved)."
            )
