#!/usr/bin/env bash
# The closed air chamber in an STL is kept by some programs and filled with material by others, without a message.
#
# An STL of a block of 4 x 2 x 2 with a closed chamber of 2 x 1 x 1 inside is two closed shells in one solid, the inner one with normals that
# point into the chamber: 14 of material. What becomes of it:
# * numpy-stl 4.1.1 (its volume) and pytetwild 0.4.2 (a mesh of tetrahedra) have 14.
# * pymeshfix 0.18.1, MeshFix(..).repair(): 16. Of all shells it keeps the one with the most facets: here the outer one, as the first
#   of equals; a finely triangulated chamber is kept and the body thrown away (2 instead of 14). With
#   remove_smallest_components=False it keeps both.
# * tetgen 0.8.4 (pyvista's): 16, tetrahedra in the chamber, unless add_hole() names a point in it.
# * Gmsh 4.15.2: 16. Merge gives one surface for both shells, and the volume inside its loop has no hole. After CreateTopology each shell is a
#   surface of its own, and the same loop of all surfaces gives 14.
# Measure the volume of the mesh before the first pressure is set.
#
# Seen:  numpy-stl 14  pytetwild 14  pymeshfix 16 (all components: 14; fine chamber: 2)  tetgen 16 (hole: 14)  Gmsh 16 (CreateTopology: 14)
set -euo pipefail
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
python3 -m venv "$place/python"
"$place/python/bin/pip" install --quiet --disable-pip-version-check \
    gmsh==4.15.2 numpy==2.2.6 numpy-stl==4.1.1 pymeshfix==0.18.1 pytetwild==0.4.2 pyvista==0.49.1 tetgen==0.8.4
cd "$place"
python/bin/python -W ignore - <<'END'
import itertools
import sys

import gmsh
import numpy as np
import pymeshfix
import pytetwild
import pyvista
import stl
import tetgen


def box(size, cells, outward):
    """Triangles of a box around the origin, each side of cells x cells squares."""
    steps = np.linspace(-0.5, 0.5, cells + 1)
    for axis, side in itertools.product(range(3), (-0.5, 0.5)):
        for (a, b), (c, d) in itertools.product(itertools.pairwise(steps), repeat=2):
            square = [np.roll([side, *at], axis) * size for at in ((a, c), (b, c), (b, d), (a, d))]
            if (side > 0) != outward:
                square.reverse()
            yield [square[k] for k in (0, 1, 2)]
            yield [square[k] for k in (0, 2, 3)]


def written(name, cells):
    facets = [*box((4, 2, 2), 1, True), *box((2, 1, 1), cells, False)]
    surface = stl.mesh.Mesh(np.zeros(len(facets), dtype=stl.mesh.Mesh.dtype))
    surface.vectors[:] = facets
    surface.save(name, mode=stl.Mode.ASCII)
    return float(stl.mesh.Mesh.from_file(name).get_mass_properties()[0])


def repaired(name, **how):
    fixed = pymeshfix.MeshFix(pyvista.read(name))
    fixed.repair(**how)
    return fixed.mesh.volume


def by_tetgen(hole):
    body = tetgen.TetGen(pyvista.read("body.stl").clean())
    if hole:
        body.add_hole((0, 0, 0))
    body.tetrahedralize(order=1)
    return body.grid.volume


def by_gmsh(topology):
    gmsh.clear()
    gmsh.merge("body.stl")
    if topology:
        gmsh.model.mesh.createTopology()
    loop = gmsh.model.geo.addSurfaceLoop([tag for _, tag in gmsh.model.getEntities(2)])
    gmsh.model.geo.addVolume([loop])
    gmsh.model.geo.synchronize()
    gmsh.model.mesh.generate(3)
    tetrahedra = gmsh.model.mesh.getElementsByType(4)[0]
    return gmsh.model.mesh.getElementQualities(tetrahedra, "volume").sum()


gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
seen = {"numpy-stl": written("body.stl", 1), "numpy-stl, fine chamber": written("fine.stl", 8),
        "pytetwild": pytetwild.tetrahedralize_pv(pyvista.read("body.stl"), edge_length_fac=0.3, optimize=False).volume,
        "pymeshfix": repaired("body.stl"), "pymeshfix, all components": repaired("body.stl", remove_smallest_components=False),
        "pymeshfix, fine chamber": repaired("fine.stl"), "tetgen": by_tetgen(False), "tetgen, hole": by_tetgen(True),
        "Gmsh": by_gmsh(False), "Gmsh, CreateTopology": by_gmsh(True)}
for program, volume in seen.items():
    print(f"{program}: {volume:.3f}")
if [round(float(volume), 2) for volume in seen.values()] != [14, 14, 14, 16, 14, 2, 16, 14, 16, 14]:
    sys.exit("one of them behaves otherwise now")
END
