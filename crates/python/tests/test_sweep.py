"""Sweeps in this process, in others, and where one of these dies."""

import multiprocessing
import os
import signal
from concurrent.futures import Executor, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool

import nastic
import numpy as np
import pytest

VALUES = {"materials/0/young": ["250 kPa", "300 kPa"], "costs/0/weight": [1.0, 2.0, 3.0]}


def pool(workers: int = 2) -> ProcessPoolExecutor:
    return ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn"))


def same(runs: list[nastic.Run], others: list[nastic.Run]) -> bool:
    """Whether all results have the same bits."""
    pairs = [(a.result, b.result) for a, b in zip(runs, others, strict=True)]
    return all(
        a.result["cost"] == b.result["cost"]
        and a.history[-1]["trial"] == b.history[-1]["trial"]
        and np.array_equal(a.displacement, b.displacement)
        and np.array_equal(a.controls["tension"], b.controls["tension"])
        for a, b in pairs
    )


@pytest.fixture
def short(bar: nastic.Case) -> nastic.Case:
    bar["optimizer"]["max_iterations"] = 6
    return bar


def test_runs_are_those_of_the_case_with_their_values(short):
    told = []
    runs = nastic.sweep(short, VALUES, progress=lambda done, count, run: told.append((done, count, run)))
    assert [tuple(run.values.values()) for run in runs] == [(y, w) for y in ("250 kPa", "300 kPa") for w in (1.0, 2.0, 3.0)]
    assert [(done, count) for done, count, _ in told] == [(k, 6) for k in range(1, 7)] and [run for *_, run in told] == runs
    alone = short.copy()
    alone["materials"][0]["young"], alone["costs"][0]["weight"] = "300 kPa", 2.0
    assert same([runs[4]], [nastic.Run({}, alone.optimize())])
    assert short["materials"][0]["young"] == "300 kPa" and short["costs"][0].get("weight") is None
    # A list of combinations, and another command.
    some = nastic.sweep(short, [{"costs/0/weight": 2.0}, {"controls/0/start": "0 Pa"}], command="solve")
    assert [run.result.result["command"] for run in some] == ["solve", "solve"]
    assert np.all(some[1].result.displacement == 0) and np.any(some[0].result.displacement != 0)


def test_a_run_that_fails_does_not_end_the_sweep(short):
    runs = nastic.sweep(short, {"materials/0/poisson": [0.3, 0.7, 0.2]}, command="solve")
    assert [run.error is None for run in runs] == [True, False, True] and runs[1].result is None
    assert isinstance(runs[1].error, nastic.CaseError) and "poisson" in str(runs[1].error)
    with pool(1) as client:
        there = nastic.sweep(short, {"materials/0/poisson": [0.3, 0.7]}, command="solve", client=client)
    assert isinstance(there[1].error, nastic.CaseError) and there[1].error.problems == runs[1].error.problems


def test_what_cannot_be_swept_is_told_before_any_run(short):
    class Never(Executor):
        def submit(self, *_):
            raise AssertionError("nothing is to be run")

    for values, command, part in [
        ({"materials/1/young": [1]}, "optimize", "materials/1/young"),
        ({"matter/0": [1]}, "optimize", "matter/0"),
        ({"materials/0/young": "250 kPa"}, "optimize", "are a list"),
        ({"materials/0/young": [1e5]}, "fly", "fly"),
    ]:
        with pytest.raises(nastic.CaseError, match=part):
            nastic.sweep(short, values, command=command, client=Never())


def test_other_processes_give_the_same_bits_in_the_order_of_the_values(short):
    here = nastic.sweep(short, VALUES)
    with pool() as client:
        there = nastic.sweep(short, VALUES, client=client, threads=1)
    assert same(there, here)


def test_a_pool_that_loses_a_process_leaves_what_has_ended_and_a_new_one_makes_the_rest(short):
    here = nastic.sweep(short, VALUES)
    with pool(1) as client:

        def kill(done: int, *_: object) -> None:
            if done == 2:
                for process in list(client._processes.values()):
                    os.kill(process.pid, signal.SIGKILL)

        broken = nastic.sweep(short, VALUES, client=client, progress=kill)
    ended = [run for run in broken if run.result is not None]
    assert 2 <= len(ended) < 6
    assert all(isinstance(run.error, BrokenProcessPool) for run in broken if run.result is None)
    told = []
    with pool() as client:
        again = nastic.sweep(short, VALUES, client=client, earlier=broken, progress=lambda *one: told.append(one))
    assert same(again, here) and len(told) == 6
    assert [run.result for run in again if any(run.result is old.result for old in ended)] == [run.result for run in ended]


def test_a_pool_that_is_broken_before_says_so_of_every_run(short):
    with pool(1) as client:
        client.submit(os.kill, client.submit(os.getpid).result(), signal.SIGKILL).exception()
        runs = nastic.sweep(short, VALUES, client=client)
    assert all(isinstance(run.error, BrokenProcessPool) and run.result is None for run in runs)


def test_dask_gives_the_same_bits_also_where_a_worker_dies(short):
    distributed = pytest.importorskip("dask.distributed", reason="dask[distributed] is not installed")
    here = nastic.sweep(short, VALUES)
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        assert same(nastic.sweep(short, VALUES, client=client, threads=1), here)
        killed = []

        def kill(done: int, *_: object) -> None:
            if done == 1:
                killed.append(cluster.workers[0].pid)
                os.kill(killed[0], signal.SIGKILL)

        short["title"] = "Another name, or Dask would hand out what it has"
        there = nastic.sweep(short, VALUES, client=client, threads=1, progress=kill)
    assert killed and [run.error for run in there] == [None] * 6 and same(there, here)


def test_an_exception_in_progress_ends_the_sweep_and_takes_back_what_has_not_begun(short):
    taken_back = []

    class Future:
        def add_done_callback(self, callback):
            callback(self)

        def result(self):
            return short.check()

        def cancel(self):
            taken_back.append(self)

    class Client:
        def submit(self, *_):
            return Future()

    def stop(*_: object) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        nastic.sweep(short, VALUES, client=Client(), progress=stop)
    assert len(taken_back) == 5
