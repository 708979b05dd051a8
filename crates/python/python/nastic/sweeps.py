"""Sweeps: one run per combination of values, in this process or in those of a client."""

from __future__ import annotations

import itertools
import os
import queue
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from .case import Case
from .errors import CaseError
from .result import Result


class Future(Protocol):
    """What `submit` of a client gives; those of `concurrent.futures` and of Dask are such."""

    def result(self) -> Any: ...
    def add_done_callback(self, callback: Callable[[Any], object], /) -> object: ...
    def cancel(self) -> object: ...


class Client(Protocol):
    """Who runs functions: an executor of `concurrent.futures`, a `dask.distributed.Client`."""

    def submit(self, function: Callable[..., Any], /, *arguments: Any) -> Any: ...


@dataclass
class Run:
    """One run of a sweep.

    `values`: its values by path. `result`: what it found, or None. `error`: why there is no result: a SolveError or CaseError of its own, or what
    the client says of a worker that died.
    """

    values: dict[str, Any]
    result: Result | None = None
    error: Exception | None = None


def sweep(
    case: Case,
    values: Mapping[str, Sequence[Any]] | Iterable[Mapping[str, Any]],
    *,
    command: str = "optimize",
    client: Client | None = None,
    threads: int | None = None,
    progress: Callable[[int, int, Run], object] | None = None,
    earlier: Iterable[Run] = (),
) -> list[Run]:
    """Runs a case once for every combination of values; the runs in their order, whoever made them and whenever.

    `values`: lists of values by path, as `{"materials/0/young": ["250 kPa", "300 kPa"]}`, of which all combinations are run, the last one varying
    fastest; or the combinations themselves, a dictionary each. `command`: "optimize", "solve", "gradient" or "check". `client`: who runs them, an
    executor of `concurrent.futures` or a Dask client; this process, one after the other, if None. `threads`: those of each run; results do not
    depend on it. `progress`: called after every run with how many have ended, how many there are, and the run. `earlier`: runs of an
    earlier sweep of the same case; those of them that have a result are taken over.

    A run that fails has an `error` and does not end the sweep. A path that the case lacks is a CaseError before any run.
    """
    if command not in ("optimize", "solve", "gradient", "check"):
        raise CaseError(f'a sweep runs "optimize", "solve", "gradient" or "check", not {command!r}')
    runs = [Run(dict(one)) for one in _combinations(values)]
    tasks = {k: (_with(case, run.values), case.directory, case.name, command, threads) for k, run in enumerate(runs)}
    known = {_key(run.values): run.result for run in earlier if run.result is not None}
    done = itertools.count(1)

    def ended(k: int, get: Callable[[], Result]) -> None:
        run = runs[k]
        try:
            run.result = get()
        except Exception as error:
            run.error = error
        if progress is not None:
            progress(next(done), len(runs), run)

    for k, run in enumerate(runs):
        if _key(run.values) in known:
            del tasks[k]
            ended(k, lambda run=run: known[_key(run.values)])
    if client is None:
        for k, task in tasks.items():
            ended(k, lambda task=task: _run(*task))
    else:
        _submit(client, tasks, ended)
    return runs


def _submit(client: Client, tasks: dict[int, tuple[Any, ...]], ended: Callable[[int, Callable[[], Result]], None]) -> None:
    """Hands all tasks to a client and waits for them, in the order in which they end."""
    over: queue.SimpleQueue[int] = queue.SimpleQueue()
    futures: dict[int, Future] = {}
    try:
        for k, task in tasks.items():
            try:
                futures[k] = client.submit(_run, *task)
            except RuntimeError as error:  # a pool that lost a process takes nothing more
                ended(k, lambda error=error: _raise(error))
            else:
                futures[k].add_done_callback(lambda _, k=k: over.put(k))
        for _ in range(len(futures)):
            k = over.get()
            # not kept: a Dask cluster holds a result for as long as someone has its future
            ended(k, futures.pop(k).result)
    finally:
        for future in futures.values():
            future.cancel()


def _run(case: dict[str, Any], directory: os.PathLike[str], name: str, command: str, threads: int | None) -> Result:
    """One run, in whatever process."""
    return getattr(Case(case, directory=directory, name=name), command)(threads=threads)


def _raise(error: Exception) -> Result:
    raise error


def _combinations(values: Mapping[str, Sequence[Any]] | Iterable[Mapping[str, Any]]) -> Iterable[Mapping[str, Any]]:
    if not isinstance(values, Mapping):
        return list(values)
    for path, own in values.items():
        if isinstance(own, (str, bytes)) or not isinstance(own, Iterable):
            raise CaseError(f"the values of {path!r} are a list, as [{own!r}]")
    return [dict(zip(values, one)) for one in itertools.product(*values.values())]


def _key(values: Mapping[str, Any]) -> str:
    """Equal for equal values."""
    return Case(values)._document()[1]


def _with(case: Case, values: Mapping[str, Any]) -> dict[str, Any]:
    """The case with values at their paths."""
    changed = case.copy()
    for path, value in values.items():
        *parents, last = path.split("/")
        at: Any = changed
        try:
            for part in parents:
                at = at[int(part) if isinstance(at, list) else part]
            at[int(last) if isinstance(at, list) else last] = value
        except (KeyError, IndexError, ValueError, TypeError):
            raise CaseError(f"{case.name}: the case has no place for {path!r}") from None
    return dict(changed)
