#!/usr/bin/env bash
# Named faces of a solid are elements of plane stress in Gmsh's .inp, which CalculiX does not take for faces.
#
# Gmsh 4.15.2. A cube of second-order tetrahedra with the groups "body", "bottom" and "top": beside C3D10 the file has CPS6, plane-stress
# triangles, for the two faces, and names them in *ELSET; there is no *SURFACE and no *NSET. Order 1 gives CPS3.
# CalculiX 2.20 (Debian's calculix-ccx; run where it is installed) reads them as elements of the structure and ends with
# "The structure contains plane stress .. elements and should lie in the z=0 plane". Without the lines of both faces it finds the force
# 10 = 1000 * 0.01 of a stretched cube.
# Who hands such a file on takes the faces out, or turns them into *SURFACE first.
#
# Seen: ['CPS6', 'CPS6', 'C3D10'] ['body', 'bottom', 'top']
set -euo pipefail
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
python3 -m venv "$place/python"
"$place/python/bin/pip" install --quiet --disable-pip-version-check gmsh==4.15.2
cd "$place"
python/bin/python - <<'END'
import re
import shutil
import subprocess

import gmsh

gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
gmsh.model.occ.synchronize()
for dim, entity, name in (3, 1, "body"), (2, 5, "bottom"), (2, 6, "top"):
    gmsh.model.addPhysicalGroup(dim, [entity], name=name)
for bound in "Min", "Max":
    gmsh.option.setNumber(f"Mesh.MeshSize{bound}", 1)
gmsh.option.setNumber("Mesh.ElementOrder", 2)
gmsh.model.mesh.generate(3)
gmsh.write("cube.inp")
text = open("cube.inp").read()
kinds = re.findall(r"^\*ELEMENT, type=(\w+)", text, re.M)
sets = sorted(re.findall(r"^\*ELSET,ELSET=(\w+)", text, re.M))
print(kinds, sets)
assert kinds == ["CPS6", "CPS6", "C3D10"] and sets == ["body", "bottom", "top"]
assert "*SURFACE" not in text.upper() and "*NSET" not in text.upper()

if shutil.which("ccx") and "2.20" in subprocess.run(["ccx", "-v"], capture_output=True, text=True).stdout:
    rows = [line.split(",") for line in text.splitlines() if re.match(r"\d+, [-\d.e]+, [-\d.e]+, [-\d.e]+$", line)]
    at = lambda z: [int(row[0]) for row in rows if float(row[3]) == z]
    held = "".join(f"{n},1,3,0.\n" for n in at(0)) + "".join(f"{n},3,3,0.01\n" for n in at(1))

    def run(name, mesh, sections):
        open(f"{name}_mesh.inp", "w").write(mesh)
        parts = "".join(f"*SOLID SECTION, ELSET={own}, MATERIAL=M\n{thick}" for own, thick in sections)
        nodes = ",\n".join(map(str, at(0)))
        open(f"{name}.inp", "w").write(
            f"*INCLUDE, INPUT={name}_mesh.inp\n*NSET, NSET=LOW\n{nodes}\n*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.\n{parts}"
            f"*STEP\n*STATIC\n*BOUNDARY\n{held}*NODE PRINT, NSET=LOW, TOTALS=ONLY\nRF\n*END STEP\n")
        said = subprocess.run(["ccx", name], capture_output=True, text=True).stdout
        try:
            force = float(open(f"{name}.dat").read().split()[-1])
        except (IndexError, FileNotFoundError):
            force = None
        return said, force

    faces = re.sub(r"(?ms)^\*ELEMENT, type=CPS6.*?(?=^\*ELEMENT, type=C3D10)", "", text)
    faces = re.sub(r"(?ms)^\*ELSET,ELSET=(bottom|top)\n.*?(?=^\*)", "", faces)
    assert "should lie in" in run("all", text, [("body", "")])[0]
    force = run("solid", faces, [("body", "")])[1]
    print("CalculiX without the faces:", force)
    assert abs(abs(force) - 10) < 1e-5
END
echo "as found"
