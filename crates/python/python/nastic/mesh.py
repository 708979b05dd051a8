"""Meshes from NumPy arrays."""

from __future__ import annotations

import hashlib
import os
import tempfile
from pathlib import Path
from typing import Any, Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _nastic
from .errors import CaseError
from .result import _KINDS


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

    @classmethod
    def read(cls, path: str | os.PathLike[str], *, scale: float = 1.0, name: str | None = None) -> Mesh:
        """A mesh file (Gmsh .msh, .vtu, legacy .vtk, Abaqus .inp), lengths times `scale`. A case may also name the file itself; this gives its arrays."""
        parts = _nastic.read_mesh(Path(path), scale).parts()
        regions = {} if list(parts["regions"]) == ["body"] else parts["regions"]
        return cls(parts["points"], parts["cells"], regions, parts["facets"], parts["nodes"], name=name or Path(path).stem)

    @classmethod
    def from_gmsh(cls, gmsh: Any, *, scale: float = 1.0, name: str = "mesh") -> Mesh:
        """The mesh of the model that the module `gmsh` holds, with its physical groups: `nastic.Mesh.from_gmsh(gmsh)` behind `gmsh.model.mesh.generate(3)`."""
        with tempfile.TemporaryDirectory() as place:
            file = Path(place) / f"{name}.msh"
            gmsh.write(str(file))
            return cls.read(file, scale=scale, name=name)

    @classmethod
    def from_meshio(cls, mesh: Any, *, scale: float = 1.0, name: str = "mesh") -> Mesh:
        """A `meshio.Mesh`: its cells of the highest dimension, and as regions and surfaces

        what its cell sets name, and the physical groups of Gmsh (`cell_data["gmsh:physical"]` with the names of `field_data`); point sets are node sets.
        """
        kinds = {theirs: ours for ours, (theirs, _) in _KINDS.items()}
        facets = {"line", "line3"} | {"triangle", "triangle6", "quad", "quad8", "quad9"}
        solid = any(kinds.get(block.type, "")[:3] in ("tet", "hex") for block in mesh.cells)
        bodies = [k for k, block in enumerate(mesh.cells) if block.type in kinds and (not solid or block.type not in facets)]
        sides = [k for k, block in enumerate(mesh.cells) if block.type in facets and k not in bodies]
        for block in mesh.cells:
            if block.type not in kinds and block.type not in facets and block.type != "vertex":
                raise CaseError(f"cells of the kind {block.type!r} are not known; there are {', '.join(kinds)}")
        order = sorted(bodies, key=lambda k: list(kinds.values()).index(kinds[mesh.cells[k].type]))
        cells: dict[str, Any] = {}
        for k in order:
            own = np.asarray(mesh.cells[k].data)
            kind = kinds[mesh.cells[k].type]
            cells[kind] = np.vstack([cells[kind], own]) if kind in cells else own
        groups = [(key, {k: np.asarray(own[k], dtype=np.int64) for k in range(len(own)) if own[k] is not None}) for key, own in mesh.cell_sets.items() if not key.startswith("gmsh:")]
        tags = mesh.cell_data.get("gmsh:physical")
        for key, (tag, _) in mesh.field_data.items() if tags is not None else []:
            groups.append((key, {k: np.flatnonzero(np.asarray(own) == tag) for k, own in enumerate(tags)}))
        regions: dict[str, Any] = {}
        surfaces: dict[str, Any] = {}
        first = dict(zip(order, np.cumsum([0] + [len(mesh.cells[k].data) for k in order])))
        for key, members in groups:
            inside = [first[k] + members[k] for k in order if len(members.get(k, ()))]
            around = [np.asarray(mesh.cells[k].data)[members[k]] for k in sides if len(members.get(k, ()))]
            if inside:
                regions[key] = np.concatenate(inside)
            if around:
                surfaces[key] = np.vstack(around)
        return cls(scale * np.asarray(mesh.points), cells, regions, surfaces, dict(mesh.point_sets), name=name)

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
