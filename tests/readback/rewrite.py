"""Writes a VTU file again in every way vtk and meshio know, for nastic to read.

    python rewrite.py FILE.vtu DIRECTORY

vtk: text, inline, appended; raw and base64; plain and zlib; both byte orders; both header types; legacy files. meshio: text and
binary, plain and zlib. Prints the names written.
"""

import itertools
import sys
from pathlib import Path

import meshio
import vtk

source, directory = Path(sys.argv[1]), Path(sys.argv[2])
reader = vtk.vtkXMLUnstructuredGridReader()
reader.SetFileName(str(source))
reader.Update()

for mode, raw, zlib, big, wide in itertools.product(["Ascii", "Binary", "Appended"], *[[False, True]] * 4):
    if (mode == "Ascii" and (raw or zlib or big or wide)) or (mode == "Binary" and raw):
        continue
    name = "_".join(["vtk", mode, "raw" if raw else "base64", "zlib" if zlib else "plain", "big" if big else "little",
                     "64" if wide else "32"])
    writer = vtk.vtkXMLUnstructuredGridWriter()
    writer.SetInputConnection(reader.GetOutputPort())
    writer.SetFileName(str(directory / f"{name}.vtu"))
    getattr(writer, f"SetDataModeTo{mode}")()
    writer.SetEncodeAppendedData(not raw)
    if zlib:
        writer.SetCompressorTypeToZLib()
        writer.SetBlockSize(1024)
    else:
        writer.SetCompressorTypeToNone()
    (writer.SetByteOrderToBigEndian if big else writer.SetByteOrderToLittleEndian)()
    (writer.SetHeaderTypeToUInt64 if wide else writer.SetHeaderTypeToUInt32)()
    if writer.Write() != 1:
        sys.exit(f"vtk cannot write {name}")
    print(name)

for mode, version in itertools.product(["ASCII", "Binary"], [42, 51]):
    name = f"legacy_{mode}_{version}"
    writer = vtk.vtkUnstructuredGridWriter()
    writer.SetInputConnection(reader.GetOutputPort())
    writer.SetFileName(str(directory / f"{name}.vtk"))
    getattr(writer, f"SetFileTypeTo{mode}")()
    writer.SetFileVersion(version)
    if writer.Write() != 1:
        sys.exit(f"vtk cannot write {name}")
    print(name)

mesh = meshio.read(source)
for binary, compression in [(False, None), (True, None), (True, "zlib")]:
    name = f"meshio_{'binary' if binary else 'text'}_{compression or 'plain'}"
    meshio.vtu.write(directory / f"{name}.vtu", mesh, binary=binary, compression=compression)
    print(name)
