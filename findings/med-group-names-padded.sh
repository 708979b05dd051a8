#!/usr/bin/env bash
# A physical group that goes from Gmsh through a MED file comes back with another tag and a name of 80 letters.
#
# Gmsh 4.15.2 (with its MED library). MED stores names of groups in fields of 80 letters, filled with blanks. Gmsh reads the
# field as a whole: the group "body" is called "body" and 76 blanks from then on, getPhysicalName says so, and .msh files
# that Gmsh writes of it have the blanks between the quotes. Comparing with "body" finds nothing, though every list that is printed
# looks right. Tags are counted anew as well (17 becomes 1 here). Trim names of meshes that may have been MED once.
#
# Seen:  before: 17 "body"   after: 1 "body                           ..." of 80 letters
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
gmsh.model.mesh.generate(3)
groups = lambda: [(tag, gmsh.model.getPhysicalName(3, tag)) for _, tag in gmsh.model.getPhysicalGroups(3)]
before = groups()
gmsh.write("cube.med")
gmsh.clear()
gmsh.open("cube.med")
after = groups()
gmsh.write("cube.msh")
print(before, after)
padded = "body".ljust(80)
if before != [(17, "body")] or after != [(1, padded)] or f'"{padded}"' not in open("cube.msh").read():
    sys.exit("Gmsh behaves otherwise now")
END
