"""Makes the Gmsh files of this directory again (pip install gmsh; the committed ones came from 4.15.2).

One box or plate for every element type, in four formats each (2.2 and 4.1, text and binary), and a few oddities.
"""

import gmsh

FORMATS = {"22a": (2.2, 0), "22b": (2.2, 1), "41a": (4.1, 0), "41b": (4.1, 1)}
# kind: (dimension, order, recombined, incomplete)
KINDS = {
    "tri3": (2, 1, False, 0),
    "tri6": (2, 2, False, 0),
    "quad4": (2, 1, True, 0),
    "quad8": (2, 2, True, 1),
    "quad9": (2, 2, True, 0),
    "tet4": (3, 1, False, 0),
    "tet10": (3, 2, False, 0),
    "hex8": (3, 1, True, 0),
    "hex20": (3, 2, True, 1),
    "hex27": (3, 2, True, 0),
}


def plate(recombine):
    """The rectangle [0,2] x [0,1], slanted a little, two cells along x."""
    geo = gmsh.model.geo
    points = [geo.addPoint(*p) for p in [(0, 0, 0), (2, 0.1, 0), (2.2, 1.2, 0), (0, 1, 0)]]
    lines = [geo.addLine(points[i], points[(i + 1) % 4]) for i in range(4)]
    face = geo.addPlaneSurface([geo.addCurveLoop(lines)])
    for i, line in enumerate(lines):
        geo.mesh.setTransfiniteCurve(line, 3 if i % 2 == 0 else 2)
    geo.mesh.setTransfiniteSurface(face)
    if recombine:
        geo.mesh.setRecombine(2, face)
    return points, lines, face


def start(name):
    gmsh.clear()
    for option, value in [("Mesh.MshFileVersion", 4.1), ("Mesh.Binary", 0), ("Mesh.SecondOrderIncomplete", 0),
                          ("Mesh.SaveParametric", 0), ("Mesh.SaveAll", 0), ("Mesh.PartitionSplitMeshFiles", 0),
                          ("Mesh.RandomSeed", 1), ("General.NumThreads", 1), ("General.Terminal", 0)]:
        gmsh.option.setNumber(option, value)
    gmsh.model.add(name)


def build(dimension, order, recombine, incomplete, named=True):
    points, lines, face = plate(recombine)
    geo = gmsh.model.geo
    groups = []
    if dimension == 2:
        geo.synchronize()
        groups = [(2, [face], 1, "body"), (1, [lines[3]], 2, "clamp"), (1, [lines[0], lines[1], lines[2]], 3, "skin"),
                  (0, [points[2]], 4, "corner")]
    else:
        out = geo.extrude([(2, face)], 0, 0, 1.5, numElements=[1], recombine=recombine)
        geo.synchronize()
        volume = next(tag for d, tag in out if d == 3)
        sides = [tag for d, tag in out[2:] if d == 2]
        groups = [(3, [volume], 1, "body"), (2, [sides[3]], 2, "clamp"), (2, [face] + [s for s in sides[:3]], 3, "skin"),
                  (1, [lines[0]], 4, "edge"), (0, [points[2]], 5, "corner")]
    for dim, tags, tag, name in groups:
        gmsh.model.addPhysicalGroup(dim, tags, tag)
        if named:
            gmsh.model.setPhysicalName(dim, tag, name)
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", incomplete)
    gmsh.model.mesh.generate(dimension)
    gmsh.model.mesh.setOrder(order)


def save(path, version, binary):
    gmsh.option.setNumber("Mesh.MshFileVersion", version)
    gmsh.option.setNumber("Mesh.Binary", binary)
    gmsh.write(path)


gmsh.initialize()
for kind, how in KINDS.items():
    start(kind)
    build(*how)
    for suffix, (version, binary) in FORMATS.items():
        save(f"{kind}.{suffix}.msh", version, binary)

# Bare tags: groups without names.
start("bare")
build(*KINDS["hex8"], named=False)
for suffix, (version, binary) in FORMATS.items():
    save(f"bare.{suffix}.msh", version, binary)

# No groups at all.
start("plain")
plate(True)
gmsh.model.geo.synchronize()
gmsh.model.mesh.generate(2)
save("plain.22a.msh", 2.2, 0)
save("plain.41a.msh", 4.1, 0)

# Parametric nodes.
start("parametric")
build(*KINDS["tet10"])
gmsh.option.setNumber("Mesh.SaveParametric", 1)
for suffix, (version, binary) in FORMATS.items():
    save(f"parametric.{suffix}.msh", version, binary)

# Two regions, one group over both: format 2.2 writes such cells twice.
start("overlap")
geo = gmsh.model.geo
points = [geo.addPoint(*p) for p in [(0, 0, 0), (1, 0, 0), (2, 0, 0), (2, 1, 0), (1, 1, 0), (0, 1, 0)]]
lines = [geo.addLine(points[i], points[(i + 1) % 6]) for i in range(6)]
middle = geo.addLine(points[1], points[4])
left = geo.addPlaneSurface([geo.addCurveLoop([lines[0], middle, lines[4], lines[5]])])
right = geo.addPlaneSurface([geo.addCurveLoop([lines[1], lines[2], lines[3], -middle])])
for line in lines + [middle]:
    geo.mesh.setTransfiniteCurve(line, 2)
for face in (left, right):
    geo.mesh.setTransfiniteSurface(face)
    geo.mesh.setRecombine(2, face)
geo.synchronize()
for tags, tag, name in [([left], 1, "left"), ([right], 2, "right"), ([left, right], 3, "all of it")]:
    gmsh.model.addPhysicalGroup(2, tags, tag)
    gmsh.model.setPhysicalName(2, tag, name)
gmsh.model.addPhysicalGroup(1, [middle], 7)
gmsh.model.setPhysicalName(1, 7, "middle")
gmsh.model.mesh.generate(2)
for suffix, (version, binary) in FORMATS.items():
    save(f"overlap.{suffix}.msh", version, binary)

# Partitioned.
start("partitioned")
build(*KINDS["hex8"])
gmsh.model.mesh.partition(2)
for suffix, (version, binary) in FORMATS.items():
    save(f"partitioned.{suffix}.msh", version, binary)

# Triangles and quadrangles in one mesh.
start("mixed")
geo = gmsh.model.geo
points = [geo.addPoint(*p) for p in [(0, 0, 0), (1, 0, 0), (2, 0, 0), (2, 1, 0), (1, 1, 0), (0, 1, 0)]]
lines = [geo.addLine(points[i], points[(i + 1) % 6]) for i in range(6)]
middle = geo.addLine(points[1], points[4])
left = geo.addPlaneSurface([geo.addCurveLoop([lines[0], middle, lines[4], lines[5]])])
right = geo.addPlaneSurface([geo.addCurveLoop([lines[1], lines[2], lines[3], -middle])])
for line in lines + [middle]:
    geo.mesh.setTransfiniteCurve(line, 2)
for face in (left, right):
    geo.mesh.setTransfiniteSurface(face)
geo.mesh.setRecombine(2, right)
geo.synchronize()
gmsh.model.addPhysicalGroup(2, [left], 1)
gmsh.model.setPhysicalName(2, 1, "left")
gmsh.model.addPhysicalGroup(2, [right], 2)
gmsh.model.setPhysicalName(2, 2, "right")
gmsh.model.mesh.generate(2)
gmsh.model.mesh.setOrder(2)
for suffix, (version, binary) in FORMATS.items():
    save(f"mixed.{suffix}.msh", version, binary)

# Not taken: prisms, pyramids, third order; an old format.
start("prism")
points, lines, face = plate(False)
gmsh.model.geo.extrude([(2, face)], 0, 0, 1, numElements=[1], recombine=True)
gmsh.model.geo.synchronize()
gmsh.model.mesh.generate(3)
save("prism.41a.msh", 4.1, 0)
save("prism.22b.msh", 2.2, 1)
start("cubic")
build(3, 3, False, 0)
save("cubic.41b.msh", 4.1, 1)
start("old")
build(*KINDS["tri3"])
save("old.40a.msh", 4.0, 0)
save("old.1a.msh", 1.0, 0)
gmsh.finalize()
