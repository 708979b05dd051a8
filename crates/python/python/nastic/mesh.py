"""Meshes from NumPy arrays."""

from __future__ import annotations

import hashlib
from typing import Any, Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _nastic
from .errors import CaseError


class Mesh:
    """A checked mesh, which may stand in a case wherever a mesh file may.

    `points`: positions, `[nodes][3]`, in plane strain also `[nodes][2]`, in the case's unit of length.
    `cells`: node numbers by kind of cell, `{"tet10": array [cells][10]}`, in VTK's order of nodes. Kinds: tet4 tet10 hex8 hex20 hex27,
    in plane strain tri3 tri6 quad4 quad8 quad9.
    `regions`: numbers of cells by name, counted from 0 through all kinds; also boolean arrays, one entry per cell. Without any, all cells are
    the region "body".
    `surfaces`: by name either node numbers of every facet, `[facets][nodes]`, or node numbers (or a boolean array, one entry per node):
    then the surface is made of the boundary facets all of whose nodes are among them.
    `nodes`: node sets by name, as node numbers or boolean arrays.

    Cells of negative volume are renumbered and unused nodes dropped; `notes` tells. Immutable; arrays are read-only.

    Raises CaseError for what makes no mesh: unknown kinds, numbers out of range, facets of no cell, degenerate cells.
    """

    points: NDArray[np.float64]
    cells: dict[str, NDArray[np.int64]]
    regions: dict[str, NDArray[np.int64]]
    #: Pairs of cell and face, `[facets][2]`, by name.
    surfaces: dict[str, NDArray[np.int64]]
    nodes: dict[str, NDArray[np.int64]]
    #: What was mended.
    notes: list[str]

    def __init__(
        self,
        points: ArrayLike,
        cells: Mapping[str, ArrayLike],
        regions: Mapping[str, ArrayLike] | None = None,
        surfaces: Mapping[str, ArrayLike] | None = None,
        nodes: Mapping[str, ArrayLike] | None = None,
        *,
        name: str = "mesh",
    ) -> None:
        where = _array(points, np.float64, "points", 2)
        kinds = [(kind, _array(own, np.int64, f"cells {kind!r}", 2)) for kind, own in cells.items()]
        count = sum(len(own) for _, own in kinds)
        regions_ = [(key, _numbers(own, count, f"region {key!r}")) for key, own in (regions or {}).items()]
        facets, of_nodes = [], []
        for key, own in (surfaces or {}).items():
            if np.ndim(own) == 2:
                facets.append((key, _array(own, np.int64, f"surface {key!r}", 2)))
            else:
                of_nodes.append((key, _numbers(own, len(where), f"surface {key!r}")))
        sets = [(key, _numbers(own, len(where), f"nodes {key!r}")) for key, own in (nodes or {}).items()]
        self.name = name
        self._given = (where, kinds, regions_, facets, of_nodes, sets)
        self._mesh = _nastic.Mesh(name, *self._given)
        for key, value in self._mesh.arrays().items():
            for array in value.values() if isinstance(value, dict) else [value]:
                if isinstance(array, np.ndarray):
                    array.flags.writeable = False
            setattr(self, key, value)
        self._key = f"arrays:{self._digest()}"

    def _digest(self) -> str:
        """What distinguishes this mesh from others: its name in the case, and so in the case's hash."""
        hashed = hashlib.sha256(self.name.encode())
        for part in self._given:
            for label, array in part if isinstance(part, list) else [("points", part)]:
                hashed.update(f"{label} {array.shape}".encode())
                hashed.update(array.tobytes())
            hashed.update(b";")
        return hashed.hexdigest()[:16]

    def __reduce__(self) -> tuple[Any, ...]:
        return _rebuild, (self.name, *self._given)

    def __deepcopy__(self, memo: object) -> Mesh:
        return self

    def __repr__(self) -> str:
        cells = ", ".join(f"{len(own)} {kind}" for kind, own in self.cells.items())
        names = [f"{key} {', '.join(own)}" for key, own in vars(self).items() if key in _NAMED and own]
        return f"nastic.Mesh({len(self.points)} points; cells: {cells}; {'; '.join(names)})"


_NAMED = ("regions", "surfaces", "nodes")


def _rebuild(name: str, points: Any, cells: Any, regions: Any, facets: Any, of_nodes: Any, sets: Any) -> Mesh:
    return Mesh(points, dict(cells), dict(regions), dict(facets + of_nodes), dict(sets), name=name)


def _array(values: ArrayLike, kind: type[np.generic], what: str, dimensions: int) -> NDArray[Any]:
    array = np.asarray(values)
    if array.ndim != dimensions:
        raise CaseError(f"{what}: an array of {dimensions} dimensions is wanted, found the shape {array.shape}")
    if not np.can_cast(array.dtype, kind, casting="same_kind") and not np.issubdtype(array.dtype, np.unsignedinteger):
        raise CaseError(f"{what}: numbers of type {np.dtype(kind)} are wanted, found {array.dtype}")
    array = np.array(array, dtype=kind, order="C")
    array.flags.writeable = False
    return array


def _numbers(values: ArrayLike, count: int, what: str) -> NDArray[np.int64]:
    array = np.asarray(values)
    if array.dtype == bool:
        if array.shape != (count,):
            raise CaseError(f"{what}: a boolean array has one entry for each of {count}, found the shape {array.shape}")
        array = np.flatnonzero(array)
    if array.size == 0:
        array = array.astype(np.int64)
    return _array(array, np.int64, what, 1)
