#!/usr/bin/env bash
# Gmsh's option Mesh.SaveAll decides in each format otherwise what becomes of physical groups.
#
# Gmsh 4.15.2. A cube with the groups "body" (tag 17) and "bottom" (tag 42), saved with Mesh.SaveAll = 0 and 1:
# * .msh 4.1: elements keep their groups with either value.
# * .msh 2.2: with SaveAll the file still lists the names of groups, but every element has the physical tag 0, those of the
#   groups too: names without members.
# * .vtk: the cell array is called "CellEntityIds" but has the physical tags, not those of geometrical entities; with
#   SaveAll -1 stands for elements of no group (so -1 is no tag), and the groups are kept, other than in 2.2.
#
# Seen (tags of tetrahedra and triangles):  2.2: 17, 42; with SaveAll 0   .vtk: 17, 42; with SaveAll -1, 17, 42
#                                           4.1: groups of 24 and 4 elements with either value
set -euo pipefail
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
python3 -m venv "$place/python"
"$place/python/bin/pip" install --quiet --disable-pip-version-check gmsh==4.15.2
cd "$place"
python/bin/python - <<'END'
import sys

import gmsh

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
gmsh.model.occ.synchronize()
gmsh.model.addPhysicalGroup(3, [1], 17, "body")
gmsh.model.addPhysicalGroup(2, [5], 42, "bottom")
for bound in "Min", "Max":
    gmsh.option.setNumber(f"Mesh.MeshSize{bound}", 1)
gmsh.model.mesh.generate(3)
for every in 0, 1:
    gmsh.option.setNumber("Mesh.SaveAll", every)
    for version in 2.2, 4.1:
        gmsh.option.setNumber("Mesh.MshFileVersion", version)
        gmsh.write(f"{every}_{version}.msh")
    gmsh.write(f"{every}.vtk")


def tags_of_msh(name):
    text = open(name).read()
    assert '3 17 "body"' in text and '2 42 "bottom"' in text
    lines = text.split("$Elements\n")[1].split("$EndElements")[0].splitlines()[1:]
    rows = [list(map(int, line.split())) for line in lines]
    return {row[3] for row in rows if row[1] in (2, 4)}  # of triangles and tetrahedra


def tags_of_vtk(name):
    text = open(name).read()
    types = text.split("CELL_TYPES")[1].split("CELL_DATA")[0].split()[1:]
    tags = text.split("SCALARS CellEntityIds int 1\nLOOKUP_TABLE default\n")[1].split()
    return {int(tag) for kind, tag in zip(types, tags) if kind in ("5", "10")}


def groups_again(name):
    gmsh.clear()
    gmsh.open(name)
    return {gmsh.model.getPhysicalName(d, t): len(gmsh.model.getEntitiesForPhysicalGroup(d, t))
            for d, t in gmsh.model.getPhysicalGroups()}


seen = [tags_of_msh("0_2.2.msh"), tags_of_msh("1_2.2.msh"), tags_of_vtk("0.vtk"), tags_of_vtk("1.vtk"),
        groups_again("0_4.1.msh"), groups_again("1_4.1.msh")]
print(*seen, sep="\n")
groups = {"body": 1, "bottom": 1}
if seen != [{17, 42}, {0}, {17, 42}, {-1, 17, 42}, groups, groups]:
    sys.exit("Gmsh behaves otherwise now")
END
