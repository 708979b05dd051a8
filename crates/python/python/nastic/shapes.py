"""Distances between shapes, and their points."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _nastic
from .errors import Error
from .result import Result

Shape = str | os.PathLike[str] | Result


@dataclass(frozen=True)
class Cloud:
    """Nodes of a body or of a part of it, in the case's unit of length."""

    #: Numbers of the nodes.
    nodes: NDArray[np.int64]
    #: Their reference positions, `[nodes][3]`.
    reference: NDArray[np.float64]
    #: Where they are.
    points: NDArray[np.float64]


def compare(
    a: Shape,
    b: Shape,
    *,
    surface: str | Sequence[str] | None = None,
    region: str | Sequence[str] | None = None,
    scale: float | None = None,
) -> dict[str, Any]:
    """How far two shapes are apart, as `nastic compare` measures it (docs/results.md): `a_to_b` and `b_to_a` with `mean`, `rms`, `largest`,
    `chamfer`, `hausdorff`, and `node_by_node` of two states of one mesh.

    `a`, `b`: results with `out`, their directories, states of them (`DIR/motion_0040`), .vtu, .msh and .vtk files, clouds (.csv, .npy, .ply).
    `scale`: what the lengths of `b` are multiplied with.
    """
    return json.loads(_nastic.compare(_path(a), _path(b), surface=_names(surface, region), region=_names(region, None), scale=scale))


def cloud(
    directory: Shape,
    state: str | None = None,
    *,
    surface: str | Sequence[str] | None = None,
    region: str | Sequence[str] | None = None,
) -> Cloud:
    """The points of a state of a result directory: the optimum, the equilibrium or the last instant unless `state` names another one."""
    found = _nastic.cloud(_path(directory), state=state, surface=_names(surface, region), region=_names(region, None))
    return Cloud(*found)


def _path(shape: Shape) -> Path:
    if not isinstance(shape, Result):
        return Path(shape)
    if shape.directory is None:
        raise Error("shapes are read from the files of a run: give the command an out=\"DIRECTORY\"")
    return shape.directory


def _names(names: str | Sequence[str] | None, others: str | Sequence[str] | None) -> list[str]:
    if names is not None and others is not None:
        raise Error("a part is one of surface and region, not both")
    return [names] if isinstance(names, str) else list(names or [])
