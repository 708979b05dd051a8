#!/usr/bin/env bash
# VTK reads the nodes of a Lagrange hexahedron in two orders, by the version in the file's first line.
#
# VTK 9.7.2. Cell type 72 with 27 nodes has the order of the triquadratic hexahedron (type 29) in .vtu files of version 2.1
# and later and in legacy .vtk files of version 5.1. In older files nodes 18 and 19, the middles of two upright edges, stand
# the other way round, and VTK's readers exchange them without a message. So the list of nodes alone does not say which node is
# which: a reader, or a program that rewrites the header, has to carry the version along. Triangles (69), quadrangles (70)
# and tetrahedra (71) of second order are the same in all versions.
#
# Seen:  .vtu 1.0: 18 and 19 exchanged   .vtu 2.0: exchanged   .vtu 2.1: as listed   .vtu 2.3 (what VTK writes): as listed
#        .vtk 4.2: exchanged             .vtk 5.0: exchanged   .vtk 5.1: as listed
set -euo pipefail
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
python3 -m venv "$place/python"
"$place/python/bin/pip" install --quiet --disable-pip-version-check vtk==9.7.2
cd "$place"
python/bin/python - <<'END'
import re
import sys

import vtk

corners = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)]
middle = lambda *nodes: tuple(sum(corners[n][i] for n in nodes) / len(nodes) for i in range(3))
edges = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
faces = [(0, 3, 4, 7), (1, 2, 5, 6), (0, 1, 4, 5), (2, 3, 6, 7), (0, 1, 2, 3), (4, 5, 6, 7)]
points = vtk.vtkPoints()
for point in corners + [middle(*e) for e in edges] + [middle(*f) for f in faces] + [middle(*range(8))]:
    points.InsertNextPoint(point)
grid = vtk.vtkUnstructuredGrid()
grid.SetPoints(points)
ids = vtk.vtkIdList()
for node in range(27):
    ids.InsertNextId(node)
grid.InsertNextCell(vtk.VTK_LAGRANGE_HEXAHEDRON, ids)


def written(writer, name):
    writer.SetInputData(grid)
    writer.SetFileName(name)
    if hasattr(writer, "SetDataModeToAscii"):
        writer.SetDataModeToAscii()
    assert writer.Write() == 1
    return open(name).read()


def moved(reader, name, text):
    with open(name, "w") as file:
        file.write(text)
    reader.SetFileName(name)
    reader.Update()
    cell = reader.GetOutput().GetCell(0)
    return [k for k in range(27) if cell.GetPointId(k) != k]


seen = {}
text = written(vtk.vtkXMLUnstructuredGridWriter(), "cell.vtu")
own = re.search(r'type="UnstructuredGrid" version="([^"]*)"', text).group(1)
for version in "1.0", "2.0", "2.1", own:
    other = text.replace(f'version="{own}"', f'version="{version}"', 1)
    seen[f".vtu {version}"] = moved(vtk.vtkXMLUnstructuredGridReader(), "other.vtu", other)
text = written(vtk.vtkUnstructuredGridWriter(), "cell.vtk")
cells, types = text.index("CELLS"), text.index("CELL_TYPES")
listed = "CELLS 1 28\n27 " + " ".join(map(str, range(27))) + "\n"
for version, body in ("4.2", text[:cells] + listed + text[types:]), ("5.0", text), ("5.1", text):
    other = body.replace("Version 5.1", f"Version {version}", 1)
    seen[f".vtk {version}"] = moved(vtk.vtkUnstructuredGridReader(), "other.vtk", other)
for file, nodes in seen.items():
    print(file, "exchanged:" if nodes else "as listed", *nodes)
exchanged = {".vtu 1.0", ".vtu 2.0", ".vtk 4.2", ".vtk 5.0"}
if any(nodes != ([18, 19] if file in exchanged else []) for file, nodes in seen.items()):
    sys.exit("VTK behaves otherwise now")
END
