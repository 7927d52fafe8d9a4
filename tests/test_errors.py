"""Messages stay readable, whatever was given: what a user typed is shortened, and so is everything else."""

from __future__ import annotations

import contextlib
import inspect
import pickle
from enum import Enum

import pytest

import gridgen_sym as gg
from gridgen_sym.errors import GridgenError, MissingExtraError, quoted

LONG = "x" * 100_000
SQUARE = gg.domain("square", 5, 5)
CALLS = {
    "weight": lambda: gg.optimize(SQUARE, "winslow", weight=LONG),
    "weight with brackets": lambda: gg.optimize(SQUARE, "winslow", weight="(" * 100_000),
    "functional": lambda: gg.optimize(SQUARE, LONG),
    "method": lambda: gg.optimize(SQUARE, "winslow", LONG),
    "parameter": lambda: gg.optimize(SQUARE, "winslow", parameters={LONG: 1}),
    "value of a parameter": lambda: gg.optimize(SQUARE, "area_winslow", parameters={"k": LONG}),
    "underscored value": lambda: gg.optimize(SQUARE, "area_winslow", parameters={"k": "1_0"}),
    "parameters": lambda: gg.optimize(SQUARE, "winslow", parameters=LONG),
    "backend": lambda: gg.optimize(SQUARE, "winslow", backend=LONG),
    "tolerance": lambda: gg.optimize(SQUARE, "winslow", tolerance=LONG),
    "iterations": lambda: gg.optimize(SQUARE, "winslow", max_iterations=LONG),
    "time limit": lambda: gg.optimize(SQUARE, "winslow", time_limit=LONG),
    "callback": lambda: gg.optimize(SQUARE, "winslow", callback=LONG),
    "equations": lambda: gg.solve_euler_lagrange(SQUARE, "winslow", LONG),
    "mode": lambda: gg.Weight("x", LONG),
    "definition": lambda: gg.define("long", LONG),
    "name": lambda: gg.define(LONG, "g11"),
    "domain": lambda: gg.domain(LONG, 5, 5),
    "nodes": lambda: gg.domain("square", LONG, 5),
    "sampling": lambda: gg.Outline([[0, 0], [1, 0], [1, 1], [0, 1]], (0, 1, 2, 3)).grid(5, 5, sampling=LONG),
    "corners": lambda: gg.Outline([[0, 0], [1, 0], [1, 1], [0, 1]], range(100_000)),
    "file": lambda: gg.read(LONG),
    "file with a suffix": lambda: gg.read(f"{LONG}.vts"),
    "file to write": lambda: SQUARE.write(f"{LONG}.vts"),
    "outline": lambda: gg.Outline.read(LONG),
    "adapt": lambda: gg.adapt(SQUARE, LONG),
    "monitor": lambda: gg.Monitor(LONG),
    "max_iterations": lambda: gg.adapt(SQUARE, "x", max_iterations=LONG),
    "boundary": lambda: gg.adapt(SQUARE, "x", boundary=LONG),
    "equidistribution": lambda: gg.adapt(SQUARE, "x", functional=LONG),
    "size": lambda: gg.optimize(LONG, "winslow"),
}


@pytest.mark.parametrize("call", CALLS)
def test_what_was_given_is_quoted_in_short(call):
    with pytest.raises(GridgenError) as told:
        CALLS[call]()
    assert 20 < len(str(told.value)) < 1200


def test_what_nobody_shortened_is_cut_in_its_middle():
    error = GridgenError(f"begin {LONG} end")
    assert str(error).startswith("begin xxx")
    assert str(error).endswith("xxx end")
    assert "(94010 characters left out)" in str(error)
    assert len(str(error)) < 6100
    again = pickle.loads(pickle.dumps(error))
    assert (type(again), str(again)) == (GridgenError, str(error))
    assert str(GridgenError("short")) == "short"
    assert str(pickle.loads(pickle.dumps(MissingExtraError("this", "plot", "matplotlib")))).startswith("this needs")


LAYOUT, VALUES = gg.MultiBlock([SQUARE, gg.Grid.from_planes(SQUARE.x + 1, SQUARE.y)]), [[0.0] * 5] * 5
FOR_ONE_BLOCK = {
    "continuation": lambda: gg.continuation(LAYOUT, "quasi_harmonic", "omega", [1, 0.1]),
    "sliver_certificate": lambda: gg.sliver_certificate(LAYOUT),
    "plot_certificates": lambda: gg.plot_certificates(LAYOUT),
    "equidistribution": lambda: gg.equidistribution(LAYOUT, "x"),
    "interpolation_error": lambda: gg.interpolation_error(LAYOUT, "x"),
    "transfer": lambda: gg.transfer(LAYOUT, VALUES, SQUARE),
    "transfer to": lambda: gg.transfer(SQUARE, VALUES, LAYOUT),
    "recover_gradient": lambda: gg.recover_gradient(LAYOUT, VALUES),
    "recover_hessian": lambda: gg.recover_hessian(LAYOUT, VALUES),
    "recovery_error": lambda: gg.recovery_error(LAYOUT, VALUES),
    "hierarchical_error": lambda: gg.hierarchical_error(LAYOUT, VALUES),
    "richardson_error": lambda: gg.richardson_error(LAYOUT, VALUES, VALUES),
    "target": lambda: gg.Target.of(LAYOUT),
    "blocks": lambda: gg.MultiBlock([LAYOUT]),
}


@pytest.mark.parametrize("call", FOR_ONE_BLOCK)
def test_what_takes_one_block_says_so(call):
    with pytest.raises(
        GridgenError, match=r"came a MultiBlock of 2: this is for one block; pass one of layout\.blocks"
    ):
        FOR_ONE_BLOCK[call]()


def test_quoting():
    assert quoted("k") == "'k'"
    assert quoted(LONG) == f"'{'x' * 199}... (100002 characters)"


def needing_arguments():
    """The public functions and classes that cannot be called without arguments; enums are Python's own."""
    for name in gg.__all__:
        value = getattr(gg, name)
        wrong = isinstance(value, type) and issubclass(value, Exception | Enum)
        if callable(value) and not wrong and required(value):
            yield name


def required(function):
    """The parameters without a default value."""
    parameters = inspect.signature(function).parameters.values()
    return [one for one in parameters if one.default is one.empty and one.kind is one.POSITIONAL_OR_KEYWORD]


@pytest.mark.parametrize("name", [*needing_arguments()])
@pytest.mark.filterwarnings("ignore")
def test_nonsense_gets_an_error_of_the_package_and_no_other(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    function = getattr(gg, name)
    count = len(required(function))
    for given in (None, 3, "x", object(), [], (1, 2)):
        for arguments in ([given] * count, [SQUARE, *[given] * (count - 1)]):
            with contextlib.suppress(GridgenError):
                function(*arguments)


def public_methods():
    """The methods by which users read, write and make what the functions take, by name."""
    outline = gg.Outline([(0, 0), (1, 0), (1, 1), (0, 1)], (0, 1, 2, 3))
    for owner in (SQUARE, outline, gg.Target, gg.Weight, gg.Field):
        for name, value in inspect.getmembers(owner, inspect.ismethod):
            # What is made of the cells that walls ask for is for solvers.
            if not name.startswith("_") and name != "of_cells" and required(value):
                yield pytest.param(value, id=value.__qualname__)


@pytest.mark.parametrize("method", [*public_methods()])
@pytest.mark.filterwarnings("ignore")
def test_nonsense_for_a_method_gets_an_error_of_the_package(method, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for given in (None, 3, "x", object(), [], (1, 2)):
        with contextlib.suppress(GridgenError):
            method(*[given] * len(required(method)))


def test_what_is_returned_can_be_compared_and_hashed():
    clockwise = gg.Grid(SQUARE.xy[::-1])
    for make in (
        lambda: gg.certificates(clockwise)[0],
        lambda: gg.untangle(clockwise, progress=False).certificates[0],
        lambda: gg.quality(clockwise),
    ):
        assert make() == make()
        assert hash(make()) == hash(make())
    for result in (gg.untangle(clockwise, progress=False), gg.adapt(SQUARE, "x*y", max_iterations=1, progress=False)):
        assert result == result
        assert isinstance(hash(result), int)
