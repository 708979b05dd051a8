"""States of a problem as arrays, and derivatives of losses on them."""

import numpy as np
import pytest

import nastic


def test_states_are_those_of_a_solve(bar):
    problem = bar.problem(accuracy=1e-10)
    state = problem.state(problem.start)
    solved = bar.solve()
    assert np.allclose(state.displacement, solved.displacement, rtol=0, atol=1e-9)
    assert np.array_equal(state.points, solved.points) and state.cells.keys() == solved.cells.keys()
    assert np.allclose(state.cell_data["J"], solved.cell_data["J"], atol=1e-8)
    assert state.cell_data["cauchy_stress"].shape == solved.cell_data["cauchy_stress"].shape
    assert problem.evaluations == 1
    assert problem.state(problem.start, "").name == ""
    with pytest.raises(nastic.CaseError, match="no state 'soft'"):
        problem.state(problem.start, "soft")


def loss(problem, m, name=None):
    """Of the whole field, not linear; with its derivative by u."""
    u = problem.displacement(m, name)
    weight = np.sin(np.arange(u.size)).reshape(u.shape)
    return np.sum(weight * u + 50.0 * u**2), weight + 100.0 * u


@pytest.mark.parametrize("name", [None, "stiff"])
def test_losses_on_displacements_have_their_gradient(request, name):
    case = request.getfixturevalue("bar" if name is None else "two_loads")
    problem = case.problem(accuracy=1e-12)
    m = problem.start
    gradient = problem.displacement_vjp(m, loss(problem, m, name)[1], name)
    assert gradient.shape == m.shape and problem.evaluations == 1
    for along in (gradient / np.linalg.norm(gradient), np.cos(np.arange(m.size)) / np.sqrt(m.size)):
        step = 2e-3 * np.linalg.norm(m)
        ahead, behind = (loss(problem, m + sign * step * along, name)[0] for sign in (1.0, -1.0))
        wanted = (ahead - behind) / (2 * step)
        assert abs(gradient @ along - wanted) < 1e-5 * np.linalg.norm(gradient), (gradient @ along, wanted)


def test_what_does_not_fit_is_refused(two_loads):
    problem = two_loads.problem()
    m = problem.start
    assert list(problem.states(m)) == ["soft", "stiff"]
    with pytest.raises(nastic.CaseError, match="there are 2 states: choose one of 'soft', 'stiff'"):
        problem.displacement(m)
    with pytest.raises(nastic.CaseError, match="shape"):
        problem.displacement_vjp(m, np.zeros(7), "soft")
    w = np.zeros_like(problem.displacement(m, "soft"))
    assert not problem.displacement_vjp(m, w, "soft").any()
    w[0, 0] = np.nan
    with pytest.raises(nastic.CaseError, match="not finite"):
        problem.displacement_vjp(m, w, "soft")


def test_motions_have_a_state_at_their_end(bar):
    bar["materials"][0]["density"] = "1000 kg/m^3"
    bar["time"] = {"end": "20 ms", "step": "10 ms"}
    problem = bar.problem()
    u = problem.displacement(problem.start)
    assert np.abs(u).max() > 0
    with pytest.raises(nastic.Error, match="in time"):
        problem.displacement_vjp(problem.start, np.ones_like(u))


def test_jax_has_whole_fields_as_a_layer(bar):
    jax = pytest.importorskip("jax", reason="JAX is not installed")
    import nastic.jax

    jax.config.update("jax_enable_x64", True)
    problem = bar.problem(accuracy=1e-10)
    field = nastic.jax.displacement(problem)
    m = jax.numpy.asarray(problem.start)
    gradient = jax.jit(jax.grad(lambda m: (field(m) ** 2).sum()))(m)
    wanted = problem.displacement_vjp(problem.start, 2 * problem.displacement(problem.start))
    assert np.allclose(gradient, wanted, rtol=1e-12)


def test_torch_has_whole_fields_as_a_layer(bar):
    torch = pytest.importorskip("torch", reason="PyTorch is not installed")
    import nastic.torch

    problem = bar.problem(accuracy=1e-10)
    m = torch.tensor(problem.start, requires_grad=True)
    (nastic.torch.displacement(problem)(m) ** 2).sum().backward()
    wanted = problem.displacement_vjp(problem.start, 2 * problem.displacement(problem.start))
    assert np.allclose(m.grad.numpy(), wanted, rtol=1e-12)
