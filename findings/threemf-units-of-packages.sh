#!/usr/bin/env bash
# The unit of a 3MF file is read by trimesh and lost by it on writing: what comes in in inches goes out in millimetres, 25.4 times smaller.
#
# trimesh 5.2.0, lxml 6.1.3: load() sets `units` of the scene from <model unit=".."> and leaves the coordinates; export to 3MF writes unit="millimeter"
# whatever `units` says, and the coordinates as they are. A mesh with units = "meters" comes out 1000 times smaller. `geometry` of the scene also holds objects that
# <build> does not list, so that a sum over it counts parts that are not to be made; to_mesh() leaves them out.
# lib3mf 2.5.0: GetUnit() tells the unit; its STL writer writes the coordinates as they are, in inches where the model is in inches, which programs that print read
# as millimetres.
# So a 3MF file that goes through either of these is safe in millimetres alone.
#
# Seen:  in: inch, width 2.0; out of trimesh: millimeter, width 2.0; STL of lib3mf: width 2.0; volumes: build 8.0, geometry 16.0
set -euo pipefail
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
python3 -m venv "$place/python"
"$place/python/bin/pip" install --quiet --disable-pip-version-check \
    trimesh==5.2.0 lxml==6.1.3 networkx==3.6.1 numpy==2.4.6 lib3mf==2.5.0
cd "$place"
"$place/python/bin/python" -W ignore - <<'END'
import re
import sys
import zipfile

import lib3mf
import trimesh

CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
PACKAGE = "http://schemas.openxmlformats.org/package/2006"
box = trimesh.creation.box((2.0, 2.0, 2.0))
vertices = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in box.vertices)
triangles = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in box.faces)
mesh = f"<mesh><vertices>{vertices}</vertices><triangles>{triangles}</triangles></mesh>"
objects = "".join(f'<object id="{k}" type="model" name="{name}">{mesh}</object>' for k, name in ((1, "soft"), (2, "spare")))
model = f'<model unit="inch" xmlns="{CORE}"><resources>{objects}</resources><build><item objectid="1"/></build></model>'
kinds = "".join(f'<Default Extension="{end}" ContentType="application/vnd.{kind}+xml"/>' for end, kind in (("rels", "openxmlformats-package.relationships"), ("model", "ms-package.3dmanufacturing-3dmodel")))
relation = 'Id="r0" Target="/3D/3dmodel.model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"'
with zipfile.ZipFile("inch.3mf", "w") as package:
    package.writestr("[Content_Types].xml", f'<Types xmlns="{PACKAGE}/content-types">{kinds}</Types>')
    package.writestr("_rels/.rels", f'<Relationships xmlns="{PACKAGE}/relationships"><Relationship {relation}/></Relationships>')
    package.writestr("3D/3dmodel.model", model)


def unit_of(path):
    with zipfile.ZipFile(path) as package:
        return re.search(r'<model[^>]*\bunit="(\w+)"', package.read("3D/3dmodel.model").decode())[1]


def width(of):
    low, high = of.bounds
    return float(high[0] - low[0])


scene = trimesh.load("inch.3mf")
scene.export("again.3mf")
again = trimesh.load("again.3mf")
metres = trimesh.creation.box((2.0, 2.0, 2.0))
metres.units = "meters"
metres.export("metres.3mf")
native = lib3mf.get_wrapper().CreateModel()
native.QueryReader("3mf").ReadFromFile("inch.3mf")
native.QueryWriter("stl").WriteToFile("inch.stl")
seen = {
    "unit that trimesh reads": (scene.units, "inch"),
    "unit in the file that it writes": (unit_of("again.3mf"), "millimeter"),
    "of a mesh in metres": (unit_of("metres.3mf"), "millimeter"),
    "widths in, out": ([width(scene), width(again)], [2.0, 2.0]),
    "volume of what is built": (round(float(scene.to_mesh().volume), 9), 8.0),
    "volume of all geometry": (round(sum(float(part.volume) for part in scene.geometry.values()), 9), 16.0),
    "unit that lib3mf reads": (native.GetUnit(), lib3mf.ModelUnit.Inch),
    "width of lib3mf's STL": (width(trimesh.load("inch.stl")), 2.0),
}
for what, (found, expected) in seen.items():
    print(f"{what}: {found}")
changed = [what for what, (found, expected) in seen.items() if found != expected]
if changed:
    sys.exit("changed: " + "; ".join(changed))
END
