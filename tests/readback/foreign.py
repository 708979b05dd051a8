"""Writes meshes as other programs write them, for nastic to read, and says what is in each.

    python foreign.py DIRECTORY

A cube of side 2 with the groups `body` (17), `bottom` (42), `top` (43), a block of two regions, cells of second order. Each line
printed: file, volume, number of cells, then groups as KIND:NAME=MEASURE (a volume, an area, a number of nodes), words of a note
behind `!`, names of lost regions behind `?`, `+` where there are further groups.
"""

import re
import sys
import warnings
from pathlib import Path

import gmsh
import meshio
import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk

warnings.filterwarnings("ignore")
directory = Path(sys.argv[1])


def say(name, *words):
    print("|".join([name, *map(str, words)]))


def write(writer, grid, name, **settings):
    writer.SetInputData(grid)
    writer.SetFileName(str(directory / name))
    for setting, value in settings.items():
        getattr(writer, setting)(*value)
    if writer.Write() != 1:
        sys.exit(f"vtk cannot write {name}")


def array(name, values, kind=None):
    out = numpy_to_vtk(np.asarray(values), deep=True, array_type=kind)
    out.SetName(name)
    return out


# --- Gmsh, and what meshio makes of it ---
gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.model.occ.addBox(0, 0, 0, 2, 2, 2)
gmsh.model.occ.synchronize()
for dimension, entity, tag, name in [(3, 1, 17, "body"), (2, 5, 42, "bottom"), (2, 6, 43, "top"), (0, 1, 5, "corner")]:
    gmsh.model.addPhysicalGroup(dimension, [entity], tag, name)
for bound in "Min", "Max":
    gmsh.option.setNumber(f"Mesh.MeshSize{bound}", 1)
gmsh.model.mesh.generate(3)
cells = len(gmsh.model.mesh.getElements(3)[1][0])
tagged = ["region:17=8", "surface:42=4", "surface:43=4", "nodes:5=1"]
named = ["region:body=8", "surface:bottom=4", "surface:top=4", "nodes:corner=1"]
for every in 0, 1:
    gmsh.option.setNumber("Mesh.SaveAll", every)
    for binary in 0, 1:
        gmsh.option.setNumber("Mesh.Binary", binary)
        name = f"gmsh_{every}{binary}.vtk"
        gmsh.write(str(directory / name))
        say(name, 8, cells, *tagged)
gmsh.option.setNumber("Mesh.SaveAll", 0)
gmsh.option.setNumber("Mesh.Binary", 0)
gmsh.option.setNumber("Mesh.MshFileVersion", 2.2)
gmsh.write(str(directory / "plain.msh"))
say("plain.msh", 8, cells, *named)

mesh = meshio.read(directory / "plain.msh")
for binary in False, True:
    meshio.vtk.write(directory / f"meshio_51_{binary}.vtk", mesh, binary=binary)
    say(f"meshio_51_{binary}.vtk", 8, cells, *tagged)
    meshio.write(directory / f"meshio_42_{binary}.vtk", mesh, file_format="vtk42", binary=binary)
    say(f"meshio_42_{binary}.vtk", 8, cells, *tagged)
meshio.vtu.write(directory / "meshio_lzma.vtu", mesh, compression="lzma")
say("meshio_lzma.vtu", 8, cells, *tagged)

# --- groups that get lost or padded on the way ---
tetra = [k for k, block in enumerate(mesh.cells) if block.type == "tetra"]
physical = [mesh.cell_data["gmsh:physical"][k] for k in tetra]
solid = meshio.Mesh(mesh.points, [mesh.cells[k] for k in tetra], cell_data={"gmsh:physical": physical}, field_data=mesh.field_data)
meshio.write(directory / "meshio_41.msh", solid, file_format="gmsh", binary=False)
say("meshio_41.msh", 8, cells, "region:ungrouped=8", "!no cell bears a group: all are the region \"ungrouped\"", "?body")
meshio.write(directory / "meshio_22.msh", solid, file_format="gmsh22", binary=False)
say("meshio_22.msh", 8, cells, "region:body=8", "!group \"top\" (dimension 2) has no elements")
gmsh.option.setNumber("Mesh.SaveAll", 1)
gmsh.write(str(directory / "every_22.msh"))
say("every_22.msh", 8, cells, "region:ungrouped=8", "?body")
gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
gmsh.write(str(directory / "every_41.msh"))
say("every_41.msh", 8, cells, *named)
gmsh.option.setNumber("Mesh.SaveAll", 0)
gmsh.write(str(directory / "plain.med"))
gmsh.clear()
gmsh.open(str(directory / "plain.med"))
gmsh.write(str(directory / "med.msh"))
say("med.msh", 8, cells, *named, "!blanks around names of groups dropped: \"corner\", \"bottom\", \"top\", \"body\"")

# --- what messages advise for formats that are not read ---
gmsh.write(str(directory / "plain.mesh"))
gmsh.write(str(directory / "plain.bdf"))
bulk = directory / "plain.bdf"
# Gmsh leaves out the lines about the data
bulk.write_text("SOL 101\nCEND\nBEGIN BULK\n" + bulk.read_text() + ("" if "ENDDATA" in bulk.read_text() else "ENDDATA\n"))
for end in "mesh", "bdf":
    meshio.write(directory / f"plain_{end}.vtu", meshio.read(directory / f"plain.{end}"))
    say(f"plain_{end}.vtu", 8, cells, "region:4=8", "surface:2=4", "surface:3=4")
gmsh.clear()
gmsh.model.occ.addBox(0, 0, 0, 2, 2, 2)
gmsh.model.occ.synchronize()
gmsh.write(str(directory / "box.step"))
step = (directory / "box.step").read_text()
assert "SI_UNIT(.MILLI.,.METRE.)" in step
(directory / "box.step").write_text(step.replace("SI_UNIT(.MILLI.,.METRE.)", "SI_UNIT($,.METRE.)"))
gmsh.clear()
gmsh.model.occ.importShapes(str(directory / "box.step"))
gmsh.model.occ.synchronize()
for bound in "Min", "Max":
    gmsh.option.setNumber(f"Mesh.MeshSize{bound}", 1000)
gmsh.model.mesh.generate(3)
gmsh.write(str(directory / "box_step.msh"))
say("box_step.msh", 8e9, len(gmsh.model.mesh.getElements(3)[1][0]))
for bound in "Min", "Max":
    gmsh.option.setNumber(f"Mesh.MeshSize{bound}", 1)

# --- Abaqus, by Gmsh: the same mesh as its own format has ---
def abaqus(name, order, incomplete, dimension, *groups):
    gmsh.clear()
    if dimension == 3:
        gmsh.model.occ.addBox(0, 0, 0, 2, 2, 2)
    else:
        gmsh.model.occ.addRectangle(0, 0, 0, 2, 2)
    gmsh.model.occ.synchronize()
    gmsh.model.addPhysicalGroup(dimension, [1], 17, "body")
    gmsh.model.addPhysicalGroup(dimension - 1, [4], 42, "side")
    if name.startswith("hex"):
        gmsh.model.mesh.setTransfiniteAutomatic()
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", incomplete)
    gmsh.model.mesh.generate(dimension)
    gmsh.model.mesh.setOrder(order)
    gmsh.option.setNumber("Mesh.SaveGroupsOfNodes", 1)
    for end in "inp", "msh":
        gmsh.write(str(directory / f"{name}.{end}"))
    count = sum(len(tags) for tags in gmsh.model.mesh.getElements(dimension)[1])
    say(f"{name}.inp", f"{name}.msh", count, *groups)


for name, order, incomplete in ("tet4", 1, 0), ("tet10", 2, 0), ("hex8", 1, 0), ("hex20", 2, 1), ("hex27", 2, 0):
    abaqus(name, order, incomplete, 3, "region:body=8", "surface:side=4", "+")
for name, order, incomplete in ("tri3", 1, 0), ("tri6", 2, 0):
    abaqus(name, order, incomplete, 2, "region:body=4", "surface:side=2", "+", "!are taken in plane strain")
gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 0)

# --- VTK: a block of 3 x 2 x 2 hexahedra, of regions 1 and 2, and arrays of every kind ---
points = vtk.vtkPoints()
points.SetDataTypeToDouble()
for k in range(3):
    for j in range(3):
        for i in range(4):
            points.InsertNextPoint(i, j, k)


def block(kind=12):
    grid = vtk.vtkUnstructuredGrid()
    grid.SetPoints(points)
    node = lambda i, j, k: i + 4 * j + 12 * k
    for k in range(2):
        for j in range(2):
            for i in range(3):
                square = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
                if kind == 11:
                    square[2:] = square[3:1:-1]
                ids = vtk.vtkIdList()
                for z in k, k + 1:
                    for x, y in square:
                        ids.InsertNextId(node(x, y, z))
                grid.InsertNextCell(kind, ids)
    return grid


full = block()
regions = [1 if cell % 3 == 0 else 2 for cell in range(12)]
words = vtk.vtkStringArray()
words.SetName("who made it")
words.InsertNextValue("somebody, with blanks")
words.InsertNextValue("x" * 100)
full.GetFieldData().AddArray(words)
full.GetFieldData().AddArray(array("TimeValue", [0.5]))
bits = vtk.vtkBitArray()
bits.SetName("bits")
for cell in range(12):
    bits.InsertNextValue(cell % 2)
stress = array("stress", np.arange(108.0).reshape(12, 9))
for component in range(9):
    stress.SetComponentName(component, f"s{component}")
full.GetCellData().AddArray(stress)
full.GetCellData().SetTensors(stress)
full.GetCellData().AddArray(bits)
full.GetCellData().AddArray(array("region", regions))
ids = array("ids", np.arange(12), vtk.VTK_ID_TYPE)
full.GetCellData().SetGlobalIds(ids)
colour = array("colour", np.zeros((36, 3), np.uint8))
full.GetPointData().SetScalars(colour)
full.GetPointData().AddArray(array("shift", np.zeros((36, 3), np.float32)))
full.GetPointData().SetNormals(array("normals", np.ones((36, 3))))
for version, number in ("51", 51), ("42", 42):
    for mode in "ASCII", "Binary":
        name = f"vtk_{version}_{mode}.vtk"
        write(vtk.vtkUnstructuredGridWriter(), full, name, SetFileVersion=[number], **{f"SetFileTypeTo{mode}": []})
        say(name, 12, 12, "region:1=4", "region:2=8")
for compressor in "LZ4", "LZMA":
    for mode in "Binary", "Appended":
        name = f"vtk_{compressor}_{mode}.vtu"
        writer = vtk.vtkXMLUnstructuredGridWriter()
        settings = {f"SetCompressorTypeTo{compressor}": [], f"SetDataModeTo{mode}": [], "SetBlockSize": [1024]}
        write(writer, full, name, **settings)
        say(name, 12, 12, "region:1=4", "region:2=8")

holes = block()
holes.GetCellData().AddArray(array("region", [cell % 2 for cell in range(12)]))
write(vtk.vtkXMLUnstructuredGridWriter(), holes, "zero.vtu")
say("zero.vtu", 12, 12, "region:1=6", "!6 of 12 cells belong to no group, hence to no region")
ghosts = block(11)
ghosts.GetCellData().AddArray(array("vtkGhostType", np.array([1, 32] + [0] * 10, np.uint8)))
for name, writer in ("ghosts.vtu", vtk.vtkXMLUnstructuredGridWriter()), ("ghosts.vtk", vtk.vtkUnstructuredGridWriter()):
    write(writer, ghosts, name)
    say(name, 10, 10, "region:body=10", "!2 ghost cells")

# --- Lagrange cells of second order, by Gmsh's: bent so that exchanged nodes change the volume ---
for number, kind, order, gmsh_kind, bend in [(70, 28, 9, 10, 0.1), (72, 29, 27, 12, 0.1), (71, 24, 10, 11, 0.1), (69, 22, 6, 9, 0.1)]:
    gmsh.clear()
    dimension = 2 if number in (69, 70) else 3
    if dimension == 2:
        gmsh.model.occ.addRectangle(0, 0, 0, 1, 1)
    else:
        gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
    gmsh.model.occ.synchronize()
    if number in (70, 72):
        gmsh.option.setNumber("Mesh.TransfiniteTri", 0)
        gmsh.model.mesh.setTransfiniteAutomatic()
    gmsh.model.mesh.generate(dimension)
    gmsh.model.mesh.setOrder(2)
    # meshio takes Gmsh's nodes to VTK's order
    gmsh.option.setNumber("Mesh.SaveAll", 1)
    gmsh.write(str(directory / "second.msh"))
    source = meshio.read(directory / "second.msh")
    name = {22: "triangle6", 24: "tetra10", 28: "quad9", 29: "hexahedron27"}[kind]
    own = source.cells_dict[name]
    x = source.points
    x[:, :2] += bend * np.sin(3 * x[:, [1, 0]])
    if dimension == 3:
        x[:, 0] += bend * np.cos(3 * x[:, 2]) * x[:, 1]
    grids = []
    for vtk_number in kind, number:
        grid = vtk.vtkUnstructuredGrid()
        at = vtk.vtkPoints()
        at.SetDataTypeToDouble()
        for p in x:
            at.InsertNextPoint(p)
        grid.SetPoints(at)
        for cell in own:
            ids = vtk.vtkIdList()
            for node in cell:
                ids.InsertNextId(int(node))
            grid.InsertNextCell(vtk_number, ids)
        grids.append(grid)
    sound, lagrange = grids
    write(vtk.vtkXMLUnstructuredGridWriter(), sound, f"sound_{number}.vtu")
    write(vtk.vtkXMLUnstructuredGridWriter(), lagrange, f"same_{number}.vtu", SetDataModeToAscii=[])
    write(vtk.vtkUnstructuredGridWriter(), lagrange, f"same_{number}_51.vtk", SetFileTypeToBinary=[])
    say(f"same_{number}.vtu", f"sound_{number}.vtu", len(own))
    say(f"same_{number}_51.vtk", f"sound_{number}.vtu", len(own))
    if number == 72:
        # as programs wrote it before version 2.1: VTK itself tells where each node is
        former = own.copy()
        former[:, [18, 19]] = former[:, [19, 18]]
        grid = vtk.vtkUnstructuredGrid()
        grid.SetPoints(lagrange.GetPoints())
        for cell in former:
            ids = vtk.vtkIdList()
            for node in cell:
                ids.InsertNextId(int(node))
            grid.InsertNextCell(72, ids)
        write(vtk.vtkXMLUnstructuredGridWriter(), grid, "former.vtu", SetDataModeToAscii=[])
        text = (directory / "former.vtu").read_text()
        text, replaced = re.subn(r'(type="UnstructuredGrid" version=)"[^"]*"', r'\1"1.0"', text, count=1)
        assert replaced == 1
        (directory / "former.vtu").write_text(text)
        reader = vtk.vtkXMLUnstructuredGridReader()
        reader.SetFileName(str(directory / "former.vtu"))
        reader.Update()
        read = reader.GetOutput().GetCell(0)
        assert [read.GetPointId(k) for k in range(27)] == own[0].tolist(), "VTK reads old files otherwise"
        say("former.vtu", f"sound_{number}.vtu", len(own))
gmsh.finalize()
