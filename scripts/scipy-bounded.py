"""What SciPy's L-BFGS-B takes on the bounded problems of crates/opt/tests/bounded.

    python scripts/scipy-bounded.py          writes crates/opt/tests/bounded/scipy.json anew (SciPy)

The problems are those of the Rust module `bounded`, which names their sources, written once more: as residuals r with the cost r . r, or as a
cost. Derivatives are complex steps, exact to rounding. Starts outside the bounds are projected onto them.

Of every problem the file holds start, cost and derivative there; the `optimum`, the least cost found from SciPy's end by least squares and by
repeated runs; `run`, SciPy's own end at `ftol = 0` and a projected gradient of 1e-8 of the first; `reached`, the iterations and evaluations after
which SciPy had first evaluated a cost no larger than optimum + 1e-8 |optimum| + 1e-12 |first cost|, null if it never had.
"""

import json
import warnings
from pathlib import Path

import numpy as np
import scipy
from numpy import arctan, array, cos, exp, full, log, ones, pi, sin, sqrt, zeros
from scipy.optimize import least_squares, minimize

OUT = Path(__file__).resolve().parents[1] / "crates/opt/tests/bounded/scipy.json"
INF = np.inf
BARD = array([0.14, 0.18, 0.22, 0.25, 0.29, 0.32, 0.35, 0.39, 0.37, 0.58, 0.73, 0.96, 1.34, 2.10, 4.39])
GAUSS = array([9, 44, 175, 540, 1295, 2420, 3521, 3989, 3521, 2420, 1295, 540, 175, 44, 9]) * 1e-4
KOWALIK = array([0.1957, 0.1947, 0.1735, 0.1600, 0.0844, 0.0627, 0.0456, 0.0342, 0.0323, 0.0235, 0.0246])
KOWALIK_U = array([4, 2, 1, 0.5, 0.25, 0.167, 0.125, 0.1, 0.0833, 0.0714, 0.0625])
OSBORNE_1 = array(
    [844, 908, 932, 936, 925, 908, 881, 850, 818, 784, 751, 718, 685, 658, 628, 603, 580, 558, 538, 522, 506, 490, 478]
    + [467, 457, 448, 438, 431, 424, 420, 414, 411, 406]
) / 1000
OSBORNE_2 = array(
    [1366, 1191, 1112, 1013, 991, 885, 831, 847, 786, 725, 746, 679, 608, 655, 616, 606, 602, 626, 651, 724, 649, 649]
    + [694, 644, 624, 661, 612, 558, 533, 495, 500, 423, 395, 375, 372, 391, 396, 405, 428, 429, 523, 562, 607, 653]
    + [672, 708, 633, 668, 645, 632, 591, 559, 597, 625, 739, 710, 729, 720, 636, 581, 428, 292, 162, 98, 54]
) / 1000


def wood(x):
    return array(
        [10 * (x[1] - x[0] ** 2), 1 - x[0], sqrt(90) * (x[3] - x[2] ** 2), 1 - x[2]]
        + [sqrt(10) * (x[1] + x[3] - 2), (x[1] - x[3]) / sqrt(10)]
    )


def helical_valley(x):
    theta = arctan(x[1] / x[0]) / (2 * pi) + (0.5 if x[0].real < 0 else 0)
    return array([10 * (x[2] - 10 * theta), 10 * (sqrt(x[0] ** 2 + x[1] ** 2) - 1), x[2]])


def watson(x):
    t, j = np.arange(1, 30)[:, None] / 29, np.arange(len(x))
    slopes = (j[1:] * x[1:] * t ** (j[1:] - 1)).sum(axis=1)
    return np.append(slopes - (x * t**j).sum(axis=1) ** 2 - 1, [x[0], x[1] - x[0] ** 2 - 1])


def chebyquad(x):
    n, y = len(x), 2 * x - 1
    before, now, r = ones(n), y, []
    for i in range(1, n + 1):
        r.append(now.mean() + (1 / (i * i - 1) if i % 2 == 0 else 0))
        before, now = now, 2 * y * now - before
    return array(r)


def hs25(x):
    i = np.arange(1, 100) / 100
    u = 25 + (-50 * log(i)) ** (2 / 3)
    return exp(-((u - x[1]) ** x[2]) / x[0]) - i


def rosenbrock(x):
    return array([10 * (x[1] - x[0] ** 2), 1 - x[0]])


def mgh_2(x):
    return array([-13 + x[0] + ((5 - x[1]) * x[1] - 2) * x[1], -29 + x[0] + ((x[1] + 1) * x[1] - 14) * x[1]])


def mgh_6(x):
    i = np.arange(1, 11)
    return 2 + 2 * i - exp(i * x[0]) - exp(i * x[1])


def mgh_8(x):
    u = np.arange(1, 16)
    return BARD - x[0] - u / ((16 - u) * x[1] + np.minimum(u, 16 - u) * x[2])


def mgh_9(x):
    t = (7 - np.arange(15)) / 2
    return x[0] * exp(-x[1] * (t - x[2]) ** 2 / 2) - GAUSS


def mgh_12(x):
    t = np.arange(1, 11) / 10
    return exp(-t * x[0]) - exp(-t * x[1]) - x[2] * (exp(-t) - exp(-10 * t))


def mgh_13(x):
    return array([x[0] + 10 * x[1], sqrt(5) * (x[2] - x[3]), (x[1] - 2 * x[2]) ** 2, sqrt(10) * (x[0] - x[3]) ** 2])


def mgh_15(x):
    u = KOWALIK_U
    return KOWALIK - x[0] * (u * u + u * x[1]) / (u * u + u * x[2] + x[3])


def mgh_16(x):
    t = np.arange(1, 21) / 5
    return (x[0] + t * x[1] - exp(t)) ** 2 + (x[2] + x[3] * sin(t) - cos(t)) ** 2


def mgh_17(x):
    t = 10 * np.arange(33)
    return OSBORNE_1 - (x[0] + x[1] * exp(-t * x[3]) + x[2] * exp(-t * x[4]))


def mgh_18(x):
    t = np.arange(1, 14) / 10
    y = exp(-t) - 5 * exp(-10 * t) + 3 * exp(-4 * t)
    return x[2] * exp(-t * x[0]) - x[3] * exp(-t * x[1]) + x[5] * exp(-t * x[4]) - y


def mgh_19(x):
    t = np.arange(65) / 10
    humps = sum(x[k] * exp(-((t - x[k + 7]) ** 2) * x[k + 4]) for k in (1, 2, 3))
    return OSBORNE_2 - x[0] * exp(-t * x[4]) - humps


def mgh_27(x):
    return np.append(x[:-1] + x.sum() - (len(x) + 1), x.prod() - 1)


def box(n, lower, upper):
    return full(n, float(lower)), full(n, float(upper))


# name: (residuals, or cost if it is a scalar; start; lower; upper)
OSBORNE_2_BOX = [1, 0.5, 0, 0.6, 0, 0, 0, 0, 0, 0, 0], [150, 100, 100, 100, 100, 500, 500, 500, 100, 10, 0]
WATSON_6_BOX = [-0.015, -10, -10, -10, -10, -10], [10, 100, 100, 100, 100, 0.99]
WATSON_9_BOX = [-1e-5, 0, 0, 0, 0, -3, 0, -3, 0], [1e-5, 0.9, 0.1, 1, 1, 0, 4, 0, 2]
BROWN_BOX = [0, 1] + [0] * 8, [100, 100, 0.9] + [100] * 7
CHEBYQUAD_BOX = [0, 0, 0.1, 0, 0, 0, 0, 0], [0.04, 0.2, 0.3, 1, 1, 1, 1, 1]
PROBLEMS = {
    "HS 1": (rosenbrock, [-2, 1], [-INF, -1.5], [INF, INF]),
    "HS 2": (rosenbrock, [-2, 1], [-INF, 1.5], [INF, INF]),
    "HS 3": (lambda x: x[1] + 1e-5 * (x[1] - x[0]) ** 2, [10, 1], [-INF, 0], [INF, INF]),
    "HS 4": (lambda x: (x[0] + 1) ** 3 / 3 + x[1], [1.125, 0.125], [1, 0], [INF, INF]),
    "HS 5": (
        lambda x: sin(x[0] + x[1]) + (x[0] - x[1]) ** 2 - 1.5 * x[0] + 2.5 * x[1] + 1,
        [0, 0],
        [-1.5, -3],
        [4, 3],
    ),
    "HS 25": (hs25, [100, 12.5, 3], [0.1, 0, 0], [100, 25.6, 5]),
    "HS 38": (wood, [-3, -1, -3, -1], *box(4, -10, 10)),
    "HS 45": (lambda x: 2 - x.prod() / 120, full(5, 2), zeros(5), [1, 2, 3, 4, 5]),
    "HS 110": (lambda x: (log(x - 2) ** 2 + log(10 - x) ** 2).sum() - x.prod() ** 0.2, full(10, 9), *box(10, 2.001, 9.999)),
    "MGH 1": (rosenbrock, [-1.2, 1], [-50, 0], [0.5, 100]),
    "MGH 2": (mgh_2, [0.5, -2], [0, -30], [20, -0.9]),
    "MGH 3": (lambda x: array([1e4 * x[0] * x[1] - 1, exp(-x[0]) + exp(-x[1]) - 1.0001]), [0, 1], [0, 1], [1, 9]),
    "MGH 4": (lambda x: array([x[0] - 1e6, x[1] - 2e-6, x[0] * x[1] - 2]), [1, 1], [0, 3e-5], [1e6, 100]),
    "MGH 5": (lambda x: array([1.5, 2.25, 2.625]) - x[0] * (1 - x[1] ** array([1, 2, 3])), [1, 1], [0.6, 0.5], [10, 100]),
    "MGH 6": (mgh_6, [0.3, 0.4], [0.26, 0], [10, 20]),
    "MGH 7": (helical_valley, [-1, 0, 0], [-100, -1, -1], [0.8, 1, 1]),
    "MGH 8": (mgh_8, [1, 1, 1], [0.1, 0, 0], [50, 100, 50]),
    "MGH 9": (mgh_9, [0.4, 1, 0], [0.398, 1, -0.5], [4.2, 2, 0.1]),
    "MGH 12": (mgh_12, [0, 10, 20], [0, 5, 0], [2, 9.5, 20]),
    "MGH 13": (mgh_13, [3, -1, 0, 1], [0.1, -20, -1, -1], [100, 20, 1, 50]),
    "MGH 14": (wood, [-3, -1, -3, -1], full(4, -100), [0, 10, 100, 100]),
    "MGH 15": (mgh_15, [0.25, 0.39, 0.415, 0.39], [0, -1, 0.13, 0.12], [10, 12, 13, 12]),
    "MGH 16": (mgh_16, [25, 5, -5, -1], [-10, 0, -100, -20], [100, 15, 0, 0.2]),
    "MGH 17": (mgh_17, [0.5, 1.5, -1, 0.01, 0.02], [0, 0, -50, 0, 0], [50, 1.9, -0.1, 10, 10]),
    "MGH 18": (mgh_18, [1, 2, 1, 1, 1, 1], [0, 0, 0, 1, 0, 0], [2, 8, 1, 7, 5, 5]),
    "MGH 19": (mgh_19, [1.3, 0.65, 0.65, 0.7, 0.6, 3, 5, 7, 2, 4.5, 5.5], *OSBORNE_2_BOX),
    "MGH 20, n = 6": (watson, zeros(6), *WATSON_6_BOX),
    "MGH 20, n = 9": (watson, zeros(9), *WATSON_9_BOX),
    "MGH 27": (mgh_27, full(10, 0.5), *BROWN_BOX),
    "MGH 35": (chebyquad, np.arange(1, 9) / 9, *CHEBYQUAD_BOX),
}


def jacobian(residuals, x):
    step = 1e-30
    columns = [np.atleast_1d(residuals(x + 1j * step * unit)).imag / step for unit in np.eye(len(x))]
    return np.stack(columns, axis=1)


def cost(residuals, x):
    r = residuals(x + 0j).real
    return float(r @ r if np.ndim(r) else r)


def derivative(residuals, x):
    r = residuals(x + 0j).real
    return 2 * jacobian(residuals, x).T @ r if np.ndim(r) else jacobian(residuals, x)[0]


def projected_size(x, g, lower, upper):
    return float(np.abs(np.clip(x - g, lower, upper) - x).max())


class Lbfgsb:
    """A run of SciPy's L-BFGS-B and the cost of its every evaluation with the iterations done before it."""

    def __init__(self, residuals, start, lower, upper, gtol):
        self.residuals, self.iterations, self.log = residuals, 0, []
        options = {"ftol": 0, "gtol": gtol, "maxiter": 5000, "maxfun": 20000}
        bounds = list(zip(lower, upper))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)
            run = minimize(self.evaluate, start, jac=True, method="L-BFGS-B", bounds=bounds, options=options, callback=self.step)
        self.end, self.at = run, run.x

    def evaluate(self, x):
        value = cost(self.residuals, x)
        self.log.append((value, self.iterations))
        return value, derivative(self.residuals, x)

    def step(self, _):
        self.iterations += 1

    def reached(self, target):
        hits = (k for k, (value, _) in enumerate(self.log) if value <= target)
        k = next(hits, None)
        return None if k is None else {"iterations": self.log[k][1] + (k > 0), "evaluations": k + 1}


def polished(residuals, at, lower, upper):
    """The least cost to be had from SciPy's end, and where."""
    candidates = [at]
    for _ in range(5):
        candidates.append(Lbfgsb(residuals, candidates[-1], lower, upper, 1e-15).at)
    if np.ndim(residuals(at)):
        upper_apart = np.where(lower < upper, upper, lower + 1e-12)
        for method in ["trf", "dogbox"]:
            inside = 1e-12 * (1 + abs(at)) * (lower < upper)
            from_within = np.clip(at, lower + inside, upper_apart - inside)
            tight = dict.fromkeys(["ftol", "xtol", "gtol"], 1e-15)
            found = least_squares(
                residuals, from_within, lambda x: jacobian(residuals, x), (lower, upper_apart), method, x_scale="jac", **tight
            )
            candidates.append(np.clip(found.x, lower, upper))
    return min(candidates, key=lambda x: cost(residuals, x))


def solve(residuals, start, lower, upper):
    lower, upper = array(lower, dtype=float), array(upper, dtype=float)
    start = np.clip(array(start, dtype=float), lower, upper)
    first, g = cost(residuals, start), derivative(residuals, start)
    run = Lbfgsb(residuals, start, lower, upper, 1e-8 * np.abs(np.clip(start - g, lower, upper) - start).max())
    at = polished(residuals, run.at, lower, upper)
    optimum = cost(residuals, at)
    end = {"iterations": int(run.end.nit), "evaluations": int(run.end.nfev), "cost": float(run.end.fun), "stop": run.end.message}
    reached = run.reached(optimum + 1e-8 * abs(optimum) + 1e-12 * abs(first))
    return {"start": list(start), "first": first, "derivative": list(g), "optimum": optimum, "at": list(at), "run": end, "reached": reached}


if __name__ == "__main__":
    problems = {name: solve(*problem) for name, problem in PROBLEMS.items()}
    lines = [f"    {json.dumps(name)}: {json.dumps(problem)}" for name, problem in problems.items()]
    OUT.write_text(f'{{\n  "scipy": "{scipy.__version__}",\n  "problems": {{\n' + ",\n".join(lines) + "\n  }\n}\n")
    for name, problem in problems.items():
        print(f"{name:15} {problem['optimum']:.9e} {problem['run']['cost']:.9e} {problem['reached']} {problem['run']}")
