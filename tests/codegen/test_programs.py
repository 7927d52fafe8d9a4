"""The lowered arithmetic is the derived one, and the derived one is that of the energy."""

from __future__ import annotations

import re
from dataclasses import replace
from types import SimpleNamespace

import mpmath
import numpy as np
import pytest
import sympy
from support import (
    CASES,
    EQUATION_CASES,
    SAME,
    case_name,
    close,
    derived_kernel,
    evaluate,
    metric_values,
    moved,
    numpy_names,
    parameter_values,
    random_values,
    rendered,
    run,
    slopes,
    tiered,
)

from gridgen_sym.backends.numpy.loader import load_module
from gridgen_sym.codegen.kernel import Assignment, Program
from gridgen_sym.functionals import functional
from gridgen_sym.symbolic.coordinates import FIRST_DERIVATIVES
from gridgen_sym.symbolic.derive.continuous import euler_lagrange, residual_slopes
from gridgen_sym.symbolic.derive.discrete import corner_model

ROUND_OFF = mpmath.mpf(10) ** -11
DIFFERENCES = mpmath.mpf(10) ** -18


@pytest.fixture(autouse=True)
def digits():
    with mpmath.workdps(50):
        yield


def inputs_of(name, variant, program, seed, *, folded=False):
    return random_values(program.inputs, parameter_values(functional(name), variant), seed, folded=folded)


def corners(name, variant, program):
    """Yield random input; folded too where the energy has a value there."""
    yield inputs_of(name, variant, program, 1)
    yield inputs_of(name, variant, program, 2)
    if "regularized" in variant or name not in ("winslow", "modified_liao"):
        yield inputs_of(name, variant, program, 3, folded=True)


def corner_expressions(name, variant):
    """Return what every corner program is to compute, by program and output."""
    model = corner_model(functional(name), variant)
    energy = {"energy": model.energy}
    position = {f"p{k}": model.position_gradient[k] for k in range(2)} if variant == "differentiated" else {}
    gradient = energy | {f"d{k}": model.gradient[k] for k in range(4)} | position
    triangle = [(p, q) for p in range(4) for q in range(p, 4)]
    hessian = gradient | {f"h{p}{q}": model.hessian[p, q] for p, q in triangle}
    if variant == "differentiated":
        hessian |= {f"c{p}{q}": model.position_cross[p, q] for p in range(4) for q in range(2)}
        hessian |= {f"q{p}{q}": model.position_hessian[p, q] for p, q in ((0, 0), (0, 1), (1, 1))}
    semidefinite = model.semidefinite_hessian if model.splitting.holds else model.hessian
    products = {"corner_hessian_vector": product_expressions(model, model.hessian, variant == "differentiated")}
    if model.splitting.holds:
        products["corner_semidefinite_vector"] = product_expressions(model, semidefinite, moving=False)
    if variant == "differentiated":
        products["moved"] = moved_expressions()
    return products | {
        "corner_energy": energy,
        "corner_slopes": energy | {f"slope_{of}": slope for of, slope in model.slopes.items()} | position,
        "corner_hessian": hessian,
        "corner_semidefinite": {f"h{p}{q}": semidefinite[p, q] for p, q in triangle},
    }


def moved_expressions():
    """Return the values at a node that has moved: Taylor's formula to second order."""
    s, s_x, s_y, s_xx, s_xy, s_yy, v_x, v_y = sympy.symbols("s s_x s_y s_xx s_xy s_yy v_x v_y", real=True)
    slopes, move = sympy.Matrix([s_x, s_y]), sympy.Matrix([v_x, v_y])
    bend = sympy.Matrix([[s_xx, s_xy], [s_xy, s_yy]])
    held = {f"moved_{plane}": plane for plane in (s_x, s_y, s_xx, s_xy, s_yy)}
    return held | {"moved_s": s + slopes.dot(move) + (move.T * bend * move)[0] / 2}


def product_expressions(model, matrix, moving):
    """Return a Hessian times a vector, from the Hessian's entries; the programs differentiate along the vector."""
    vector = sympy.Matrix([sympy.Symbol(f"v_{p}", real=True) for p in FIRST_DERIVATIVES])
    if not moving:
        return {f"d{k}": entry for k, entry in enumerate(matrix * vector)}
    place = sympy.Matrix(sympy.symbols("v_x v_y", real=True))
    edges = matrix * vector + model.position_cross * place
    nodes = model.position_cross.T * vector + model.position_hessian * place
    return {f"d{k}": entry for k, entry in enumerate(edges)} | {f"p{k}": entry for k, entry in enumerate(nodes)}


def equation_expressions(name, variant):
    """Return what every Euler-Lagrange program is to compute, but for the slopes in the node's own position."""
    equations = euler_lagrange(functional(name), variant)
    system = equations.reduction.system if equations.reduction else equations.residual
    residual = {"r_x": system[0], "r_y": system[1]}
    all_slopes = {f"{'xy'[row]}_{p}": pair[row] for p, pair in residual_slopes(system).items() for row in (0, 1)}
    second = {key: value for key, value in all_slopes.items() if key.count("_") == 2 and len(key.split("_")[2]) > 3}
    return {
        "residual": residual,
        "residual_slopes": residual | all_slopes,
        "residual_coefficients": residual | second,
    }


def objections(found, expressions, values, tolerance):
    """Return the outputs that differ from the direct evaluation of their expressions."""
    known = metric_values(values) if "x_xi" in values else values
    return [name for name, e in expressions.items() if not close(found[name], evaluate(e, known), tolerance)]


def second_derivative_names(program):
    return {name for name in program.outputs if name.endswith(("xixi", "xieta", "etaeta"))}


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES, ids=case_name)
def test_lowered_programs_equal_the_derived_expressions(case):
    expected = corner_expressions(*case) | (equation_expressions(*case) if case in EQUATION_CASES else {})
    programs = derived_kernel(*case).programs
    assert set(programs) == set(expected)
    for name, expressions in expected.items():
        program = programs[name]
        beyond = {"x_x", "x_y", "y_x", "y_y"} if name == "residual_slopes" and case[1] == "differentiated" else set()
        assert set(program.outputs) == set(expressions) | beyond
        for values in corners(*case, program):
            assert not objections(run(program, values), expressions, values, SAME)


@pytest.mark.slow
@pytest.mark.parametrize("case", tiered(CASES), ids=case_name)
def test_printed_numpy_equals_the_derived_expressions(case):
    expected = corner_expressions(*case) | (equation_expressions(*case) if case in EQUATION_CASES else {})
    for name, expressions in expected.items():
        for values in corners(*case, derived_kernel(*case).programs[name]):
            found = call_printed(numpy_names(*case), derived_kernel(*case).programs[name], values)
            assert not objections(found, expressions, values, ROUND_OFF)


def call_printed(names, program, values):
    """Call a printed NumPy function with doubles and return its results by name."""
    inputs = [np.float64(values[name]) for name in program.inputs]
    scales = [SimpleNamespace(xi=1.0, eta=1.0, xi_xi=1.0, eta_eta=1.0, xi_eta=1.0)] * program.name.startswith("corner_")
    results = names[program.name](*scales, *inputs, [float(values[name]) for name in program.parameters])
    return {name: mpmath.mpf(float(value)) for name, value in zip(program.outputs, results, strict=True)}


def chain_rule(found, values):
    """Return the 4 derivatives in the edge vectors from the slopes in the metric, as a textbook has it."""
    a, b, c, d = (values[str(p)] for p in FIRST_DERIVATIVES)
    metric = {"g11": (2 * a, 2 * b, 0, 0), "g22": (0, 0, 2 * c, 2 * d), "g12": (c, d, a, b), "J": (d, -c, -b, a)}
    direct = [found.get(f"slope_{p}", 0) for p in FIRST_DERIVATIVES]
    return {
        f"d{k}": direct[k] + sum(found.get(f"slope_{m}", 0) * entries[k] for m, entries in metric.items())
        for k in range(4)
    }


def gradient_objections(program, energy, values):
    """Return the entries of a corner gradient that are not the slopes of the energy program."""
    found = run(program, values)
    found |= {} if "d0" in found else chain_rule(found, values)
    wanted = {f"d{k}": str(p) for k, p in enumerate(FIRST_DERIVATIVES)}
    wanted |= {"p0": "x", "p1": "y"} if "p0" in found else {}
    return [
        entry
        for entry, along in wanted.items()
        if not close(found[entry], slopes(energy, values, moved(values, along))["energy"], DIFFERENCES)
    ]


@pytest.mark.slow
@pytest.mark.parametrize("case", tiered(CASES), ids=case_name)
def test_corner_gradient_is_the_slope_of_the_energy(case):
    programs = derived_kernel(*case).programs
    for values in corners(*case, programs["corner_slopes"]):
        assert not gradient_objections(programs["corner_slopes"], programs["corner_energy"], values)
        assert not gradient_objections(programs["corner_hessian"], programs["corner_energy"], values)


@pytest.mark.slow
@pytest.mark.parametrize("case", tiered(CASES), ids=case_name)
def test_corner_hessian_is_the_slope_of_the_gradient(case):
    programs = derived_kernel(*case).programs
    for values in corners(*case, programs["corner_hessian"]):
        found = run(programs["corner_hessian"], values)
        for column, name in enumerate(map(str, FIRST_DERIVATIVES)):
            expected = slopes(programs["corner_hessian"], values, moved(values, name))
            for row in range(column + 1):
                assert close(found[f"h{row}{column}"], expected[f"d{row}"], DIFFERENCES)
        for column, name in enumerate("xy" if case[1] == "differentiated" else ""):
            expected = slopes(programs["corner_hessian"], values, moved(values, name))
            for row in range(4):
                assert close(found[f"c{row}{column}"], expected[f"d{row}"], DIFFERENCES)
            for row in range(column + 1):
                assert close(found[f"q{row}{column}"], expected[f"p{row}"], DIFFERENCES)


@pytest.mark.slow
@pytest.mark.parametrize("case", tiered(EQUATION_CASES), ids=case_name)
def test_residual_slopes_are_the_slopes_of_the_residual(case):
    programs = derived_kernel(*case).programs
    values = inputs_of(*case, programs["residual"], 4)
    found = run(programs["residual_slopes"], values)
    frozen = run(programs["residual_coefficients"], values)
    checked = {"r_x", "r_y"}
    names = [name for name in programs["residual"].inputs if not name.startswith("s")]
    for along in (*names, *("xy" if case[1] == "differentiated" else "")):
        expected = slopes(programs["residual"], values, moved(values, along))
        for component in "xy":
            entry = f"{component}_{along}"
            assert close(found[entry], expected[f"r_{component}"], DIFFERENCES)
            assert close(frozen.get(entry, found[entry]), expected[f"r_{component}"], DIFFERENCES)
            checked.add(entry)
    assert checked == set(found)
    assert set(frozen) == {"r_x", "r_y"} | second_derivative_names(programs["residual_slopes"])


# ---- failures made on purpose: the comparisons above object to them ----


def flip(program: Program, name: str) -> Program:
    """Return the program with the sign of one output turned."""
    changed = tuple(
        Assignment(name, -assignment.value) if assignment.name == name else assignment
        for assignment in program.assignments
    )
    return replace(program, assignments=changed)


@pytest.mark.parametrize("case", [("winslow", "plain"), ("area", "differentiated")], ids=case_name)
def test_a_flipped_sign_in_a_gradient_is_objected_to(case):
    programs = derived_kernel(*case).programs
    for output in programs["corner_slopes"].outputs[1:]:
        broken = flip(programs["corner_slopes"], output)
        values = inputs_of(*case, broken, 1)
        objected = gradient_objections(broken, programs["corner_energy"], values)
        assert objected == [output] if output[0] == "p" else len(objected) >= 2
        expected = corner_expressions(*case)["corner_slopes"]
        assert objections(run(broken, values), expected, values, SAME) == [output]


@pytest.mark.parametrize("case", [("winslow", "plain"), ("knupp", "plain"), ("area", "frozen")], ids=case_name)
@pytest.mark.parametrize("place", [0, 1, -1], ids=["energy", "first slope", "last slope"])
@pytest.mark.parametrize("broken_line", [r"\1-(\2)", r"\1 2.0*(\2)"], ids=["sign", "factor"])
def test_a_broken_printed_kernel_is_objected_to(case, place, broken_line):
    text = rendered(*case, "numpy")
    program = derived_kernel(*case).programs["corner_slopes"]
    output = program.outputs[place]
    first, head, body = text.partition("def corner_slopes(")
    changed, count = re.subn(rf"(\n    {output} =)(.*)", broken_line, body, count=1)
    assert count == 1
    values = inputs_of(*case, program, 1)
    expressions = corner_expressions(*case)["corner_slopes"]
    intact = call_printed(load_module("intact.py", text), program, values)
    broken = call_printed(load_module("broken.py", first + head + changed), program, values)
    assert not objections(intact, expressions, values, ROUND_OFF)
    assert objections(broken, expressions, values, ROUND_OFF) == [output]
