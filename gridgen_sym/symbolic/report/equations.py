"""The equations of a report on one functional, labeled and in pieces; what is shown is remembered for the notation."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import sympy
from sympy import Expr, Symbol

from ..coordinates import FIRST_DERIVATIVES
from ..definiteness import almost_everywhere
from ..derive.continuous import EulerLagrange
from .breaking import Piece, after, bracketed, joined, pieces, signed
from .displays import Equation, group, one
from .indicators import Indicators
from .printer import latex, ordered_terms, small_brackets, split_sign, symbol_name
from .sections import Quasilinear, divergence_form, expanded_form
from .tidy import tidy
from .widths import LINE, width

#: Room that is kept on a line: for a sign and an indentation, and for a bracket and an operator besides.
_ROOM, _MORE_ROOM = 40.0, 60.0


class Equations:
    """Makes labeled equations.

    Attributes:
        used: the symbols that were in an equation.
        indicators: of the choices in derivatives.
    """

    def __init__(self, name: str) -> None:
        """Take the name of the functional, which is in all labels."""
        self._name = name
        self.used: set[Symbol] = set()
        self.indicators = Indicators()

    def label(self, what: str) -> str:
        """Return the label of an equation."""
        return f"eq:{self._name}:{what}"

    def reference(self, what: str) -> str:
        """Return a reference to an equation."""
        return rf"\eqref{{{self.label(what)}}}"

    def tidied(self, derivative: Any) -> Any:  # noqa: ANN401 - an expression, or a matrix of them
        """Return a derivative as the report writes it."""
        written = self.indicators.write(almost_everywhere(derivative))
        return written.applyfunc(tidy) if isinstance(written, sympy.MatrixBase) else tidy(written)

    def equation(self, derived: EulerLagrange) -> EulerLagrange:
        """Return Euler-Lagrange equations with indicators in the place of choices."""
        write = self.indicators.write
        pairs = {second: almost_everywhere(sympy.Matrix(pair)) for second, pair in derived.coefficients.items()}
        return replace(
            derived,
            fluxes=tuple(map(write, derived.fluxes)),
            sources=(write(derived.sources[0]), write(derived.sources[1])),
            coefficients={second: (write(pair[0]), write(pair[1])) for second, pair in pairs.items()},
            rest=(write(derived.rest[0]), write(derived.rest[1])),
        )

    def named(self, label: str, left: str, right: Expr) -> Equation:
        """Return an expression with a name."""
        right = sympy.sympify(right)
        self.used |= right.free_symbols
        return Equation(self.label(label), left, tuple(pieces(right, LINE - width(f"{left} =") - _ROOM)))

    def matrix(self, label: str, name: str, matrix: sympy.Matrix, end: str, *, entry: str) -> str:
        """Return a matrix as a display, or its entries where it is wide; a symmetric one has each entry once."""
        self.used |= matrix.free_symbols
        columns = [max(width(latex(part)) for part in matrix[:, j]) for j in range(matrix.cols)]
        if sum(columns) + 10 * len(columns) + 15 <= LINE - width(f"{name} ="):
            return one(Equation(self.label(label), name, (Piece(latex(matrix)),)), end)
        places = [(i, j) for i in range(matrix.rows) for j in range(matrix.cols)]
        shown = {(i, j): (min(i, j), max(i, j)) if matrix.is_symmetric() else (i, j) for i, j in places}
        letters = {(i, j): f"{entry}_{{{i + 1}{j + 1}}}" for i, j in places}
        rows = [" & ".join(letters[shown[i, j]] for j in range(matrix.cols)) for i in range(matrix.rows)]
        whole = r"\begin{bmatrix} " + r" \\ ".join(rows) + r" \end{bmatrix}"
        entries = [
            self.named(f"{label}-{i + 1}{j + 1}", letters[i, j], matrix[i, j]) for i, j in dict.fromkeys(shown.values())
        ]
        head = one(Equation(self.label(label), name, (Piece(whole),)), "")
        return f"{head}\nwith the entries\n{group(entries, self.label(f'{label}-entries'), end)}"

    def entries(self, label: str, left: str, matrix: sympy.Matrix) -> list[Equation]:
        """Return the 10 distinct entries of a symmetric 4x4 matrix; `left` has two places for symbols."""
        p = FIRST_DERIVATIVES
        return [
            self.named(f"{label}-{p[i]}-{p[j]}", left.format(symbol_name(p[i]), symbol_name(p[j])), matrix[i, j])
            for i in range(4)
            for j in range(i, 4)
        ]

    def divergence(self, derived: EulerLagrange, row: int, label: str) -> Equation:
        """Return an equation, that of x (0) or of y (1), in divergence form."""
        form = divergence_form(derived, row)
        parts: list[Piece] = []
        for operator, flux in ((r"\partial_\xi", form.along_xi), (r"\partial_\eta", form.along_eta)):
            sign, size = split_sign(flux)
            parts = joined(parts, sign, self._operator(operator, size))
        for term in self._terms(-form.source):
            parts = joined(parts, *self._times(term))
        return Equation(self.label(label), "", tuple(after(parts, " = 0")))

    def expanded(self, derived: EulerLagrange, row: int, label: str) -> Equation:
        """Return an equation, that of x (0) or of y (1), with its second derivatives."""
        form: Quasilinear = expanded_form(derived, row)
        parts: list[Piece] = []
        for coefficient, second in form.terms:
            parts = joined(parts, *self._times(coefficient, f" {latex(second)}"))
        parts = parts or [Piece("0")]
        if form.factor != 1:
            self.used |= form.factor.free_symbols
            parts = bracketed(parts, before=f"{latex(form.factor)} ")
        for term in self._terms(form.rest):
            parts = joined(parts, *self._times(term))
        return Equation(self.label(label), "", tuple(after(parts, " = 0")))

    def _terms(self, expression: Expr) -> list[Expr]:
        """Return the terms of what stands behind the second derivatives."""
        if expression == 0:
            return []
        return ordered_terms(expression) if expression.is_Add else [expression]

    def _operator(self, operator: str, argument: Expr) -> list[Piece]:
        """Return a derivative of a flux, in pieces where it is wide."""
        self.used |= argument.free_symbols
        whole = rf"{operator} \left({latex(argument)}\right)"
        if width(whole) <= LINE - _ROOM:
            return [Piece(small_brackets(whole))]
        return bracketed(pieces(argument, LINE - _MORE_ROOM), before=f"{operator} ")

    def _times(self, coefficient: Expr, second: str = "") -> tuple[str, list[Piece]]:
        """Return the sign of a coefficient times a second derivative, and the rest in pieces."""
        self.used |= coefficient.free_symbols
        sign, size = split_sign(coefficient)
        if size == 1 and second:
            return sign, [Piece(second.strip())]
        if not size.is_Add:
            return sign, after(signed(size, LINE - _MORE_ROOM)[1], second)
        whole = small_brackets(rf"\left({latex(size)}\right)") + second
        if width(whole) <= LINE - _MORE_ROOM:
            return sign, [Piece(whole)]
        return sign, bracketed(pieces(size, LINE - _MORE_ROOM), behind=second)
