"""PLOT3D files that are text: what the header may mean, and the planes of the blocks."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator
from typing import BinaryIO

import numpy as np

from ..arrays import Array
from .plot3d_forms import MOST_BLOCKS, Form, allows, chosen_form, unfit
from .plot3d_numbers import EXPECTED, Numbers


def read_text(stream: BinaryIO, words: Collection[str]) -> tuple[Form, Iterator[list[Array]]]:
    """Return the form of a text, and for each block all x, all y, and what else there is, flat.

    Raises:
        GridgenError: for a word that is no number, or a count of numbers that does not fit the header.
    """
    numbers = Numbers(stream)
    forms = [form for form in _forms(numbers, words) if allows(words, form)]
    fitting = [form for form in forms if form.count == numbers.count]
    if not fitting:
        counts = ", repeat counts included," if numbers.repeated else ""
        what = f"its {numbers.count} numbers{counts} do not fit its header, which begins {numbers.head(3)}"
        raise unfit(forms, numbers.count, what, EXPECTED)
    numbers.check_size()
    form = chosen_form(fitting, lambda form: _first_block(numbers, form))
    return form, _blocks(numbers, form)


def _first_block(numbers: Numbers, form: Form) -> list[Array]:
    nodes = math.prod(form.sizes[0])
    first = numbers.first(form.header + (form.dimension + form.blanked) * nodes)[form.header :]
    return list(first.reshape(-1, nodes))


def _blocks(numbers: Numbers, form: Form) -> Iterator[list[Array]]:
    numbers.take(form.header)
    for ni, nj, nk in form.sizes:
        yield [numbers.take(ni * nj * nk) for _ in range(form.dimension + form.blanked)]


def _forms(numbers: Numbers, words: Collection[str]) -> Iterator[Form]:
    """Yield what the header may mean, the likeliest first."""
    text = numbers.head_text
    count, first_line = numbers.head(1)[0], len(text.split("\n", 1)[0].split())
    # A number alone in its line most likely counts blocks, and so does a 1, unless it is the size of a plane i = 1.
    counted = [True, False] if first_line == 1 or count == 1 else [False, True]
    if count == 1 and first_line != 3 and "nocount" not in words:
        counted = [True]
    for has_count in counted:
        blocks = count if has_count else 1
        if not 0 < blocks <= min(MOST_BLOCKS, numbers.count):
            continue
        dimensions = [
            dimension
            for dimension in _dimensions(text, blocks, has_count=has_count)
            if ("space", "plane")[dimension == 3] not in words
        ]
        # Where the lines of the header do not give the dimension, iblank cannot be distinguished from z.
        for blanked in (False, True) if len(dimensions) == 1 else (False,):
            for dimension in dimensions:
                head = np.array(numbers.head(has_count + dimension * blocks)[has_count:], dtype=object)
                rows = head.reshape(blocks, dimension).tolist()
                sizes = tuple((ni, nj, rest[0] if rest else 1) for ni, nj, *rest in rows)
                if min(min(size) for size in sizes) > 0:
                    yield Form(sizes, dimension, blanked, has_count)


def _dimensions(text: str, blocks: int, *, has_count: bool) -> tuple[int, ...]:
    """Return the dimensions that the file may have: the words in the header's lines give it, if it has lines.

    The count of all numbers would nearly do, but a three-dimensional file cut short can pass for a whole
    two-dimensional one.
    """
    lines = text.split("\n", 2)
    words = len(lines[0].split()) - has_count
    if words == 0 and len(lines) > 1:
        words = len(lines[1].split())
    known = {3 * blocks: 3, 2 * blocks: 2, 3: 3, 2: 2}  # All sizes in one line, or those of one block.
    return (known[words],) if words in known else (3, 2)
