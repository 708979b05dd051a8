"""What a gradient costs from Python beyond the same call in Rust, at about 10,000 unknowns.

    target/python-package/bin/python scripts/python-overhead.py [ROUNDS]        after scripts/test-python.sh

The same controls in the same order, each from the states before it: `benches/gradient.rs` in Rust, `Problem.value_and_gradient` here.
Rust and Python take turns, ROUNDS times (6); of every control the least time counts.
"""

import json
import subprocess
import sys
import time
from pathlib import Path

import nastic
import numpy as np

ROOT = Path(__file__).resolve().parents[1]
N, CONTROLS, REPEAT, THREADS = 4, 7, 3, 2


def in_rust() -> tuple[int, np.ndarray]:
    arguments = [f"n={N}", f"rounds={REPEAT}", f"threads={THREADS}"]
    command = ["cargo", "bench", "--quiet", "--bench", "gradient", "--", *arguments]
    out = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout
    found = json.loads(next(line for line in out.splitlines() if line.startswith("{")))
    return found["unknowns"], np.array(found["seconds"])


def in_python() -> np.ndarray:
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
    return least


rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 6
rust, python = np.full(CONTROLS, np.inf), np.full(CONTROLS, np.inf)
for _ in range(rounds):
    unknowns, seconds = in_rust()
    rust, python = np.minimum(rust, seconds), np.minimum(python, in_python())
overhead = python.sum() / rust.sum() - 1
print(f"{unknowns} unknowns: Rust {rust.mean() * 1e3:.2f} ms, Python {python.mean() * 1e3:.2f} ms a gradient, {overhead:+.1%}")
