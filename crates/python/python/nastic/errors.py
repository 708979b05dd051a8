"""Exceptions. All are subclasses of `Error`; messages say what, where, how much, and what to try."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .result import Result


class Error(Exception):
    """Base class of all exceptions of this package."""

    def __init__(self, message: str, **attributes: Any) -> None:
        super().__init__(message)
        self.__dict__.update(attributes)


class CaseError(Error, ValueError):
    """Bad input: a case, a mesh, a control vector, an option.

    `problems`: of a case all that were found, each a dictionary with `file`, `path`, `line`, `column` (None where the case was made
    or changed by a program) and `message`.
    """

    problems: list[dict[str, Any]] = []


class SolveError(Error):
    """There is no equilibrium, or it was not found.

    `kind`: "no_convergence", "inverted", "linear", "problem" (docs/results.md), "limit_point" (of a `Problem`: the way from the control before
    turns back), "cancelled" (by `Problem.stop`), or None for a failure of another kind. `member`: scenario and load case, empty where there is one state. `file`: where the last good state was written, or None. `result`: what an
    optimisation found before memory was lacking, else None.
    """

    kind: str | None = None
    member: str = ""
    file: str | None = None
    result: Result | None = None


class GradientError(Error):
    """The gradient does not belong to the cost: the check by differences failed. `result`: what was found until then."""

    result: Result | None = None


class OutputError(Error, OSError):
    """A file could not be written, or another program writes to the output directory."""
