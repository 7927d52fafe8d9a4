"""Densities of fields, places and targets: every derivative against differences of the bare formula."""

from __future__ import annotations

from functools import lru_cache

import mpmath
import pytest
import sympy
from mpmath import mpf
from support import close, run

from gridgen_sym.codegen.programs import kernel
from gridgen_sym.functionals.definition import Functional
from gridgen_sym.functionals.metric import symbol
from gridgen_sym.functionals.variant import Modes
from gridgen_sym.symbolic import euler_lagrange
from gridgen_sym.symbolic.classify.classification import classify
from gridgen_sym.symbolic.coordinates import FIRST_DERIVATIVES, SECOND_DERIVATIVES, expand_metric

EDGES = [str(p) for p in FIRST_DERIVATIVES]
DVINSKY = (
    "(M11*(x_xi**2 + x_eta**2) + 2*M12*(x_xi*y_xi + x_eta*y_eta) + M22*(y_xi**2 + y_eta**2))/(sqrt(M11*M22 - M12**2)*J)"
)
CASES = {
    "scalar held": ("p*(g11 + g22)/J + p**2*J**2", {"p": "scalar"}, "plain"),
    "scalar": ("p*(g11 + g22)/J + p**2*J**2", {"p": "scalar"}, "p:differentiated"),
    "vector held": ("(v1*x_xi + v2*y_xi)**2 + g22/J", {"v": "vector"}, "plain"),
    "vector": ("(v1*x_xi + v2*y_xi)**2 + g22/J", {"v": "vector"}, "v:differentiated"),
    "symmetric held": (DVINSKY, {"M": "symmetric"}, "plain"),
    "symmetric": (DVINSKY, {"M": "symmetric"}, "M:differentiated"),
    "matrix held": ("((B11*x_xi + B12*y_xi)**2 + (B21*x_eta + B22*y_eta)**2)/J", {"B": "matrix"}, "plain"),
    "matrix": ("((B11*x_xi + B12*y_xi)**2 + (B21*x_eta + B22*y_eta)**2)/J", {"B": "matrix"}, "B:differentiated"),
    "places": ("(1 + x**2 + y*xi + eta**2)*(g11 + g22)/J", {}, "plain"),
    "target": ("(g11 + g22)/J", {}, "target"),
    "edges and a target": ("x_xi**2*y_eta**2 + g12**2/J", {}, "target"),
    "both metrics": ("t11/g11 + t12*g12 + t22**2 + tau/J", {}, "target"),
    "all": ("s*(g11*q + x*g22*p)/J", {"p": "scalar", "q": "scalar"}, "frozen+p:differentiated+target"),
    "weight": ("s*(g11*q + g22*p)/J", {"p": "scalar", "q": "scalar"}, "differentiated+q:differentiated"),
}
QUICK = ("all",)
TIERED = [name if name in QUICK else pytest.param(name, marks=pytest.mark.slow) for name in CASES]
SAME = mpf(10) ** -25
XI, ETA = mpf(1) / 3, mpf(2) / 5


@pytest.fixture(autouse=True)
def digits():
    with mpmath.workdps(60):
        yield


@lru_cache(maxsize=len(CASES))
def derived(name):
    density, fields, variant = CASES[name]
    functional = Functional("case", density, fields=fields)
    return functional, variant, kernel(functional, variant)


# ---- the bare formula: a map, fields and a target in many digits ----


def position(xi, eta):
    """Return x and y of a map with J > 0."""
    return 2 * xi + xi * eta**2 / 3 + eta / 5, eta + xi**2 / 4 + xi * eta / 3


def field(component):
    """Return a function of two places, another one for each component."""
    seed = sum(map(ord, component)) % 7 + 1
    diagonal = not component.endswith(("12", "21"))
    return lambda u, v: (2 if diagonal else mpf(1) / 4) + (u * v + v**3 / seed + u**2) / (5 + seed)


def inverse_target(xi, eta):
    """Return V11, V12, V21, V22 of a target that varies."""
    w11, w12, w21, w22 = 1 + xi / 5, eta / 3, xi * eta / 4, mpf(9) / 10 + eta**2 / 7
    determinant = w11 * w22 - w12 * w21
    return w22 / determinant, -w12 / determinant, -w21 / determinant, w11 / determinant


def metric(names, a, b, c, d):
    return dict(zip(names, (a * a + b * b, c * c + d * d, a * c + b * d, a * d - b * c), strict=True))


class Formula:
    """The density of a case as a function of (xi, eta, x, y, x_xi, y_xi, x_eta, y_eta), by its definition."""

    def __init__(self, functional, variant):
        self.modes, self.moving = Modes.read(variant), set()
        expression = functional.expression()
        self.names = sorted(str(name) for name in expression.free_symbols)
        self.evaluate = sympy.lambdify(sorted(expression.free_symbols, key=str), expression, "mpmath")
        self.components = [*functional.components, *(["s"] if self.modes.weight else [])]
        for name in (*self.modes.differentiated, *(["s"] if self.modes.weight == "differentiated" else [])):
            self.moving |= {part for part in self.components if part.startswith(name)}

    def values(self, xi, eta, x, y):
        return {part: field(part)(*((x, y) if part in self.moving else (xi, eta))) for part in self.components}

    def __call__(self, xi, eta, x, y, *edges):
        known = dict(zip(EDGES, edges, strict=True)) | metric(("g11", "g22", "g12", "J"), *edges)
        known |= {"x": x, "y": y, "xi": xi, "eta": eta} | self.values(xi, eta, x, y)
        if self.modes.target:
            (a, b, c, d), (v11, v12, v21, v22) = edges, inverse_target(xi, eta)
            relative = v11 * a + v21 * c, v11 * b + v21 * d, v12 * a + v22 * c, v12 * b + v22 * d
            named = metric(("t11", "t22", "t12", "tau"), *relative)
            if {*named} & {*self.names}:
                known |= named
            else:
                known |= dict(zip(EDGES, relative, strict=True)) | metric(("g11", "g22", "g12", "J"), *relative)
        return self.evaluate(*(known[name] for name in self.names))

    def inputs(self):
        """Return what the programs may be given at (XI, ETA), by name."""
        x, y = position(XI, ETA)
        known = {"x": x, "y": y, "xi": XI, "eta": ETA} | self.values(XI, ETA, x, y)
        for p in (*EDGES, *map(str, SECOND_DERIVATIVES)):
            component = "xy".index(p[0])
            known[p] = slope(lambda *at, k=component: position(*at)[k], (XI, ETA), p[2:])
        for part in self.components:
            place, axes = ((x, y), ("x", "y", "xx", "xy", "yy")) if part in self.moving else ((XI, ETA), ("xi", "eta"))
            known |= {f"{part}_{axis}": slope(field(part), place, axis) for axis in axes}
        for k, part in enumerate(("V11", "V12", "V21", "V22")):
            known[part] = inverse_target(XI, ETA)[k]
            for axis in ("xi", "eta"):
                known[f"{part}_{axis}"] = slope(lambda *at, k=k: inverse_target(*at)[k], (XI, ETA), axis)
        return {**known, **{f"field_{name}": value for name, value in known.items()}}


def slope(function, place, axes):
    """Return a derivative, axes being such as xi, xieta or xx."""
    first, second = ("xi", "eta") if "xi" in axes or "eta" in axes else ("x", "y")
    return mpmath.diff(function, place, (axes.count(first), axes.count(second)))


def given(program, values):
    return {name: values[name] for name in (*program.inputs, *program.parameters)}


# ---- the corner ----


@pytest.mark.parametrize("name", TIERED)
def test_corner_derivatives_are_those_of_the_bare_density(name):
    functional, variant, programs = derived(name)
    formula = Formula(functional, variant)
    values = formula.inputs()
    start = [*position(XI, ETA), *(values[p] for p in EDGES)]  # The place, then the edges.
    program = programs.programs["corner_hessian"]
    found = run(program, given(program, values))
    moves = programs.facts.moving

    def expected(*variables):
        orders = [variables.count(k) for k in range(6)]
        return mpmath.diff(lambda *at: formula(XI, ETA, *at), start, orders)

    for k in range(4):
        assert close(found[f"d{k}"], expected(2 + k), SAME)
        for j in range(k, 4):
            assert close(found[f"h{k}{j}"], expected(2 + k, 2 + j), SAME)
        for axis in range(2 * moves):
            assert close(found[f"c{k}{axis}"], expected(2 + k, axis), SAME)
    for axis in range(2 * moves):
        assert close(found[f"p{axis}"], expected(axis), SAME)
        for other in range(axis, 2):
            assert close(found[f"q{axis}{other}"], expected(axis, other), SAME)
    check_product(programs, values, found)


def check_product(programs, values, found):
    """Check the Hessian times a vector against the entries."""
    move = {f"v_{p}": mpf(k + 2) / 7 for k, p in enumerate((*EDGES, "x", "y"))}
    program = programs.programs["corner_hessian_vector"]
    product = run(program, given(program, values | move))
    edges, place = [move[f"v_{p}"] for p in EDGES], [move["v_x"], move["v_y"]]
    for k in range(4):
        entries = [found[f"h{min(k, j)}{max(k, j)}"] for j in range(4)]
        crossed = [found.get(f"c{k}{axis}", 0) for axis in range(2)]
        assert close(product[f"d{k}"], mpmath.fdot(entries, edges) + mpmath.fdot(crossed, place), SAME)
    for axis in range(2 * programs.facts.moving):
        along = mpmath.fdot([found[f"c{k}{axis}"] for k in range(4)], edges)
        bent = mpmath.fdot([found["q00"], found["q01"], found["q11"]][axis : axis + 2], place)
        assert close(product[f"p{axis}"], along + bent, SAME)


# ---- the Euler-Lagrange equations ----


def functional_derivative(formula):
    """Return d/dxi L_(r_xi) + d/deta L_(r_eta) - L_r at (XI, ETA), for r = x and y, by differences alone."""

    def arguments(xi, eta):
        edges = [mpmath.diff(lambda *at, k=k: position(*at)[k], (xi, eta), n) for n in ((1, 0), (0, 1)) for k in (0, 1)]
        return [xi, eta, *position(xi, eta), *edges]

    def partial(place, variable):
        return mpmath.diff(formula, arguments(*place), [int(k == variable) for k in range(8)])

    return [
        mpmath.diff(lambda t, r=r: partial((t, ETA), 4 + r), XI)
        + mpmath.diff(lambda t, r=r: partial((XI, t), 6 + r), ETA)
        - partial((XI, ETA), 2 + r)
        for r in (0, 1)
    ]


@pytest.mark.parametrize("name", TIERED)
def test_residual_is_the_functional_derivative_of_the_bare_density(name):
    functional, variant, programs = derived(name)
    formula = Formula(functional, variant)
    values = formula.inputs()
    program = programs.programs["residual"]
    found = run(program, given(program, values))
    solved = mpmath.matrix([found["r_x"], found["r_y"]])
    reduction = euler_lagrange(functional, variant).reduction
    if reduction:
        matrix = reduction.operator.matrix.applyfunc(expand_metric)
        names = sorted(matrix.free_symbols, key=str)
        solved = sympy.lambdify(names, matrix, "mpmath")(*(values[str(name)] for name in names)) * solved
    for mine, expected in zip(solved, functional_derivative(formula), strict=True):
        assert close(mine, expected, SAME)
        assert abs(expected) > 1e-3  # A flipped sign would be seen.


@pytest.mark.parametrize("name", TIERED)
def test_slopes_are_those_of_the_residual(name):
    functional, variant, programs = derived(name)
    values = Formula(functional, variant).inputs()
    residual, slopes, frozen = (programs.programs[f"residual{tail}"] for tail in ("", "_slopes", "_coefficients"))
    found, held = run(slopes, given(slopes, values)), run(frozen, given(frozen, values))
    for component in "xy":
        for p in (*EDGES, *map(str, SECOND_DERIVATIVES), *("xy" if programs.facts.moving else "")):

            def at(h, p=p, component=component):
                return run(residual, given(residual, moved(values, p, h)))[f"r_{component}"]

            expected = mpmath.diff(at, 0)
            entry = f"{component}_{p}"
            assert close(found[entry], expected, SAME)
            assert close(held.get(entry, found[entry]), expected, SAME)
        assert close(found[f"r_{component}"], held[f"r_{component}"], SAME)


def moved(values, name, h):
    """Return the inputs where one has changed; with the place the values move that have derivatives in x and y."""
    changed = values | {name: values[name] + h}
    if name in ("x", "y"):
        for key in values.keys() - {"x", "y"}:
            head, _, tail = key.rpartition("_")
            higher = f"{head}_{''.join(sorted(tail + name))}" if tail in ("x", "y") else f"{key}_{name}"
            changed[key] += h * values.get(higher, 0)
    return changed


def test_witnesses_have_the_names_of_declared_fields():
    """At the witness itself det A is negative."""
    density = "M11*g11 - M22*g22 + M12*g12 + p*J**2/g11"
    tensor = Functional("witnessed", density, fields={"M": "symmetric", "p": "scalar"}, constraints=("p > 0",))
    found = classify(tensor)
    witness = dict(found.ellipticity.witness)
    names = {str(name) for name in witness}
    assert names == {"M11", "M12", "M22", "p", "x_xi", "x_eta", "y_xi", "y_eta", "k1", "k2"}
    assert witness[symbol("M11")] * witness[symbol("M22")] > witness[symbol("M12")] ** 2
    assert witness[symbol("p")] > 0
    assert expand_metric(found.symbol.det()).subs(witness) < 0


def test_signs_that_constraints_fix_are_taken():
    def expression(density, *constraints):
        fields = {"c": "scalar", "d": "scalar"}
        return str(
            Functional("signs", density, parameters={"k": 1.0}, fields=fields, constraints=constraints).expression()
        )

    assert expression("sqrt(c*c)*g11", "c > 0") == "c*g11"
    assert expression("sqrt(c**2*d**2) + abs(k)*J", "c >= 1", "0 <= k") == "J*k + c*Abs(d)"
    assert expression("abs(c*d)*g11", "0 < c < 2", "d >= 0") == "c*d*g11"
    for constraint in ("c > -1", "c < 1", "c == 1", "c + d > 0"):
        assert expression("sqrt(c*c)*g11", constraint) == "g11*Abs(c)"
    assert expression("abs(c - 1)*g11", "c > 0") == "g11*Abs(c - 1)"
