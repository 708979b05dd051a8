"""How far a command is: for a callback, and as a bar of tqdm."""

from __future__ import annotations

import contextlib
import json
import sys
from collections.abc import Iterator
from typing import Any, Callable

from .errors import CaseError

#: What is called with how far a command is.
Callback = Callable[[dict[str, Any]], object]


@contextlib.contextmanager
def listener(callback: Callback | None, progress: bool | None) -> Iterator[Callable[[str], None] | None]:
    """What the compiled part calls with lines of JSON; None where nobody listens.

    `progress`: a bar of tqdm if True; if None where standard error is a terminal and tqdm is installed.
    """
    bar = _bar(progress)
    if callback is None and bar is None:
        yield None
        return

    def told(line: str) -> None:
        standing = json.loads(line)
        if bar is not None:
            bar.show(standing)
        if callback is not None:
            callback(standing)

    try:
        yield told
    finally:
        if bar is not None:
            bar.close()


def _bar(progress: bool | None) -> _Bar | None:
    if progress is False or (progress is None and not sys.stderr.isatty()):
        return None
    try:
        from tqdm.auto import tqdm
    except ImportError:
        if progress:
            raise CaseError("progress=True draws a bar by tqdm, which is not installed: pip install tqdm, or give a callback") from None
        return None
    return _Bar(tqdm)


class _Bar:
    """One bar for each phase that has steps or iterations, a line with the time for others."""

    def __init__(self, tqdm: Any) -> None:
        self._tqdm = tqdm
        self._bar: Any = None
        self._of: tuple[str, int | None] | None = None

    def show(self, standing: dict[str, Any]) -> None:
        is_run = "iterations" in standing
        done, whole = (standing.get("iteration"), standing.get("iterations")) if is_run else (standing.get("step"), standing.get("steps"))
        of = ("optimize" if is_run else standing["phase"], whole)
        if of != self._of:
            self.close()
            unit = " iterations" if is_run else " steps"
            self._bar, self._of = self._tqdm(total=whole, desc=of[0], unit=unit, leave=False), of
        self._bar.n = done or 0
        about = [f"cost {standing['cost']:.4e}"] if standing.get("cost") is not None else []
        about += [f"t = {standing['time']:.4g} of {standing['end']:.4g}"] if "time" in standing else []
        self._bar.set_postfix_str("; ".join([*about, standing["line"]] if standing["line"] else about), refresh=False)
        self._bar.refresh()

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
            self._bar = self._of = None
