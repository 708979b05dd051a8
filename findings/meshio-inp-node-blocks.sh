#!/usr/bin/env bash
# In an .inp file of several bodies meshio puts all of them where the last one is.
#
# meshio 5.3.5. Each *NODE block takes the place of the one before, but elements that were read keep their rows of the old block. With as many
# nodes behind as before, all indices are valid and nothing is said:
# * parts, as Abaqus/CAE writes them: every *PART counts its nodes from 1, *INSTANCE says where it stands. A soft block of 1 x 1 x 1 under a plate of
#   4 x 4 x 0.5 is read as two cells on the same 8 nodes, both the plate, at the plate's own origin: translations are passed over.
#   The block's set "clamp" has nodes of the plate.
# * a flat file with nodes and elements of one body, then of the other, numbered through: the same two plates. CalculiX 2.20 (Debian's
#   calculix-ccx; run where it is installed) finds the volumes 1 and 8 of the same file.
# If both *NODE blocks come before the elements, a KeyError ends it. A file with one *NODE block is read as it is.
#
# Seen (volumes of the two cells):  parts: 8, 8   flat: 8, 8, by CalculiX 1, 8   clamp in parts: x from 0 to 4, not 0 to 1
set -euo pipefail
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
python3 -m venv "$place/python"
"$place/python/bin/pip" install --quiet --disable-pip-version-check meshio==5.3.5 numpy==2.2.6
cd "$place"
python/bin/python - <<'END'
import shutil
import subprocess
import sys

import meshio
import numpy as np


def nodes(first, size, z):
    x, y, height = size
    corners = [(0, 0), (x, 0), (x, y), (0, y)]
    places = [(*corner, z + up) for up in (0, height) for corner in corners]
    return "*NODE\n" + "".join(f"{n}, {p[0]:.2f}, {p[1]:.2f}, {p[2]:.2f}\n" for n, p in enumerate(places, first))


def cell(number, first):
    return f"*ELEMENT, TYPE=C3D8, ELSET=E{number}\n{number}, " + ", ".join(map(str, range(first, first + 8))) + "\n"


block, plate = (1, 1, 1), (4, 4, 0.5)
parts = (
    "*HEADING\ntwo parts\n"
    f"*PART, NAME=Block\n{nodes(1, block, 0)}{cell(1, 1)}*NSET, NSET=clamp\n1, 2, 3, 4\n*END PART\n"
    f"*PART, NAME=Plate\n{nodes(1, plate, 0)}{cell(1, 1)}*END PART\n"
    "*ASSEMBLY, NAME=Both\n*INSTANCE, NAME=Block-1, PART=Block\n*END INSTANCE\n"
    "*INSTANCE, NAME=Plate-1, PART=Plate\n0., 0., 1.\n*END INSTANCE\n*END ASSEMBLY\n"
)
flat = nodes(1, block, 0) + cell(1, 1) + nodes(9, plate, 1) + cell(2, 9)


def read(name, text):
    with open(name, "w") as file:
        file.write(text)
    mesh = meshio.read(name)
    corners = [mesh.points[block.data[0]] for block in mesh.cells]
    volumes = [float(np.prod(np.ptp(points, axis=0))) for points in corners]
    print(name, len(mesh.points), "points, volumes", *volumes, "heights", *(points[:, 2].tolist() for points in corners))
    return mesh, volumes, np.array_equal(*corners)


mesh, volumes, same = read("parts.inp", parts)
clamp = np.ptp(mesh.points[mesh.point_sets["clamp"]], axis=0).tolist()
print("extent of clamp:", clamp, "lowest z of all:", mesh.points[:, 2].min())
seen = [len(mesh.points), volumes, same, clamp, float(mesh.points[:, 2].min())]
mesh, volumes, same = read("flat.inp", flat)
seen += [len(mesh.points), volumes, same]
try:
    read("first.inp", nodes(1, block, 0) + nodes(9, plate, 1) + cell(1, 1) + cell(2, 9))
except KeyError as error:
    seen.append("KeyError")
    print("nodes first:", repr(error))
if seen != [8, [8, 8], True, [4, 4, 0], 0, 8, [8, 8], True, "KeyError"]:
    sys.exit("meshio behaves otherwise now")

if shutil.which("ccx") and "2.20" in subprocess.run(["ccx", "-v"], capture_output=True, text=True).stdout:
    with open("run.inp", "w") as file:
        file.write(flat + "*ELSET, ELSET=ALL\nE1, E2\n*MATERIAL, NAME=M\n*ELASTIC\n1000., 0.\n*SOLID SECTION, ELSET=ALL, MATERIAL=M\n"
                   "*STEP\n*STATIC\n*BOUNDARY\n" + "".join(f"{n}, 1, 3\n" for n in range(1, 17))
                   + "*EL PRINT, ELSET=ALL\nEVOL\n*END STEP\n")
    subprocess.run(["ccx", "run"], capture_output=True, check=True)
    with open("run.dat") as file:
        rows = [line.split() for line in file]
    volumes = [float(row[1]) for row in rows if len(row) == 2]
    print("volumes by CalculiX:", *volumes)
    assert volumes == [1, 8]
END
