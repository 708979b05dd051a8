"""Reads 3MF files with Python's own readers of archives and of XML: every object closed, oriented outward, its name, material and volume.

python3 three_mf.py FILE     a line for each object: NAME | MATERIAL | VOLUME, in mm^3
"""

import collections
import sys
import xml.etree.ElementTree as tree
import zipfile

CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"

with zipfile.ZipFile(sys.argv[1]) as archive:
    broken = archive.testzip()
    if broken:
        sys.exit(f"{broken} is broken")
    relations = tree.fromstring(archive.read("_rels/.rels"))
    target = relations[0].get("Target").lstrip("/")
    model = tree.fromstring(archive.read(target))
    tree.fromstring(archive.read("[Content_Types].xml"))
if model.tag != f"{CORE}model" or model.get("unit") != "millimeter":
    sys.exit(f"a {model.tag} in {model.get('unit')}")
materials = [base.get("name") for base in model.iter(f"{CORE}base")]
objects = {own.get("id"): own for own in model.iter(f"{CORE}object")}
placed = [item.get("objectid") for item in model.iter(f"{CORE}item")]
named = [part.get("objectid") for key in placed for part in objects[key].iter(f"{CORE}component")]
for key in named:
    own = objects[key]
    points = [tuple(float(point.get(x)) for x in "xyz") for point in own.iter(f"{CORE}vertex")]
    triangles = [tuple(int(one.get(v)) for v in ("v1", "v2", "v3")) for one in own.iter(f"{CORE}triangle")]
    passes = collections.Counter()
    volume = 0.0
    for corners in triangles:
        for a, b in zip(corners, corners[1:] + corners[:1]):
            passes[min(a, b), max(a, b)] += 1 if a < b else -1
        a, b, c = (points[k] for k in corners)
        cross = (b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0])
        volume += sum(x * y for x, y in zip(a, cross)) / 6
    if any(passes.values()):
        sys.exit(f"{own.get('name')} has open edges")
    print(f"{own.get('name')} | {materials[int(own.get('pindex'))]} | {volume!r}")
