"""Ctrl-C, and other threads of Python while nastic computes."""

import json
import signal
import subprocess
import sys
import threading
import time

import nastic
import pytest

#: A large solve, or a run without an end of its own.
CASE = """
import nastic, signal, sys
case = nastic.Case({
    "nastic": 1,
    "mesh": {"box": {"size": [1, 0.2, 0.2], "cells": CELLS, "element": "hex20"}},
    "materials": [{"region": "body", "law": "neo_hooke", "young": "300 kPa", "poisson": 0.45}],
    "supports": [{"surface": "x-", "fix": ["x", "y", "z"]}],
    "actuation": [{"name": "tension", "kind": "fiber_tension", "region": "body", "direction": [1, 0, 0]}],
    "controls": [{"of": "tension", "space": "cell", "start": "-100 kPa * Z / 0.2 m"}],
    "costs": [{"kind": "tracking", "surface": "x+", "target": ["X - 0.3", "Y", "Z + 0.5"]}],
    "optimizer": {"max_iterations": 100000, "tolerance": 1e-14},
})
signal.signal(signal.SIGINT, signal.default_int_handler)
"""


def interrupted(cells: str, code: str) -> tuple[str, float]:
    """Sends Ctrl-C once the program has said "now"; what it said after that, and how long it took to end."""
    program = subprocess.Popen([sys.executable, "-c", f"CELLS = {cells}\n" + CASE + code], stdout=subprocess.PIPE, text=True)
    try:
        assert program.stdout.readline() == "now\n"
        time.sleep(0.2)
        began = time.monotonic()
        program.send_signal(signal.SIGINT)
        said, _ = program.communicate(timeout=120)
        assert program.returncode == 0
        return said, time.monotonic() - began
    finally:
        program.kill()


def test_ctrl_c_ends_a_solve():
    said, _ = interrupted(
        "[50, 10, 10]",
        """
problem = case.problem()
print("now", flush=True)
try:
    problem.value(problem.start)
except KeyboardInterrupt:
    print("interrupted", problem.evaluations, flush=True)
"""
    )
    assert said == "interrupted 0\n", "the one solve goes on to its end"


def test_ctrl_c_ends_an_optimisation_and_keeps_what_was_found(tmp_path):
    said, _ = interrupted(
        "[10, 2, 2]",
        f"""
def callback(trial):
    if trial["trial"] == 0:
        print("now", flush=True)

try:
    case.optimize(callback=callback, out={str(tmp_path)!r}, report=False)
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""
    )
    assert said == "interrupted\n"
    found = json.loads((tmp_path / "result.json").read_text())
    assert found["converged"] is False and (tmp_path / "optimum.vtu").is_file()


def test_the_interpreter_lock_is_released(bar):
    """While a problem is evaluated in one thread, another one counts."""
    bar["mesh"]["box"]["cells"] = [16, 4, 4]
    problem = bar.problem(threads=1)
    counted, done = [], threading.Event()

    def count():
        while not done.is_set():
            counted.append(time.perf_counter())
            time.sleep(0.001)

    # The interpreter itself changes threads between calls only: there is one call.
    sys.setswitchinterval(10.0)
    try:
        counter = threading.Thread(target=count)
        counter.start()
        began = time.perf_counter()
        problem.gradient(problem.start)
        ended = time.perf_counter()
        done.set()
        counter.join()
    finally:
        sys.setswitchinterval(0.005)
    within = [at for at in counted if began < at < ended]
    assert len(within) >= 3, f"{len(within)} counts in {ended - began:.3f} s"


def test_a_callback_may_use_the_package(bar):
    problem = bar.problem()
    values = []
    bar["optimizer"]["max_iterations"] = 2
    bar.optimize(callback=lambda trial: values.append(problem.value(problem.start - trial["trial"])))
    assert len(values) >= 2


def test_the_callback_runs_on_the_thread_of_the_caller(bar):
    bar["optimizer"]["max_iterations"] = 1
    seen = set()
    bar.optimize(callback=lambda trial: seen.add(threading.get_ident()))
    assert seen == {threading.get_ident()}
    with pytest.raises(TypeError):
        bar.optimize(callback=lambda: None)


def test_the_version_is_that_of_the_library():
    assert nastic.__version__.count(".") == 2
