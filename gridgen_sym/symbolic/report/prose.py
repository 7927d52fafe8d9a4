"""The sentences of a report in LaTeX that say what a functional is: sources, parameters, fields, variants."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import sympy

from ...functionals.bibliography import PAPER
from ...functionals.definition import Functional
from ...functionals.expression import comparisons, names_in
from ...functionals.field_kinds import components
from ...functionals.metric import TARGET_NAMES, symbol
from ...functionals.references import references_of
from ...functionals.variant import Modes, Variant
from ..coordinates import s
from .latex import latex_sentence
from .printer import latex, symbol_name

_RELATIONS = {">=": r"\ge", "<=": r"\le", "==": "=", ">": ">", "<": "<"}
_FIELD = {
    "scalar": "a scalar",
    "vector": "a vector",
    "symmetric": "symmetric and positive definite",
    "matrix": "a matrix",
}


def listed(parts: Sequence[str], word: str = "and") -> str:
    """Return `a`, `a and b` or `a, b and c`."""
    return f" {word} ".join(part for part in (", ".join(parts[:-1]), *parts[-1:]) if part)


def joined(sentences: Iterable[str]) -> str:
    """Return sentences as a paragraph."""
    return "\n".join(text for text in sentences if text)


def names(which: Iterable[str]) -> str:
    """Return names of the code as a list of symbols."""
    return listed([f"${symbol_name(symbol(name))}$" for name in which])


def source(functional: Functional) -> str:
    """Return the sentence that cites the sources of a functional; nothing where none is known."""
    cited = []
    for reference in references_of(functional):
        place = latex_sentence(functional.reference).replace("Section ", "Section~")
        cited.append(rf"\cite{f'[{place}]' if reference is PAPER else ''}{{{reference.key}}}")
    return f"See~{listed(cited)}." if cited else ""


def parameters(functional: Functional) -> str:
    """Return the sentence on the parameters, their default values and their constraints."""
    if not functional.parameters:
        return ""
    values = [f"${symbol_name(symbol(name))} = {short_number(value)}$" for name, value in functional.parameters.items()]
    rules = [rule for rule, of in constraints(functional) if not of & {*functional.components}]
    plural = len(values) > 1
    head = (
        f"The parameters have the default values {listed(values)}"
        if plural
        else f"The default value of the parameter is {values[0]}"
    )
    rest = f"; they must meet {listed(rules)}" if plural else f"; it must meet {listed(rules)}"
    return f"{head}{rest if rules else ', without constraints'}."


def fields(functional: Functional) -> Iterator[str]:
    """Yield the sentences on the weight, the declared fields and the target that a density names."""
    named = functional.expression().free_symbols
    if s in named:
        yield "The weight is $s > 0$."
    for name, kind in functional.fields.items():
        parts = components(name, kind)
        of = f", with the components {names(parts)}" if len(parts) > 1 else ""
        yield f"The field ${symbol_name(symbol(name))}$ is {_FIELD[kind]}{of}."
    rules = [rule for rule, of in constraints(functional) if of & {*functional.components}]
    if rules:
        yield f"The fields must meet {listed(rules)}."
    targets = [name for name in TARGET_NAMES if symbol(name) in named]
    if targets:
        yield (
            f"By {names(targets)} we denote the metric and the Jacobian of $A W^{{-1}}$, with the Jacobian matrix $A$ "
            "of the map and a target matrix $W$; in what follows, $W$ is the unit matrix."
        )


def constraints(functional: Functional) -> Iterator[tuple[str, set[str]]]:
    """Yield the constraints as formulas, each with the names of the code that are in it."""
    known = {name: symbol(name) for name in (*functional.parameters, *functional.components)}
    for constraint in functional.constraints:
        text = ""
        for part in comparisons(constraint, known, sympy.Rational):
            left = text or latex(sympy.sympify(part.left))
            text = f"{left} {_RELATIONS[part.sign]} {latex(sympy.sympify(part.right))}"
        yield f"${text}$", {*names_in(constraint)}


def short_number(value: float) -> str:
    """Return a number with at most six digits."""
    digits, _, power = f"{value:.6g}".partition("e")
    return rf"{digits} \cdot 10^{{{int(power)}}}" if power else digits


def variant_title(variant: Variant) -> str:
    """Return the heading of the equations of a variant, such as `Frozen weight`."""
    modes = Modes.read(variant)
    moving = [f"${symbol_name(symbol(name))}$" for name in modes.differentiated]
    parts = [f"{modes.weight} weight"] if modes.weight else []
    parts += [f"differentiated field{'s' if len(moving) > 1 else ''} {listed(moving)}"] if moving else []
    title = listed(parts)
    return title[:1].upper() + title[1:]


def held(functional: Functional, variant: Variant) -> Iterator[str]:
    """Yield what the weight and the fields are in a variant, and how their derivatives are written."""
    modes = Modes.read(variant)
    moving = [*(["s"] if modes.weight == "differentiated" else []), *modes.differentiated]
    fixed = [*(["s"] if modes.weight == "frozen" else []), *(name for name in functional.fields if name not in moving)]
    if fixed:
        first = symbol_name(symbol(_first(functional, fixed[0]) + "_xi"))
        yield (
            f"Here {names(fixed)} {_are(fixed)} of $(\\xi, \\eta)$, evaluated at the nodes and held during a solve; "
            f"derivatives are written like ${first}$."
        )
    if moving:
        first = symbol_name(symbol(_first(functional, moving[0]) + "_x"))
        yield (
            f"Here {names(moving)} {_are(moving)} of $(x, y)$ that the equations differentiate; derivatives are "
            f"written like ${first}$."
        )


def _are(which: Sequence[str]) -> str:
    return "is a given function" if len(which) == 1 else "are given functions"


def _first(functional: Functional, name: str) -> str:
    return components(name, functional.fields[name])[0] if name in functional.fields else name
