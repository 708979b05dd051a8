"""The examples of CalculiX as meshes, beside what meshio makes of them: cells by kind, and the volume of their corners.

    apt-get install calculix-ccx-test
    target/python-package/bin/python scripts/calculix-examples.py        after scripts/test-python.sh, which installs nastic and meshio

Files without bodies of solids (networks, shells, axisymmetric elements) are refused by name; meshio gives up on others. Fails if a file that both read
differs, or if fewer than LEAST_READ are read. Version 2.11: 227 of 355 read, 89 of them by both, all alike to 1e-9.
"""

import collections
import contextlib
import gzip
import io
import sys
import tempfile
from pathlib import Path

import meshio
import nastic
import numpy as np

EXAMPLES = Path("/usr/share/doc/calculix-ccx-test/examples")
LEAST_READ = 227
KINDS = {"tetra": "tet4", "tetra10": "tet10", "hexahedron": "hex8", "hexahedron20": "hex20"}
CORNERS = {"tet": [(0, 1, 2, 3)], "hex": [(0, 1, 3, 4), (1, 2, 3, 6), (1, 3, 4, 6), (3, 4, 6, 7), (1, 4, 5, 6)]}


def measured(points, cells):
    """Cells by kind, and the sum of the volumes of the tetrahedra between their corners."""
    counts, volume = collections.Counter(), 0.0
    for kind, nodes in cells:
        for first, second, third, fourth in CORNERS.get(kind[:3], []):
            a, b, c, d = (points[nodes[:, k]] for k in (first, second, third, fourth))
            volume += abs(np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a)).sum() / 6
        if kind[:3] in CORNERS and len(nodes):
            counts[kind] += len(nodes)
    return counts, volume


def read_by_both(file):
    """Whether nastic reads it, and whether meshio makes the same of it; None where that reads none."""
    try:
        own = nastic.Mesh.read(file)
    except nastic.Error:
        return False, None
    try:
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            other = meshio.read(file)
    except (Exception, SystemExit):
        return True, None
    known = [(KINDS[block.type], block.data) for block in other.cells if block.type in KINDS]
    (counts, volume), (others, beside) = measured(own.points, own.cells.items()), measured(other.points, known)
    return True, counts == others and bool(abs(volume - beside) <= 1e-9 * beside)


def main():
    packed = sorted(EXAMPLES.rglob("*.inp*"))
    if not packed:
        sys.exit(f"there are no examples in {EXAMPLES}: apt-get install calculix-ccx-test")
    read, same, differing = 0, 0, []
    with tempfile.TemporaryDirectory() as directory:
        for source in packed:
            file = Path(directory, source.name.removesuffix(".gz"))
            file.write_bytes(gzip.decompress(source.read_bytes()) if source.suffix == ".gz" else source.read_bytes())
            is_read, is_same = read_by_both(file)
            read += is_read
            same += is_same is True
            if is_same is False:
                differing.append(file.name)
    print(f"{len(packed)} files: {read} read, {same} of them by meshio too and alike; different: {differing or 'none'}")
    sys.exit(bool(differing) or read < LEAST_READ)


if __name__ == "__main__":
    main()
