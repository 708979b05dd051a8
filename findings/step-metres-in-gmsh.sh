#!/usr/bin/env bash
# Gmsh imports a STEP file in metres a thousand times too large, unless it is told a unit.
#
# Gmsh 4.15.2 (OpenCASCADE inside). A STEP file says its unit of length. OpenCASCADE takes every length to millimetres, and
# Gmsh keeps the numbers: a cube of 2 m has edges of 2000, one of 2 mm edges of 2. Meshes (.msh, .vtk ..) bear no unit, so
# nothing shows it further on. Geometry.OCCTargetUnit = "M", set before the import, gives metres: 2 and 0.002.
#
# Seen (edge of the cube):  2 m: 2000, with OCCTargetUnit "M" 2   2 mm: 2, with OCCTargetUnit "M" 0.002
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
gmsh.model.occ.addBox(0, 0, 0, 2, 2, 2)
gmsh.model.occ.synchronize()
gmsh.write("millimetres.step")
text = open("millimetres.step").read()
assert text.count("SI_UNIT(.MILLI.,.METRE.)") == 1
with open("metres.step", "w") as file:
    file.write(text.replace("SI_UNIT(.MILLI.,.METRE.)", "SI_UNIT($,.METRE.)"))
seen = []
for unit in None, "M":
    if unit:
        gmsh.option.setString("Geometry.OCCTargetUnit", unit)
    for name in "metres.step", "millimetres.step":
        gmsh.clear()
        gmsh.model.occ.importShapes(name)
        gmsh.model.occ.synchronize()
        low, high = gmsh.model.getBoundingBox(-1, -1)[0::3]
        seen.append(round(high - low, 5))
        print(name, "with", unit or "no unit given:", seen[-1])
if seen != [2000, 2, 2, 0.002]:
    sys.exit("Gmsh behaves otherwise now")
END
