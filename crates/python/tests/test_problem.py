"""The cost as a function: values, gradients, and what drives it."""

import threading

import nastic
import numpy as np
import pytest
from conftest import ROOT


def test_values_and_gradients_are_those_of_the_command(bar):
    problem, found = bar.problem(), bar.gradient()
    value, gradient = problem.value_and_gradient(problem.start)
    assert value == pytest.approx(found.result["cost"]["total"], rel=1e-7)
    assert np.allclose(gradient, found.gradient["tension"], rtol=1e-6, atol=0)
    assert np.array_equal(problem.start, found.controls["tension"])


def test_the_gradient_is_that_of_differences(bar):
    problem = bar.problem(accuracy=1e-12)
    m = problem.start - 1e4
    gradient = problem.gradient(m)
    direction = np.cos(np.arange(len(m)))
    step = 20.0
    quotient = (problem.value(m + step * direction) - problem.value(m - step * direction)) / (2 * step)
    assert quotient == pytest.approx(gradient @ direction, rel=1e-6)


def test_products_with_second_derivatives_are_those_of_differences(bar, two_loads):
    for case in (bar, two_loads):
        problem = case.problem(accuracy=1e-12)
        m = problem.start - 1e4
        a, b = np.cos(np.arange(len(m))), np.sin(3 + np.arange(len(m)))
        along_a, along_b = problem.hessian_vector(m, a), problem.hessian_vector(m, b)
        assert along_a @ b == pytest.approx(along_b @ a, rel=1e-10)
        assert problem.evaluations == 1
        step = 100.0
        quotient = (problem.gradient(m + step * a) - problem.gradient(m - step * a)) / (2 * step)
        assert np.allclose(along_a, quotient, rtol=0, atol=1e-5 * np.abs(quotient).max())


def test_directions_that_do_not_fit_are_refused(bar):
    problem = bar.problem()
    with pytest.raises(nastic.CaseError, match="the direction has the shape"):
        problem.hessian_vector(problem.start, [1.0])


def test_a_risk_with_a_kink_says_so(two_loads):
    """At rest all scenarios cost the same, and their deviation has a kink."""
    two_loads["risk"] = {"mean_deviation": {"lambda": 1}}
    two_loads["controls"][0]["start"] = 0
    problem = two_loads.problem()
    with pytest.raises(nastic.errors.Error, match="has no second derivatives where all costs are equal"):
        problem.hessian_vector(problem.start, np.ones(len(problem)))


def test_value_and_then_gradient_solve_once(bar):
    problem = bar.problem()
    m = problem.start
    value = problem.value(m)
    problem.gradient(m)
    problem.gradient(m.copy())
    assert problem.value_and_gradient(m)[0] == value and problem.evaluations == 1
    problem.value(m + 1)
    assert problem.evaluations == 2
    problem.value(m)
    problem.reset()
    assert problem.value(m) == value and problem.evaluations == 4


def test_the_same_history_gives_the_same_bits(bar):
    def history(problem):
        return [problem.value_and_gradient(problem.start - 5e3 * k) for k in range(4)]

    first, second = history(bar.problem(threads=1)), history(bar.problem(threads=2))
    for (a, da), (b, db) in zip(first, second):
        assert a == b and np.array_equal(da, db)


def test_a_control_starts_from_the_states_of_the_last_one(bar):
    """Within the accuracy asked of states the values are those from rest; with little of it they are others."""
    rough, exact = bar.problem(accuracy=1e-2), bar.problem()
    near, from_rest = [], []
    for k in range(4):
        near.append(rough.value(rough.start - 5e3 * k))
    for k in range(4):
        rough.reset()
        from_rest.append(rough.value(rough.start - 5e3 * k))
    assert near[0] == from_rest[0] and near != from_rest
    assert np.allclose(near, [exact.value(exact.start - 5e3 * k) for k in range(4)], rtol=1e-2, atol=0)


def test_the_layout_says_what_the_vector_holds(bar):
    bar["actuation"].append({"name": "pressure", "kind": "turgor", "region": "body"})
    bar["controls"].append({"of": "pressure", "space": "uniform", "start": 10, "lower": -5})
    problem = bar.problem()
    tension, pressure = problem.layout["tension"], problem.layout["pressure"]
    assert (tension.slice, tension.space, tension.components, tension.unit) == (slice(0, 8), "cell", 1, "Pa")
    assert (pressure.slice, pressure.space) == (slice(8, 9), "uniform")
    assert len(problem) == 9 and problem.start[pressure.slice] == [10]
    assert (problem.lower[:8] == -100e3).all() and problem.lower[8] == -5
    assert (problem.upper[:8] == 0).all() and problem.upper[8] == np.inf
    assert {name: part.shape for name, part in problem.split(problem.start).items()} == {"tension": (8,), "pressure": (1,)}
    with pytest.raises(ValueError):
        problem.start[0] = 1


def test_vectors_of_a_length_are_no_box():
    problem = nastic.load(ROOT / "examples/cases/t_two_loads.json").problem()
    lengths = {name: (c.components, c.norm is not None, c.max_norm is not None) for name, c in problem.layout.items()}
    assert any(norm for _, norm, _ in lengths.values())
    vectors = [c for c in problem.layout.values() if c.components > 1]
    assert vectors and all(problem.split(problem.start)[c.name].shape[1] == c.components for c in vectors)
    assert all(np.isinf(problem.lower[c.slice]).all() for c in vectors)


def test_the_last_stage_is_the_one_that_counts():
    case = nastic.load(ROOT / "examples/cases/cantilever_arc.json")
    first, last = case.problem(stage=0), case.problem()
    assert first.stages == last.stages == len(case["costs"][0]["stages"]) and last.stage == last.stages - 1
    with pytest.raises(nastic.CaseError, match="stage 9: the costs have"):
        case.problem(stage=9)


@pytest.mark.parametrize(
    ("vector", "message"),
    [(np.zeros(7), r"shape \(8,\), found \(7,\)"), (np.zeros((8, 1)), "shape"), (np.full(8, np.nan), "entry 0 .* nan")],
)
def test_vectors_that_do_not_fit_are_refused(bar, vector, message):
    with pytest.raises(nastic.CaseError, match=message):
        bar.problem().value(vector)


def test_a_control_without_equilibrium_is_an_error_and_the_next_one_is_not(bar):
    problem = bar.problem()
    value = problem.value(problem.start)
    with pytest.raises(nastic.SolveError) as caught:
        problem.value(problem.start + 1e8)
    assert caught.value.kind in ("no_convergence", "inverted", "linear")
    assert problem.value(problem.start - 1) == pytest.approx(value, rel=1e-3)


def test_a_state_takes_no_more_iterations_than_allowed(bar):
    told = []
    problem = bar.problem(max_newton=3, callback=told.append)
    with pytest.raises(nastic.SolveError, match="budget of 3 Newton iterations") as caught:
        problem.value(problem.start - 1e5)
    assert caught.value.kind == "no_convergence"
    assert [line["newton"] for line in told] == [1, 2, 3]
    assert set(told[0]) == {"member", "load", "newton", "residual", "step", "energy"}
    with pytest.raises(nastic.CaseError, match="max_newton is 0"):
        bar.problem(max_newton=0)


def test_a_callback_that_raises_ends_the_call_and_the_next_one_is_whole(bar):
    def refuse(line):
        if line["newton"] == 2:
            raise KeyError("enough")

    told, problem = [], bar.problem(callback=refuse)
    with pytest.raises(KeyError, match="enough"):
        problem.value(problem.start - 1e5)
    free = bar.problem(callback=told.append)
    value = free.value(free.start)
    assert told and bar.problem().value(free.start) == value


def test_another_thread_stops_a_call(bar):
    problem = bar.problem(callback=lambda line: problem.stop() if line["newton"] == 2 else None)
    with pytest.raises(nastic.SolveError, match="cancelled") as caught:
        problem.value(problem.start - 1e5)
    assert caught.value.kind == "cancelled"


def test_a_case_without_controls_or_costs_is_no_problem(bar):
    for key in ("controls", "costs"):
        case = bar.copy()
        del case[key]
        if key == "controls":
            del case["costs"][1]
            case["actuation"][0]["tension"] = "-10 kPa"
        with pytest.raises(nastic.CaseError, match=f"a problem needs {key}"):
            case.problem()
    with pytest.raises(nastic.CaseError, match="accuracy is 2"):
        bar.problem(accuracy=2)


def test_scenarios_are_a_problem_too(two_loads):
    two_loads["risk"] = {"mean_deviation": {"lambda": 0.5}}
    problem = two_loads.problem()
    m, step = problem.start, 20.0 * np.sin(np.arange(8.0))
    quotient = (problem.value(m + step) - problem.value(m - step)) / 2
    assert quotient == pytest.approx(problem.gradient(m) @ step, rel=1e-5)


def test_threads_of_python_take_turns(bar):
    problem = bar.problem()
    found = {}

    def evaluate(k):
        found[k] = problem.value(problem.start - 100.0 * k)

    threads = [threading.Thread(target=evaluate, args=(k,)) for k in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    fresh = bar.problem()
    assert all(found[k] == pytest.approx(fresh.value(fresh.start - 100.0 * k), rel=1e-6) for k in range(6))


def test_scipy_reaches_what_optimize_reaches(bar):
    optimize = pytest.importorskip("scipy.optimize", reason="SciPy is not installed")
    best = bar.optimize()
    problem = bar.problem()
    bounds = optimize.Bounds(problem.lower, problem.upper)
    # Scaled, so that L-BFGS-B's stopping tests see numbers of the size of one.
    scale, cost = 1e5, problem.value(problem.start)

    def function(x):
        value, gradient = problem.value_and_gradient(scale * x)
        return value / cost, scale / cost * gradient

    box = optimize.Bounds(bounds.lb / scale, bounds.ub / scale)
    found = optimize.minimize(
        function, problem.start / scale, jac=True, bounds=box, method="L-BFGS-B", options={"ftol": 1e-12, "gtol": 1e-7}
    )
    assert found.success
    assert cost * found.fun == pytest.approx(best.result["cost"]["total"], rel=1e-6)
    assert best.result["cost"]["total"] < 0.2 * cost
    assert np.abs(scale * found.x - best.controls["tension"]).max() < 2e3


def low_ceiling(bar):
    """Its end has to stay below a ceiling that the best control without it enters."""
    shape = {"half_space": {"point": [0, 0, 0.3], "normal": [0, 0, -1]}}
    bar["constraints"] = [
        {"name": "ceiling", "obstacle": {"surface": "x+", "shape": shape}},
        {"name": "size", "cost": {"kind": "control_norm", "of": "tension"}, "at_most": 1e12},
    ]
    return bar


def test_constraints_have_values_and_derivatives(bar):
    problem = low_ceiling(bar).problem(accuracy=1e-12)
    ceiling, size = problem.constraints.values()
    state = bar.solve()
    end = np.isclose(state.points[:, 0], state.points[:, 0].max())
    n = np.count_nonzero(end)
    assert (ceiling.name, ceiling.equal, ceiling.slice) == ("ceiling", False, slice(0, n))
    assert (size.slice, size.scale) == (slice(n, n + 1), 1e12)
    # deformed heights of the nodes against that of the ceiling
    heights = state.points[end, 2] + state.displacement[end, 2]
    assert np.allclose(np.sort(problem.constraint_values(problem.start)[:n]), np.sort(heights - 0.3), atol=1e-7)
    m = problem.start - 1e4
    jacobian = problem.constraint_jacobian(m)
    direction, step = np.cos(np.arange(len(m))), 20.0
    ahead, behind = (problem.constraint_values(m + s * direction) for s in (step, -step))
    assert np.allclose(jacobian @ direction, (ahead - behind) / (2 * step), rtol=1e-6)
    y = np.arange(1.0, n + 2.0)
    assert np.allclose(problem.constraint_vjp(m, y), y @ jacobian, rtol=1e-9)
    with pytest.raises(nastic.CaseError, match="weights of the constraints have the shape"):
        problem.constraint_vjp(m, [1.0])


def test_scipy_keeps_constraints(bar):
    optimize = pytest.importorskip("scipy.optimize", reason="SciPy is not installed")
    case = low_ceiling(bar)
    case["optimizer"] = {"method": "lbfgs", "max_iterations": 300, "tolerance": 1e-4}
    best = case.optimize()
    problem, scale = case.problem(), 1e5
    first = problem.value(problem.start)

    def function(x):
        value, gradient = problem.value_and_gradient(scale * x)
        return value / first, scale / first * gradient

    box = optimize.Bounds(problem.lower / scale, problem.upper / scale)
    found = optimize.minimize(
        function,
        problem.start / scale,
        jac=True,
        bounds=box,
        constraints=problem.nonlinear_constraint(scale),
        method="SLSQP",
        options={"maxiter": 200, "ftol": 1e-9},
    )
    assert found.success, found.message
    assert problem.constraint_values(scale * found.x).max() < 1e-6
    assert first * found.fun == pytest.approx(best.result["cost"]["total"], rel=1e-3)


def test_scipy_takes_the_products(bar):
    """Newton's method with conjugate gradients needs far fewer gradients than a quasi-Newton method, to a lower cost."""
    scipy = pytest.importorskip("scipy.optimize")
    problem = bar.problem()
    scale, first = 1e5, problem.value(problem.start)

    def cost(x):
        value, gradient = problem.value_and_gradient(scale * x)
        return value / first, scale / first * gradient

    def curvature(x, v):
        return scale**2 / first * problem.hessian_vector(scale * x, v)

    start = problem.start / scale
    newton = scipy.minimize(cost, start, jac=True, hessp=curvature, method="Newton-CG", options={"xtol": 1e-9})
    quasi = scipy.minimize(cost, start, jac=True, method="BFGS", options={"gtol": 1e-9})
    assert newton.success and np.linalg.norm(newton.jac) < 1e-6
    assert newton.fun <= quasi.fun * (1 + 1e-6) and newton.nit < quasi.nit
    box = scipy.Bounds(problem.lower / scale, problem.upper / scale)
    options = {"maxiter": 200, "gtol": 1e-9, "xtol": 1e-12}
    inside = scipy.minimize(cost, start, jac=True, hessp=curvature, bounds=box, method="trust-constr", options=options)
    lbfgsb = scipy.minimize(cost, start, jac=True, bounds=box, method="L-BFGS-B", options={"maxiter": 500, "ftol": 1e-15})
    assert inside.fun == pytest.approx(lbfgsb.fun, rel=1e-3)
    assert (problem.lower <= scale * inside.x).all() and (scale * inside.x <= problem.upper).all()


def test_jax_differentiates_the_cost(bar):
    jax = pytest.importorskip("jax", reason="JAX is not installed")
    import nastic.jax

    jax.config.update("jax_enable_x64", True)
    problem = bar.problem()
    cost = nastic.jax.cost(problem)
    m = jax.numpy.asarray(problem.start)
    value, gradient = jax.jit(jax.value_and_grad(lambda m: 2 * cost(m - 100.0)))(m)
    expected, by_control = problem.value_and_gradient(problem.start - 100.0)
    assert float(value) == pytest.approx(2 * expected, rel=1e-9)
    assert np.allclose(gradient, 2 * by_control, rtol=1e-9, atol=0)
    both = jax.vmap(cost)(jax.numpy.stack([m, m - 100.0]))
    assert np.allclose(both, [problem.value(problem.start), expected], rtol=1e-7, atol=0)


def test_torch_differentiates_the_cost(bar, monkeypatch):
    torch = pytest.importorskip("torch", reason="PyTorch is not installed")
    import nastic.torch

    problem = bar.problem()
    cost = nastic.torch.cost(problem)
    m = torch.tensor(problem.start, requires_grad=True)
    (2 * cost(m - 100.0)).backward()
    expected, by_control = problem.value_and_gradient(problem.start - 100.0)
    assert np.allclose(m.grad.numpy(), 2 * by_control, rtol=1e-9, atol=0)
    # No adjoint where no gradient is wanted.
    monkeypatch.delattr(nastic.Problem, "value_and_gradient")
    with torch.no_grad():
        assert float(cost(m - 100.0)) == pytest.approx(expected, rel=1e-9)


def test_a_skin_is_a_control_as_any_other(bar):
    """The shape of the bar by the nodes of its upper side, beside its tension."""
    bar["actuation"].append({"name": "back", "kind": "free_shape", "region": "body", "surface": "z+", "keep": "z-", "filter": 0.25})
    bar["controls"][0]["space"] = "uniform"
    bar["controls"].append({"of": "back", "space": "node", "start": "0.02 * X", "lower": -0.1, "upper": 0.1})
    bar["constraints"] = [{"cost": {"kind": "shape_shrinkage"}, "at_most": 1.25}]
    problem = bar.problem(accuracy=1e-12)
    gradient = problem.split(problem.gradient(problem.start))["back"]
    assert gradient.shape == (8,)
    direction = np.zeros(len(problem.start))
    direction[-8:] = np.cos(np.arange(8))
    step = 1e-4
    value = [problem.value(problem.start + sign * step * direction) for sign in (1, -1)]
    assert (value[0] - value[1]) / (2 * step) == pytest.approx(gradient @ direction[-8:], rel=1e-6)
    bar["optimizer"]["max_iterations"] = 15
    found = bar.optimize()
    assert found.result["cost"]["total"] < 0.9 * bar.solve().result["cost"]["total"]
    moved = found.point_data["back"]
    assert np.abs(moved[:, 2]).max() > 1e-3
    assert not moved[found.points[:, 2] == 0].any()
    bar["actuation"][1]["surface"] = "x-"
    with pytest.raises(nastic.CaseError, match="holds all of its nodes where they are drawn"):
        bar.check()
