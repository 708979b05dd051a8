"""Reads STL files with VTK: no open edge, and the volume that stands in the text beside each.

python3 stl.py DIRECTORY     DIRECTORY holds NAME.stl and NAME.txt (the volume)
"""

import pathlib
import sys

from vtkmodules.vtkFiltersCore import vtkFeatureEdges, vtkMassProperties
from vtkmodules.vtkIOGeometry import vtkSTLReader

for path in sorted(pathlib.Path(sys.argv[1]).glob("*.stl")):
    reader = vtkSTLReader()
    reader.SetFileName(str(path))
    reader.MergingOn()
    edges = vtkFeatureEdges()
    edges.SetInputConnection(reader.GetOutputPort())
    edges.BoundaryEdgesOn()
    edges.FeatureEdgesOff()
    edges.NonManifoldEdgesOff()
    edges.ManifoldEdgesOff()
    edges.Update()
    mass = vtkMassProperties()
    mass.SetInputConnection(reader.GetOutputPort())
    mass.Update()
    expected = float(path.with_suffix(".txt").read_text())
    open_edges = edges.GetOutput().GetNumberOfCells()
    if open_edges or abs(mass.GetVolume() - expected) > 1e-4 * expected:
        sys.exit(f"{path.name}: {open_edges} open edges, volume {mass.GetVolume()}, expected {expected}")
    print(f"{path.name} agrees: {reader.GetOutput().GetNumberOfCells()} triangles, {mass.GetVolume()} mm^3")
