"""One table says what an option is: signatures, docstrings and the command line are held to it."""

from __future__ import annotations

import inspect
import re
import typing

import click
import pytest

import gridgen_sym as gg
from gridgen_sym.adaptation.monitor import _MEASURES
from gridgen_sym.cli import main
from gridgen_sym.options import ADAPTATION, AIRFOIL, FILES, OCEAN, OUTLINE, PICTURES, SAMPLES, SOLVERS, WEIGHT, Option

#: (a function or class, the table of its arguments, which of them have another name there).
CALLED = [
    (gg.optimize, SOLVERS, {}),
    (gg.solve_euler_lagrange, SOLVERS, {}),
    (gg.adapt, ADAPTATION, {}),
    (gg.Monitor, ADAPTATION, {"measure": "monitor"}),
    (gg.Weight, WEIGHT, {}),
    (gg.scattered_field, SAMPLES, {}),
    (gg.raster_field, SAMPLES, {}),
    (gg.Outline.__init__, OUTLINE, {}),
    (gg.Outline.read, OUTLINE, {}),
    (gg.Outline.sides, OUTLINE, {}),
    (gg.airfoil_grid, AIRFOIL, {}),
    (gg.plot_grid, PICTURES, {}),
    (gg.plot_certificates, PICTURES, {}),
    (gg.view_grid, PICTURES, {}),
    (gg.ocean_grid, OCEAN, {}),
    (gg.read, FILES, {}),
    (gg.write, FILES, {}),
]
SHARED = [
    pytest.param(function, name, table[names.get(name, name)], id=f"{function.__qualname__}-{name}")
    for function, table, names in CALLED
    for name in inspect.signature(function).parameters
    if names.get(name, name) in table
]


def entry(function: object, name: str) -> str:
    """Return what a docstring says of an argument, on one line and without the marks of code."""
    found = re.search(rf"^ +{name}: (.*?)(?=\n +\w+: |\n *\n|\Z)", inspect.getdoc(function), re.MULTILINE | re.DOTALL)
    assert found, f"{function} says nothing of {name}"
    return " ".join(found.group(1).replace("`", "").split())


def bare(text: str) -> str:
    return text.lower().removeprefix("the ")


def choices_in(annotation: object) -> tuple[str, ...]:
    """Return the words that a type admits, those of a union of types in order."""
    if typing.get_origin(annotation) is typing.Literal:
        return typing.get_args(annotation)
    return tuple(word for part in typing.get_args(annotation) for word in choices_in(part))


@pytest.mark.parametrize(("function", "name", "row"), SHARED)
def test_a_docstring_begins_with_what_the_table_says(function, name, row):
    text = entry(function, name)
    assert bare(text).startswith(bare(row.help)) or text.startswith(("as in ", "as for "))


@pytest.mark.parametrize(("function", "name", "row"), SHARED)
def test_a_signature_has_the_default_and_the_choices_of_the_table(function, name, row):
    default = inspect.signature(function).parameters[name].default
    if row.default is not None:
        assert default == row.default
        assert type(default) is type(row.default)
    if row.choices and row.name != "monitor":  # That may be any function, too.
        written = inspect.signature(function).parameters[name].annotation
        annotation = eval(written, vars(inspect.getmodule(inspect.unwrap(function))))
        assert sorted(choices_in(annotation)) == sorted(row.choices)


def test_monitors_are_those_of_the_table():
    assert sorted(ADAPTATION["monitor"].choices) == sorted(_MEASURES)


def test_every_row_is_an_argument_of_a_function_and_an_option_of_the_command_line():
    used = {id(param.values[2]) for param in SHARED}
    rows = [
        row for table in (SOLVERS, ADAPTATION, WEIGHT, SAMPLES, OUTLINE, AIRFOIL, PICTURES) for row in table.values()
    ]
    assert [row.name for row in rows if id(row) not in used] == []
    helps = [
        bare(option.help)
        for command in main.commands.values()
        for option in command.params
        if isinstance(option, click.Option) and option.help
    ]
    unseen = [row.name for row in rows if not any(text.startswith(bare(row.help)) for text in helps)]
    assert unseen == []


@pytest.mark.parametrize(
    ("row", "shown"),
    [
        (Option("first", "", float, default=1e-5), "1e-5"),
        (Option("cells", "", int, default=(96, 64)), "96 64"),
        (Option("far", "", float, default=20.0), "20"),
        (Option("growth", "", float, unset="what fits"), "what fits"),
        (Option("blunt", "", bool, default=False), ""),
    ],
)
def test_defaults_are_shown_as_users_write_them(row, shown):
    assert row.shown_default == shown


def test_what_is_not_given_is_left_to_the_function(monkeypatch, tmp_path):
    """Options without a value do not reach the functions, so that no default is said twice."""
    given = {}

    def airfoil_grid(section, **options):
        given.update(options)
        raise gg.GridgenError("enough")

    monkeypatch.setattr("gridgen_sym.solvers.airfoil_grid", airfoil_grid)
    with pytest.raises(click.ClickException, match="enough"):
        main(["airfoil", "naca0012", "--wake", "20"], standalone_mode=False)
    assert given == {"wake": 20, "progress": None, "blunt": False}
