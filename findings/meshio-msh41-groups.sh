#!/usr/bin/env bash
# A mesh with named physical groups written by meshio as Gmsh 4.1 has the names, but no element is in a group.
#
# meshio 5.3.5, Gmsh 4.15.2. In format 4.1 elements have no physical tag of their own: they belong to geometrical entities, and
# the section $Entities says in which groups those are. meshio writes $PhysicalNames from field_data, but $Entities only if the
# mesh has "cell_sets" of entities as meshio's own reader of 4.1 makes them. Built by hand, or read from another format, with
# cell_data "gmsh:physical" and field_data, a mesh loses its groups without a warning; meshio reads the file back without
# "gmsh:physical". Written as file_format="gmsh22" the same mesh keeps them.
#
# Gmsh itself refuses such a file, as its elements name an entity that is not listed.
#
# Seen:  4.1: $PhysicalNames there, $Entities not; Gmsh: "Unknown entity 1 of dimension 3"; meshio finds no "gmsh:physical"
#        2.2: Gmsh finds "body" with 4 nodes; meshio finds "gmsh:physical" 7
set -euo pipefail
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
python3 -m venv "$place/python"
"$place/python/bin/pip" install --quiet --disable-pip-version-check gmsh==4.15.2 meshio==5.3.5 numpy==2.2.6
cd "$place"
python/bin/python - <<'END'
import sys

import gmsh
import meshio
import numpy as np

points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
mesh = meshio.Mesh(points, [("tetra", np.array([[0, 1, 2, 3]]))],
                   cell_data={"gmsh:physical": [np.array([7])], "gmsh:geometrical": [np.array([1])]},
                   field_data={"body": np.array([7, 3])})
meshio.write("41.msh", mesh, file_format="gmsh", binary=False)
meshio.write("22.msh", mesh, file_format="gmsh22", binary=False)
gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
seen = {}
for name in "22.msh", "41.msh":
    text = open(name).read()
    gmsh.clear()
    try:
        gmsh.open(name)
    except Exception as error:
        seen[name] = str(error)
    groups = [(gmsh.model.getPhysicalName(d, t), len(gmsh.model.mesh.getNodesForPhysicalGroup(d, t)[0]))
              for d, t in gmsh.model.getPhysicalGroups()]
    again = meshio.read(name).cell_data.get("gmsh:physical")
    tags = None if again is None else np.concatenate(again).tolist()
    seen[name] = ('3 7 "body"' in text, "$Entities" in text, seen.get(name, groups), tags)
    print(name, "names, entities, groups of Gmsh with their nodes, tags of meshio:", *seen[name])
refused = "Unknown entity 1 of dimension 3"
if seen != {"41.msh": (True, False, refused, None), "22.msh": (True, False, [("body", 4)], [7])}:
    sys.exit("meshio or Gmsh behaves otherwise now")
END
