"""Cases: dictionaries with the keys of case files."""

from __future__ import annotations

import copy
import json
import os
from pathlib import Path
from typing import Any, Callable, Mapping

import numpy as np

from . import _nastic
from .errors import CaseError, GradientError, SolveError
from .mesh import Mesh
from .problem import Problem
from .progress import Callback, listener
from .result import Result

#: Exit codes of the program that are errors here (docs/results.md).
_FORWARD_FAILED, _GRADIENT_WRONG = 3, 5


class Case(dict[str, Any]):
    """A case: a dictionary with the keys of docs/case-files.md.

    Beside what JSON knows, values may be NumPy numbers and arrays, paths, and, where a mesh may stand, a `nastic.Mesh`. File names
    count from `directory`. `name` is what messages call the case.

    Commands work on the case as it is when they are called, release the interpreter lock and are ended by Ctrl-C. They write nothing,
    unless `out` names a directory, which then holds the files of docs/results.md. `threads`: their number, all processors if None; results
    do not depend on it. They raise CaseError (with all problems found), SolveError, OutputError.

    `progress`: how far they are as a bar of tqdm: True, False, or None for a bar where standard error is a terminal and tqdm is installed.
    `callback` of those that take one, but of `optimize`, is called with the same as a dictionary, when a phase or a step begins and at most ten times a second within one:
    `phase`, `seconds`, `line` (about the solve under way), of motions `step`, `steps`, `time`, `end`. An exception in it ends the command.
    """

    def __init__(
        self, case: Mapping[str, Any] | None = None, /, *, directory: str | os.PathLike[str] = ".", name: str = "case"
    ) -> None:
        super().__init__(copy.deepcopy(dict(case or {})))
        self.directory = Path(directory)
        self.name = name

    def copy(self) -> Case:
        """A deep copy."""
        return Case(self, directory=self.directory, name=self.name)

    __copy__ = copy

    def __repr__(self) -> str:
        return f"nastic.Case({super().__repr__()}, directory={str(self.directory)!r}, name={self.name!r})"

    def check(self, *, threads: int | None = None) -> Result:
        """Reads everything the case names and says what was understood, in `log` and `result`; solves nothing."""
        return self._run("check", None, threads)

    def solve(
        self,
        *,
        ramp: str | None = None,
        path: bool | str = False,
        minimum: bool = False,
        equilibria: int | None = None,
        modes: int | None = None,
        exact_contact: bool = False,
        half_thickness: bool = False,
        out: str | os.PathLike[str] | None = None,
        threads: int | None = None,
        report: bool = True,
        figure: bool = False,
        callback: Callback | None = None,
        progress: bool | None = None,
    ) -> Result:
        """The equilibrium at the start controls, or the motion; or, as `nastic solve` with the option of that name, one of:

        `ramp="CONTROL=FROM:TO:N"`: a curve of equilibria. `path=True`: through limit points by arc length, `path="limit"`: to the first. `minimum`:
        a stable state. `equilibria=N`: other states under the same controls. `modes=N`: eigenvalues of the tangent. `exact_contact`: without layers.
        `half_thickness`: with layers of contacts half as thick, of motions too.
        What they find stands in `result` under the same name. `figure`: figure.png and figure.svg in `out` too.
        """
        given = {"ramp": ramp, "path": path, "minimum": minimum, "equilibria": equilibria, "modes": modes, "exact_contact": exact_contact, "half_thickness": half_thickness}
        asked = [(key, str(value)) for key, value in given.items() if value is not None and value is not False]
        if len(asked) > 1:
            raise CaseError(f"solve does one of these at a time, and {' and '.join(key for key, _ in asked)} were given")
        return self._run("solve", out, threads, report=report, figure=figure, asked=asked[0] if asked else None, told=(callback, progress))

    def modes(
        self,
        count: int = 6,
        *,
        undeformed: bool = False,
        out: str | os.PathLike[str] | None = None,
        threads: int | None = None,
        report: bool = True,
        callback: Callback | None = None,
        progress: bool | None = None,
    ) -> Result:
        """The lowest frequencies and shapes of small vibrations about the equilibrium at the start controls, or about the undeformed body.

        `result["modes"]` has the frequencies in Hz; `point_data["mode_1"]`, .. the shapes, where `out` was given in its start.vtu.
        """
        asked = ("undeformed" if undeformed else "modes", str(count))
        return self._run("modes", out, threads, report=report, asked=asked, told=(callback, progress))

    def gradient(
        self,
        *,
        out: str | os.PathLike[str] | None = None,
        threads: int | None = None,
        callback: Callback | None = None,
        progress: bool | None = None,
    ) -> Result:
        """Cost and gradient at the start controls, with a short check by differences; GradientError if that fails."""
        return self._run("gradient", out, threads, told=(callback, progress))

    def optimize(
        self,
        *,
        callback: Callable[[dict[str, Any]], object] | None = None,
        out: str | os.PathLike[str] | None = None,
        threads: int | None = None,
        report: bool = True,
        restart: bool = False,
        figure: bool = False,
        progress: bool | None = None,
    ) -> Result:
        """The best control. Stopping before convergence is no error: see `Result.converged`.

        `callback` is called after every trial with its line of `history.jsonl` as a dictionary (`trial`, `iteration`, `accepted`, `cost`,
        `gradient_norm`, ..). An exception in it ends the run, and is raised here once what was found is written to `out`, if there is one.
        `restart`: whether the checkpoint of an interrupted optimisation in `out` may be replaced.
        """
        history: list[dict[str, Any]] = []

        def told(line: str) -> None:
            trial = json.loads(line)
            history.append(trial)
            if callback is not None:
                callback(copy.copy(trial))

        return self._run(
            "optimize", out, threads, report=report, restart=restart, figure=figure, history=history, callback=told, told=(None, progress)
        )

    def identify(
        self,
        *,
        out: str | os.PathLike[str] | None = None,
        threads: int | None = None,
        report: bool = True,
        restart: bool = False,
        progress: bool | None = None,
    ) -> Result:
        """The controls as parameters, from the readings of the costs: `result["identification"]` has them with intervals and what is not seen.

        `restart`: whether the checkpoint of an interrupted run in `out` may be replaced.
        """
        return self._run("identify", out, threads, report=report, restart=restart, told=(None, progress))

    def gains(
        self,
        *,
        out: str | os.PathLike[str] | None = None,
        threads: int | None = None,
        report: bool = True,
        progress: bool | None = None,
    ) -> Result:
        """Sensitivities of outputs by controls at the start, and the law `m <- m - L (y - y*)`: `result["gains"]`."""
        return self._run("gains", out, threads, report=report, told=(None, progress))

    def problem(
        self,
        *,
        threads: int | None = None,
        accuracy: float = 1e-8,
        stage: int | None = None,
        max_newton: int | None = None,
        callback: Callable[[dict[str, Any]], object] | None = None,
    ) -> Problem:
        """The cost as a function of the control vector, for optimisers of others.

        `accuracy`: relative accuracy asked of states. `stage`: the continuation stage whose cost is evaluated, the last if None. `max_newton`: Newton
        iterations that a state may take, of each load case and scenario; as many as it takes if None. `callback`: called after every Newton iteration with
        `newton`, `load`, `residual`, `step`, `energy`, `member`; an exception in it ends the call and is raised again by it.
        """
        return Problem(
            self,
            threads=threads,
            accuracy=accuracy,
            stage=stage,
            max_newton=max_newton,
            callback=callback,
        )

    def _document(self) -> tuple[str, str, dict[str, _nastic.Mesh]]:
        """Name, JSON text, and the meshes that stand for files."""
        meshes: dict[str, _nastic.Mesh] = {}

        def plain(value: object) -> Any:
            if isinstance(value, Mesh):
                meshes[value._key] = value._mesh
                return value._key
            if isinstance(value, (np.generic, np.ndarray)):
                return value.tolist()
            if isinstance(value, os.PathLike):
                return os.fspath(value)
            raise TypeError(f"a case holds what JSON knows, NumPy numbers, paths and meshes, but no {type(value).__name__}")

        try:
            text = json.dumps(self, default=plain, allow_nan=False)
        except (TypeError, ValueError, RecursionError) as error:
            raise CaseError(f"{self.name}: {error}") from error
        return str(self.directory / self.name), text, meshes

    def _run(
        self,
        command: str,
        out: str | os.PathLike[str] | None,
        threads: int | None,
        *,
        report: bool = True,
        restart: bool = False,
        figure: bool = False,
        asked: tuple[str, str] | None = None,
        history: list[dict[str, Any]] | None = None,
        callback: Callable[[str], None] | None = None,
        told: tuple[Callback | None, bool | None] = (None, False),
    ) -> Result:
        out = None if out is None else Path(out)
        with listener(*told) as progress:
            code, text, log, states = _nastic.run(
                command,
                *self._document(),
                asked=asked,
                out=out,
                threads=threads,
                report=report,
                restart=restart,
                figure=figure,
                callback=callback,
                progress=progress,
            )
        result = Result._of(json.loads(text), log, out, history or [], states)
        if code == _FORWARD_FAILED:
            raise SolveError(result.result.get("error", "no equilibrium was found"), result=result)
        if code == _GRADIENT_WRONG:
            check = result.result.get("gradient_check", {})
            raise GradientError(f"the gradient does not belong to the cost: mismatch {check.get('mismatch')}", result=result)
        return result


def load(path: str | os.PathLike[str]) -> Case:
    """Reads a case file: JSON with comments, which are lost. CaseError with the line if it is none."""
    path = Path(path)
    return Case(json.loads(_nastic.read(path)), directory=path.parent, name=path.name)


def schema() -> dict[str, Any]:
    """The JSON Schema of cases."""
    return json.loads(_nastic.schema())
