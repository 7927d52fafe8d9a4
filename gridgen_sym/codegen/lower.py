"""From expressions to a `Program`: metric first, then common subexpressions, then powers as products."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence

import sympy
from sympy import Expr, Symbol

from ..functionals.choices import as_choices
from ..symbolic.coordinates import ALONG, DEFINITIONS
from ..symbolic.definiteness import almost_everywhere
from .kernel import Assignment, Program, reciprocal

#: Whole powers up to this one become products; larger ones call pow.
LARGEST_PRODUCT = 8


def lower(
    name: str,
    inputs: Sequence[Symbol],
    parameters: Sequence[Symbol],
    outputs: Mapping[str, Expr],
    fields: Iterable[Symbol] = (),
    names: Mapping[Symbol, Expr] | None = None,
) -> Program:
    """Lower named expressions to straight-line arithmetic.

    Metric symbols (chi and those of a target, too) are computed first, where they are needed; subexpressions that
    occur twice are computed once; negative powers become one division; small powers become products.

    Args:
        name: of the program.
        inputs: its arguments.
        parameters: of the functional.
        outputs: what it computes, by name.
        fields: inputs whose names are a user's: the components of declared fields and their derivatives.
        names: what further symbols stand for, each after those that it is made of.
    """
    # A prefix keeps a user's parameter, or field, from having the name of a temporary or of a result.
    prefixed = {symbol: f"parameter_{symbol.name}" for symbol in parameters}
    prefixed |= {symbol: f"field_{symbol.name}" for symbol in fields}
    renamed = {symbol: sympy.Symbol(name, real=True) for symbol, name in prefixed.items()}
    outputs = {key: sympy.sympify(value).xreplace(renamed) for key, value in outputs.items()}
    parameters, inputs = (tuple(renamed.get(symbol, symbol) for symbol in given) for given in (parameters, inputs))
    # Each metric symbol is a name of its own, so its definition is one assignment and not expanded.
    definitions = _definitions(outputs.values(), {**DEFINITIONS, **ALONG, **(names or {})}, set(inputs))
    wanted = [*(meaning.xreplace(renamed) for meaning in definitions.values()), *outputs.values()]
    prepared = [_without_negative_powers(expression) for expression in wanted]
    temporaries = (sympy.Symbol(f"t{k}", real=True) for k in range(10**6))
    shared, reduced = sympy.cse(prepared, symbols=temporaries, order="canonical")
    named = [
        *zip(definitions, reduced[: len(definitions)], strict=True),
        *(
            (sympy.Symbol(key, real=True), value)
            for key, value in zip(outputs, reduced[len(definitions) :], strict=True)
        ),
    ]
    ordered = _order(shared, named, set(inputs) | set(parameters))
    assignments = tuple(_products(ordered))
    return Program(
        name=name,
        inputs=tuple(symbol.name for symbol in inputs),
        parameters=tuple(symbol.name for symbol in parameters),
        outputs=tuple(outputs),
        assignments=assignments,
        operations=count_operations(assignments),
    )


def _definitions(
    expressions: Iterable[Expr], meanings: Mapping[Symbol, Expr], given: set[Symbol]
) -> dict[Symbol, Expr]:
    """Return the definitions that the expressions need, in order of evaluation."""
    needed = set().union(*(expression.free_symbols for expression in expressions)) - given
    for symbol in reversed(list(meanings)):
        if symbol in needed:
            needed |= meanings[symbol].free_symbols
    return {symbol: meaning for symbol, meaning in meanings.items() if symbol in needed}


def _without_negative_powers(expression: Expr) -> Expr:
    """Write x**-n as reciprocal(x)**n, so that one division serves all powers."""
    return as_choices(almost_everywhere(expression)).replace(
        lambda node: isinstance(node, sympy.Pow) and node.exp.is_Rational and node.exp < 0,
        lambda node: (
            reciprocal(node.base) ** -node.exp
            if node.exp.is_Integer
            else reciprocal(sympy.sqrt(node.base)) ** (-2 * node.exp)
        ),
    )


def _order(
    shared: Sequence[tuple[Symbol, Expr]], named: Sequence[tuple[Symbol, Expr]], given: set[Symbol]
) -> list[tuple[Symbol, Expr]]:
    """Put assignments in an order in which every name is assigned before it is used.

    The metric symbols are both results and names that shared subexpressions use, so the two lists interleave.
    """
    waiting, known, result = [*shared, *named], set(given), []
    while waiting:
        for k, (symbol, value) in enumerate(waiting):
            if value.free_symbols <= known:
                result.append(waiting.pop(k))
                known.add(symbol)
                break
        else:
            raise AssertionError(f"circular or undefined: {waiting}, known {known}")
    return result


def _products(assignments: Sequence[tuple[Symbol, Expr]]) -> Iterable[Assignment]:
    """Yield the assignments with the base of every small power a name, so that it prints as a product."""
    bases: dict[Expr, Symbol] = {}
    for symbol, value in assignments:
        for power in sorted(value.atoms(sympy.Pow), key=sympy.default_sort_key):
            base, exponent = power.args
            if exponent.is_Integer and 2 <= exponent <= LARGEST_PRODUCT and not base.is_Symbol:
                if base not in bases:
                    bases[base] = sympy.Symbol(f"b{len(bases)}", real=True)
                    yield Assignment(bases[base].name, base)
                value = value.subs(power, bases[base] ** exponent)
        yield Assignment(symbol.name, value)


def count_operations(assignments: Iterable[Assignment]) -> dict[str, int]:
    """Return the number of additions, multiplications, divisions and function calls."""
    count: Counter[str] = Counter()
    for assignment in assignments:
        for node in sympy.preorder_traversal(assignment.value):
            if isinstance(node, sympy.Add):
                count["additions"] += len(node.args) - 1
            elif isinstance(node, sympy.Mul):
                count["multiplications"] += len(node.args) - 1 - (node.args[0] == -1)
            elif isinstance(node, sympy.Pow) and node.exp.is_Integer and 2 <= node.exp <= LARGEST_PRODUCT:
                count["multiplications"] += int(node.exp) - 1
            elif isinstance(node, reciprocal):
                count["divisions"] += 1
            elif isinstance(node, (sympy.Pow, sympy.Function)):
                count["functions"] += 1
    return {kind: count[kind] for kind in ("additions", "multiplications", "divisions", "functions")}
