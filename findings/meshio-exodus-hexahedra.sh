#!/usr/bin/env bash
# Second-order hexahedra of an Exodus file come out of meshio folded, and meshio's Exodus files of them are folded for others.
#
# meshio 5.3.5, VTK 9.7.2. Exodus lists the nodes of a HEX20 as corners, edges below, upright edges, edges above; of a HEX27 then the centre, and
# below, above, left, right, front, back. VTK and meshio's own cells have the edges above before the upright ones, and the centre last. VTK's reader
# renumbers; meshio neither renumbers when it reads nor when it writes, so its own round trip looks right, and "meshio convert x.e x.vtu"
# gives a mesh whose corners alone are right. Tetrahedra of 10 nodes have the same order in both.
# Integrated by shape functions (felupe 11.3.0), a cube of the volume 8 has -2.17 after that, its Jacobian both signs.
# VTK's reader (pyvista.read) and meshio as the writer of the .vtu give the right mesh.
#
# Seen (an Exodus file by its standard):  VTK: HEX20, HEX27 as they are    meshio: upright edges and edges above exchanged, all faces of
#                                         HEX27 and the centre exchanged too; volume by felupe 8 (VTK), -2.17 (meshio)
set -euo pipefail
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
python3 -m venv "$place/python"
"$place/python/bin/pip" install --quiet --disable-pip-version-check \
    felupe==11.3.0 meshio==5.3.5 netCDF4==1.7.5 numpy==2.2.6 vtk==9.7.2
cd "$place"
python/bin/python -W ignore - <<'END'
import sys

import felupe
import meshio
import netCDF4
import numpy as np
import vtk

# Exodus' nodes by their number in VTK's cell (VTK's faces: left, right, front, back, below, above)
HEX20 = [*range(12), 16, 17, 18, 19, 12, 13, 14, 15]
HEX27 = [*HEX20, 26, 24, 25, 20, 21, 22, 23]


def nodes_of(cell):
    return 2 * np.reshape([cell.GetParametricCoords()[k] for k in range(3 * cell.GetNumberOfPoints())], (-1, 3))


def write_exodus(name, kind, points):
    """One cell whose nodes are these, in this order."""
    with netCDF4.Dataset(name, "w", format="NETCDF3_64BIT_OFFSET") as file:
        file.api_version = file.version = np.float32(5.1)
        file.floating_point_word_size, file.file_size, file.title = np.int32(8), np.int32(1), "one cell"
        count = len(points)
        sizes = dict(len_string=33, len_line=81, num_dim=3, num_nodes=count, num_elem=1, num_el_blk=1, num_el_in_blk1=1, num_nod_per_el1=count)
        for dimension, size in sizes.items():
            file.createDimension(dimension, size)
        file.createDimension("time_step", None)
        file.createVariable("time_whole", "f8", ("time_step",))
        for axis, values in zip("xyz", points.T):
            file.createVariable(f"coord{axis}", "f8", ("num_nodes",))[:] = values
        block = file.createVariable("eb_prop1", "i4", ("num_el_blk",))
        block.setncattr("name", "ID")
        block[:] = 1
        file.createVariable("eb_status", "i4", ("num_el_blk",))[:] = 1
        cells = file.createVariable("connect1", "i4", ("num_el_in_blk1", "num_nod_per_el1"))
        cells.elem_type = kind
        cells[:] = np.arange(1, count + 1)


def read_by_vtk(name):
    reader = vtk.vtkExodusIIReader()
    reader.SetFileName(name)
    reader.Update()
    grid = reader.GetOutput()
    while grid.IsA("vtkMultiBlockDataSet"):
        grid = grid.GetBlock(0)
    cell = grid.GetCell(0)
    return np.array([grid.GetPoint(cell.GetPointId(k)) for k in range(cell.GetNumberOfPoints())])


def read_by_meshio(name):
    mesh = meshio.read(name)
    return mesh.points[mesh.cells[0].data[0]]


def volumes(points):
    region = felupe.RegionTriQuadraticHexahedron(felupe.Mesh(points, np.arange(27)[None], "hexahedron27"))
    return region.dV.sum(), region.dV.min(), region.dV.max()


seen = {}
for kind, cell, order, name in (
    ("HEX20", vtk.vtkQuadraticHexahedron(), HEX20, "hexahedron20"),
    ("HEX27", vtk.vtkTriQuadraticHexahedron(), HEX27, "hexahedron27"),
    ("TETRA10", vtk.vtkQuadraticTetra(), range(10), "tetra10"),
):
    right = nodes_of(cell)
    write_exodus("standard.e", kind, right[order])
    meshio.write("meshio.e", meshio.Mesh(right, [(name, np.arange(len(right))[None])]))
    read = [read_by_vtk("standard.e"), read_by_meshio("standard.e"), read_by_vtk("meshio.e"), read_by_meshio("meshio.e")]
    seen[kind] = [[k for k in range(len(right)) if not np.allclose(points[k], right[k])] for points in read]
    print(kind, "nodes elsewhere: VTK", seen[kind][0], "meshio", seen[kind][1], "of a file by meshio: VTK", seen[kind][2], "meshio", seen[kind][3])
    if kind == "HEX27":
        seen["volume"] = [volumes(points)[0] for points in read[:2]]
        print("volume of the HEX27 by VTK's reader and smallest, largest part:", *volumes(read[0]), "by meshio's:", *volumes(read[1]))
edges, rest = list(range(12, 20)), list(range(20, 27))
expected = {"HEX20": [[], edges, edges, []], "HEX27": [[], edges + rest, edges + rest, []], "TETRA10": [[]] * 4}
if not np.allclose(seen.pop("volume"), [8, -2.16889], rtol=1e-5) or seen != expected:
    sys.exit("meshio or VTK behaves otherwise now")
END
