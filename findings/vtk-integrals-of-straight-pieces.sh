#!/usr/bin/env bash
# VTK integrates over second-order cells as over straight pieces between their nodes, fields as linear in each piece.
#
# VTK 9.7.2, whose filters pyvista calls; felupe 11.3.0 (through meshio 5.3.5) reads the same .vtu file and integrates the shape functions exactly.
# A unit cube as one triquadratic hexahedron (type 29), its top bulged by 8 x (1 - x) y (1 - y), has the volume 1 + 2/9. VTK's two ways to a volume
# give neither that nor the same: vtkIntegrateAttributes 1.125, vtkCellSizeFilter 1.083 (1.125 if the cell is called Lagrange, type 72). A right
# tetrahedron of 10 nodes and straight edges has the right volume 1/6, but the integral of x^2 over it is 0.0234 instead of 1/60, 41 % too large;
# over the cube, not bulged, 0.375 instead of 1/3.
# vtkGradientFilter on the same cells uses the shape functions: exactly 2 x at every node.
# Errors fall with the square of the cell's size. Volumes, masses and energies of coarse second-order meshes are better taken from the program
# that made the file, or from one with shape functions.
#
# Seen:  volume, bulged cube: felupe 1.2222, vtkIntegrateAttributes 1.1250, vtkCellSizeFilter 1.0833, the same as type 72 1.1250
#        integral of x^2:  tetrahedron 0.0167 and 0.0234, cube 0.3333 and 0.3750 (felupe, vtkIntegrateAttributes)
set -euo pipefail
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
python3 -m venv "$place/python"
"$place/python/bin/pip" install --quiet --disable-pip-version-check felupe==11.3.0 meshio==5.3.5 numpy==2.2.6 vtk==9.7.2
cd "$place"
python/bin/python - <<'END'
import sys

import felupe
import meshio
import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy


def nodes_of(cell):
    return np.reshape([cell.GetParametricCoords()[k] for k in range(3 * cell.GetNumberOfPoints())], (-1, 3))


def grid_of(kind, points):
    """One cell, with the squares of x as point data."""
    grid, places, square, ids = vtk.vtkUnstructuredGrid(), vtk.vtkPoints(), vtk.vtkDoubleArray(), vtk.vtkIdList()
    square.SetName("square")
    for node, point in enumerate(points):
        places.InsertNextPoint(point)
        square.InsertNextValue(point[0] ** 2)
        ids.InsertNextId(node)
    grid.SetPoints(places)
    grid.GetPointData().AddArray(square)
    grid.InsertNextCell(kind, ids)
    return grid


def of_filter(algorithm, grid, array, points=False):
    algorithm.SetInputData(grid)
    algorithm.Update()
    output = algorithm.GetOutput()
    return vtk_to_numpy((output.GetPointData() if points else output.GetCellData()).GetArray(array))


def slopes(grid):
    algorithm = vtk.vtkGradientFilter()
    algorithm.SetInputScalars(vtk.vtkDataObject.FIELD_ASSOCIATION_POINTS, "square")
    return of_filter(algorithm, grid, "Gradients", points=True)[:, 0]


def by_felupe(grid, kind):
    """Volume and integral of the squares."""
    writer = vtk.vtkXMLUnstructuredGridWriter()
    writer.SetInputData(grid)
    writer.SetFileName("cell.vtu")
    assert writer.Write() == 1
    read = meshio.read("cell.vtu")
    block = read.cells[0]
    region = kind(felupe.Mesh(read.points, block.data, block.type))
    square = felupe.Field(region, values=read.point_data["square"].reshape(-1, 1)).interpolate()[0]
    return region.dV.sum(), (square * region.dV).sum()


size = lambda grid: of_filter(vtk.vtkCellSizeFilter(), grid, "Volume")[0]
whole = lambda grid: of_filter(vtk.vtkIntegrateAttributes(), grid, "Volume")[0]
square = lambda grid: of_filter(vtk.vtkIntegrateAttributes(), grid, "square", points=True)[0]
cube = nodes_of(vtk.vtkTriQuadraticHexahedron())
x, y, z = cube.T
bulged = np.column_stack([x, y, z * (1 + 8 * x * (1 - x) * y * (1 - y))])
grid = grid_of(vtk.VTK_TRIQUADRATIC_HEXAHEDRON, bulged)
seen = [by_felupe(grid, felupe.RegionTriQuadraticHexahedron)[0], whole(grid), size(grid), size(grid_of(vtk.VTK_LAGRANGE_HEXAHEDRON, bulged))]
print("volume of the bulged cube, felupe, vtkIntegrateAttributes, vtkCellSizeFilter, the same as type 72:", *seen)
for name, grid, kind in (
    ("tetrahedron", grid_of(vtk.VTK_QUADRATIC_TETRA, nodes_of(vtk.vtkQuadraticTetra())), felupe.RegionQuadraticTetra),
    ("cube", grid_of(vtk.VTK_TRIQUADRATIC_HEXAHEDRON, cube), felupe.RegionTriQuadraticHexahedron),
):
    own, pieces = by_felupe(grid, kind), [whole(grid), square(grid)]
    print(f"{name}, volume and integral of x^2, felupe:", *own, "vtkIntegrateAttributes:", *pieces)
    seen += [*own, *pieces]
    nodes = vtk_to_numpy(grid.GetPoints().GetData())
    assert np.allclose(slopes(grid), 2 * nodes[:, 0])
expected = [11 / 9, 9 / 8, 13 / 12, 9 / 8, 1 / 6, 1 / 60, 1 / 6, 3 / 128, 1, 1 / 3, 1, 3 / 8]
if not np.allclose(seen, expected, rtol=1e-6):
    sys.exit("VTK or felupe behaves otherwise now")
END
