"""Reads VTU and PVD files back with vtk and meshio and compares them with what they should hold.

    python readback.py DIRECTORY

Every DIRECTORY/*.json says what a file beside it holds:

    {"file": "a.vtu", "points": [x, y, z, ...], "cells": [{"type": 25, "nodes": [...]}, ...], "affine": true,
     "point_data": {"displacement": {"components": 3, "values": [...]}}, "cell_data": {...}}
    {"collection": "a.pvd", "steps": [[0.0, "a.vtu"], ...]}

Numbers are compared to the bit. "affine" says that cells are straight, so that every node must lie where VTK's own
parametric coordinates put it: that proves the node order. Exit: 0 all agree, 1 something differs, 3 vtk or meshio
cannot be imported.
"""

import json
import sys
import xml.etree.ElementTree
from pathlib import Path

try:
    import meshio
    import numpy as np
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy
except ImportError as error:
    print(f"cannot import {error.name}: pip install vtk meshio")
    sys.exit(3)

vtk.vtkObject.GlobalWarningDisplayOff()


class Differs(Exception):
    """The file does not hold what it should."""


def same(what, found, wanted):
    """Equal shape and bits; NaN equals NaN."""
    found, wanted = np.asarray(found), np.asarray(wanted)
    if found.shape != wanted.shape:
        raise Differs(f"{what}: shape {found.shape}, not {wanted.shape}")
    nan = wanted.dtype.kind == "f" and found.dtype.kind == "f"
    if not np.array_equal(found, wanted, equal_nan=nan):
        at = np.argwhere(~((found == wanted) | ((found != found) & (wanted != wanted))))[0]
        raise Differs(f"{what}: {found[tuple(at)]!r}, not {wanted[tuple(at)]!r}, at {at.tolist()}")


def table(array):
    """The values of an expected array, one row per entity; a single component has no second axis."""
    values = np.array(array["values"], dtype=float)
    return values if array["components"] == 1 else values.reshape(-1, array["components"])


def by_vtk(path, expected):
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    # Update reports failure through events only.
    problems = []
    reader.AddObserver("ErrorEvent", lambda *_: problems.append("error"))
    reader.Update()
    grid = reader.GetOutput()
    if problems or grid.GetNumberOfCells() == 0:
        raise Differs("vtk cannot read it")
    same("points", vtk_to_numpy(grid.GetPoints().GetData()), np.array(expected["points"], dtype=float).reshape(-1, 3))
    same("cell count", grid.GetNumberOfCells(), len(expected["cells"]))
    for at, wanted in enumerate(expected["cells"]):
        cell = grid.GetCell(at)
        same(f"type of cell {at}", cell.GetCellType(), wanted["type"])
        ids = cell.GetPointIds()
        same(f"nodes of cell {at}", [ids.GetId(k) for k in range(ids.GetNumberOfIds())], wanted["nodes"])
        if expected.get("affine"):
            straight(at, cell)
    for of, data, arrays in [("point", grid.GetPointData(), expected["point_data"]),
                             ("cell", grid.GetCellData(), expected["cell_data"])]:
        for name, array in arrays.items():
            found = data.GetArray(name)
            if found is None:
                raise Differs(f"{of} array {name} is missing")
            same(f"{of} array {name}", vtk_to_numpy(found), table(array))


def straight(at, cell):
    """Every node lies where an affine map of VTK's parametric coordinates puts it."""
    count = cell.GetNumberOfPoints()
    xi = np.array(cell.GetParametricCoords()[: 3 * count]).reshape(count, 3)
    x = np.array([cell.GetPoints().GetPoint(k) for k in range(count)])
    design = np.hstack([xi, np.ones((count, 1))])
    fit, *_ = np.linalg.lstsq(design, x, rcond=None)
    off = np.abs(design @ fit - x).max()
    if off > 1e-12:
        raise Differs(f"cell {at}: a node is {off} from its place, the node order is wrong")


def by_meshio(path, expected):
    mesh = meshio.read(path)
    same("points", mesh.points, np.array(expected["points"], dtype=float).reshape(-1, 3))
    cells = [(block.type, nodes) for block in mesh.cells for nodes in block.data]
    same("cell count", len(cells), len(expected["cells"]))
    for at, ((kind, nodes), wanted) in enumerate(zip(cells, expected["cells"])):
        same(f"type of cell {at}", meshio._vtk_common.meshio_to_vtk_type[kind], wanted["type"])
        order = meshio._vtk_common.meshio_to_vtk_order(kind)
        same(f"nodes of cell {at}", nodes if order is None else nodes[order], wanted["nodes"])
    for name, array in expected["point_data"].items():
        same(f"point array {name}", mesh.point_data[name], table(array))
    for name, array in expected["cell_data"].items():
        same(f"cell array {name}", np.concatenate(mesh.cell_data[name]), table(array))


def collection(path, expected):
    root = xml.etree.ElementTree.parse(path).getroot()
    if root.tag != "VTKFile" or root.get("type") != "Collection":
        raise Differs("it is no collection")
    steps = [[float(item.get("timestep")), item.get("file")] for item in root.iter("DataSet")]
    if steps != expected["steps"]:
        raise Differs(f"steps {steps}, not {expected['steps']}")
    for _, file in steps:
        if not (path.parent / file).is_file():
            raise Differs(f"{file} is missing")


def main():
    directory = Path(sys.argv[1])
    descriptions = sorted(directory.glob("*.json"))
    if not descriptions:
        sys.exit(f"no descriptions in {directory}")
    failures = 0
    for description in descriptions:
        expected = json.loads(description.read_text())
        path = directory / expected.get("file", expected.get("collection"))
        readers = [collection] if "collection" in expected else [by_vtk, by_meshio]
        for reader in readers:
            try:
                reader(path, expected)
                print(f"{path.name}: {reader.__name__} agrees")
            except Exception as error:  # A reader may fail in any way; the rest is still worth knowing.
                failures += 1
                print(f"{path.name}: {reader.__name__}: {type(error).__name__}: {error}")
    sys.exit(1 if failures else 0)


main()
