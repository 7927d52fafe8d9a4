"""Grids within programs of JAX and PyTorch: their own checkers of gradients, and what a second use costs."""

from __future__ import annotations

import numpy as np
import pytest

import gridgen_sym as gg

from . import cases

pytestmark = pytest.mark.extras

SHAPE = 6, 5
START = cases.start(SHAPE)
WEIGHT = 1 + 0.3 * np.random.default_rng(0).random(SHAPE)
REFERENCE = gg.optimize(gg.Grid(START), "winslow").grid.xy
#: So many points that none is a sharp turn, at which a node would stay.
CURVE, INNER = cases.start((20, 5))[:, 0].copy(), np.ones((20, 1))
INNER[[0, -1]] = 0.0
#: The data of each kind that are differentiated, besides the nodes, and what else is given.
KINDS = {
    "boundary": ({}, {}),
    "weight": ({"weight": WEIGHT}, {}),
    "parameters": ({"parameters": {"k": np.array(0.1)}}, {"functional": "area_winslow"}),
    "target": ({"target": REFERENCE}, {}),
    "sliding": ({"slide": {"bottom": CURVE}}, {}),
    "walls": ({"walls": {"bottom": {"first": np.array(0.1), "growth": np.array(1.1)}}}, {"slide": ("left", "right")}),
}


@pytest.fixture
def jax(monkeypatch):
    import jax

    with jax.enable_x64(True) if hasattr(jax, "enable_x64") else jax.experimental.enable_x64():
        yield jax


def with_ends(data: dict, array) -> dict:
    """Return data in which the ends of a curve, which are corners of the start, do not change."""
    if "slide" in data:
        curve, inner = array(CURVE), array(INNER)
        return {"slide": {"bottom": curve + inner * (data["slide"]["bottom"] - curve)}}
    return data


def options(more: dict) -> dict:
    return {"functional": "winslow", "tolerance": 1e-13, **more}


@pytest.mark.parametrize("kind", KINDS)
def test_jax_checks_its_gradients(jax, kind):
    from jax.test_util import check_grads

    from gridgen_sym.jax import optimize

    data, more = KINDS[kind]

    def of_data(data):
        return optimize(START, **with_ends(data, jax.numpy.asarray), **options(more))

    if data:
        check_grads(of_data, (data,), order=1, modes=["rev"], eps=1e-6, rtol=1e-5)
    if kind in ("boundary", "walls"):
        check_grads(lambda nodes: optimize(nodes, **data, **options(more)), (START,), order=1, modes=["rev"], eps=1e-4)


@pytest.mark.parametrize("kind", KINDS)
def test_torch_checks_its_gradients(kind):
    import torch

    from gridgen_sym.sensitivities.functions import leaves, nested
    from gridgen_sym.torch import optimize

    data, more = KINDS[kind]
    paths, arrays = zip(*leaves({"nodes": START, **data} if kind in ("boundary", "walls") else data), strict=True)
    tensors = [torch.tensor(array, dtype=torch.float64, requires_grad=True) for array in arrays]

    def of_tensors(*tensors):
        given = nested(list(paths), list(tensors))
        return optimize(given.pop("nodes", START), **with_ends(given, torch.tensor), **options(more))

    assert torch.autograd.gradcheck(of_tensors, tensors, eps=1e-5, atol=1e-6, rtol=1e-5, fast_mode=True)


def test_a_second_use_traces_and_compiles_nothing(jax, capsys):
    from gridgen_sym.jax import optimize

    traces = []

    @jax.jit
    def loss(nodes):
        traces.append(nodes.shape)
        return (optimize(nodes, "winslow", tolerance=1e-10) ** 2).sum()

    slope = jax.jit(jax.grad(loss))
    first = slope(START)
    capsys.readouterr()
    count = len(traces)
    second = slope(START + 0.01)
    assert len(traces) == count
    assert not capsys.readouterr().err
    assert first.shape == second.shape == START.shape
    assert not np.allclose(first, second)


def test_vmap_solves_one_grid_after_the_other(jax):
    from gridgen_sym.jax import optimize

    several = np.stack([START, START * 1.1])
    found = jax.vmap(lambda nodes: optimize(nodes, "winslow"))(several)
    assert np.allclose(found[0], gg.optimize(gg.Grid(START), "winslow").grid.xy, atol=1e-8)
    assert found.shape == several.shape


def test_single_precision_is_refused():
    import jax
    import torch

    import gridgen_sym.jax
    import gridgen_sym.torch

    if not jax.config.jax_enable_x64:
        with pytest.raises(gg.GridgenError, match=r"grids need double precision: call jax.config.update"):
            gridgen_sym.jax.optimize(START, "winslow")
    with pytest.raises(gg.GridgenError, match=r"nodes is a tensor of torch.float32: use .double\(\)"):
        gridgen_sym.torch.optimize(torch.tensor(START, dtype=torch.float32), "winslow")
