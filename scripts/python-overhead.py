"""What a gradient costs from Python beyond the same call in Rust, at about 10,000 unknowns.

    target/python-package/bin/python scripts/python-overhead.py [ROUNDS] [THREADS]        after scripts/test-python.sh

The same controls in the same order, each from the states before it: `benches/gradient.rs` in Rust, `Problem.value_and_gradient` here.
Rust and Python take turns, ROUNDS times (6); of every control the least time counts. On a machine with other work one thread (of
2) and more rounds give steadier figures.
"""

import json
import subprocess
import sys
import time
from pathlib import Path

import nastic
import numpy as np

ROOT = Path(__file__).resolve().parents[1]
N, CONTROLS, REPEAT = 4, 7, 3
ROUNDS, THREADS = (int(given) for given in (sys.argv[1:] + ["6", "2"][len(sys.argv) - 1 :]))


def in_rust() -> tuple[int, np.ndarray]:
    arguments = [f"n={N}", f"rounds={REPEAT}", f"threads={THREADS}"]
    command = ["cargo", "bench", "--quiet", "--bench", "gradient", "--", *arguments]
    out = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout
    found = json.loads(next(line for line in out.splitlines() if line.startswith("{")))
    return found["unknowns"], np.array(found["seconds"])


def in_python() -> tuple[np.ndarray, float]:
    """Seconds of every control, and of a call that finds its control evaluated: what the way to Rust and back takes alone."""
    case = nastic.load(ROOT / "examples/cases/tip_tracking.json")
    case["mesh"]["box"]["cells"] = [5 * N, N, N]
    problem = case.problem(threads=THREADS)
    least = np.full(CONTROLS, np.inf)
    for _ in range(REPEAT):
        for k in range(CONTROLS):
            m = np.full(len(problem), -1e4 * (1 + 0.1 * k))
            began = time.perf_counter()
            problem.value_and_gradient(m)
            least[k] = min(least[k], time.perf_counter() - began)
    call = np.inf
    for _ in range(200):
        began = time.perf_counter()
        problem.value_and_gradient(m)
        call = min(call, time.perf_counter() - began)
    return least, call


rust, python, call = np.full(CONTROLS, np.inf), np.full(CONTROLS, np.inf), np.inf
for _ in range(ROUNDS):
    unknowns, seconds = in_rust()
    rust = np.minimum(rust, seconds)
    seconds, again = in_python()
    python, call = np.minimum(python, seconds), min(call, again)
overhead = python.sum() / rust.sum() - 1
print(
    f"{unknowns} unknowns, {THREADS} threads: Rust {rust.mean() * 1e3:.2f} ms, Python {python.mean() * 1e3:.2f} ms a gradient, {overhead:+.1%}; "
    f"a call alone {call * 1e3:.3f} ms"
)
