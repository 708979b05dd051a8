"""Parameters of material laws from test data."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from . import _nastic


def fit(
    data: str | os.PathLike[str] | Mapping[str, Any],
    *,
    out: str | os.PathLike[str] | None = None,
    directory: str | os.PathLike[str] = ".",
    kind: str = "uniaxial",
    bulk: str | float | None = None,
    area: str | float | None = None,
    length: str | float | None = None,
    laws: Sequence[str] = (),
) -> dict[str, Any]:
    """Fits laws to test data, as `nastic fit` does; the dictionary of fit.json (docs/fit.md).

    `data`: a file, or a dictionary with its keys, names of files counted from `directory`. `out`: where fit.json and fit.svg go; nowhere without it.
    A CSV file of one test may stand for it, with what a data file would say of it: `kind`, `bulk` ("1 GPa"), `area` and `length` of a table of forces and
    extensions, `laws`.
    """
    if not isinstance(data, Mapping) and Path(data).suffix.lower() == ".csv":
        specimen = {"area": area, "length": length}
        test = {"kind": kind, "file": os.fspath(data), **{key: one for key, one in specimen.items() if one is not None}}
        data = {"nastic_fit": 1, "tests": [test], **({} if bulk is None else {"bulk": bulk}), **({"laws": list(laws)} if laws else {})}
    elif kind != "uniaxial" or laws or any(one is not None for one in (bulk, area, length)):
        raise TypeError("kind, bulk, area, length and laws are of CSV files: in data files and dictionaries they are keys")
    with tempfile.TemporaryDirectory() as place:
        if isinstance(data, Mapping):
            found = dict(data)
            found["tests"] = [_placed(test, Path(directory)) for test in found.get("tests", [])]
            file = Path(place) / "fit.json"
            file.write_text(json.dumps(found))
        else:
            file = Path(data)
        _, text, _ = _nastic.fit(file, Path(place) / "out" if out is None else Path(out))
    return json.loads(text)


def _placed(test: Any, directory: Path) -> Any:
    if isinstance(test, Mapping) and isinstance(test.get("file"), (str, os.PathLike)):
        return {**test, "file": str((directory / test["file"]).resolve())}
    return test
