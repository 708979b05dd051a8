"""A rigid ball pressed into a soft block, by CalculiX and by nastic, side by side.

    apt-get install calculix-ccx; pip install numpy; cargo build --release -p nastic-cli
    python3 benches/peers/hertz_calculix.py target/release/nastic [cells=24] [depth=0.1] [runs=3]

A block of 2 x 2 x 1 m of `cells` x `cells` x 2/3 `cells` linear hexahedra with 8 Gauss points, clamped at its bottom, neo-Hookean (mu = 40 kPa, kappa = 200 kPa),
and a ball of radius 2 m that moves down by `depth`. CalculiX: surface-to-surface contact by penalty, p = 5e7 Pa/m times the overclosure, the ball a rigid body of
facets a twenty-fifth of the block's width, SPOOLES, steps of its own from a quarter of the way on. nastic: its defaults. One line of JSON for each: median wall
time of the whole program, force, and of nastic the solve alone. The forces are not to be the same: the volumetric energy is kappa/2 (J - 1)^2 in CalculiX and
kappa/4 (J^2 - 1 - 2 log J) in nastic, equal to second order in J - 1, and the layers of contact differ.
"""

import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import numpy as np

RADIUS, MU, KAPPA, PENALTY = 2.0, 4e4, 2e5, 5e7
CAP = 0.8  # half-width of the meshed part of the ball


def grid(counts, place):
    """Nodes and linear hexahedra of a grid of cells, the nodes from 1 on."""
    nx, ny, nz = (n + 1 for n in counts)
    k, j, i = np.meshgrid(range(nz), range(ny), range(nx), indexing="ij")
    points = place(i.ravel() / (nx - 1), j.ravel() / (ny - 1), k.ravel() / (nz - 1))
    k, j, i = (a.ravel() for a in np.meshgrid(range(nz - 1), range(ny - 1), range(nx - 1), indexing="ij"))
    first = 1 + i + nx * (j + ny * k)
    corners = [0, 1, 1 + nx, nx]
    cells = np.stack([first + c for c in corners + [c + nx * ny for c in corners]], axis=1)
    return points, cells


def deck(cells, depth):
    """The input of CalculiX."""
    counts = (cells, cells, 2 * cells // 3)
    points, blocks = grid(counts, lambda x, y, z: np.stack([2 * x - 1, 2 * y - 1, z], axis=1))

    def cap(x, y, z):
        x, y = CAP * (2 * x - 1), CAP * (2 * y - 1)
        low = 1 + RADIUS - np.sqrt(RADIUS**2 - x**2 - y**2)
        return np.stack([x, y, low + 0.2 * z], axis=1)

    ball_points, balls = grid((20, 20, 1), cap)
    nodes, elements = len(points), len(blocks)
    reference, rotation = nodes + len(ball_points) + 1, nodes + len(ball_points) + 2
    lines = ["*NODE, NSET=ALL"]
    everything = np.concatenate([points, ball_points, [[0, 0, 3], [0, 0, 3]]])
    lines += [f"{n + 1}, {x:.12g}, {y:.12g}, {z:.12g}" for n, (x, y, z) in enumerate(everything)]
    for name, found, offset in ("BLOCK", blocks, (0, 0)), ("BALL", balls, (nodes, elements)):
        lines.append(f"*ELEMENT, TYPE=C3D8, ELSET={name}")
        lines += [f"{offset[1] + e + 1}, " + ", ".join(str(n + offset[0]) for n in cell) for e, cell in enumerate(found)]
    top = range(elements - counts[0] * counts[1] + 1, elements + 1)
    for name, numbers in ("TOP", top), ("CAP", range(elements + 1, elements + len(balls) + 1)):
        lines += [f"*ELSET, ELSET={name}", *map(str, numbers)]
    for name, numbers in ("BOTTOM", np.flatnonzero(points[:, 2] == 0) + 1), ("RIGID", range(nodes + 1, reference)):
        lines += [f"*NSET, NSET={name}", *map(str, numbers)]
    lines += f"""*MATERIAL, NAME=SOFT
*HYPERELASTIC, NEO HOOKE
{MU / 2}, {2 / KAPPA}
*MATERIAL, NAME=HARD
*ELASTIC
1e9, 0.3
*SOLID SECTION, ELSET=BLOCK, MATERIAL=SOFT
*SOLID SECTION, ELSET=BALL, MATERIAL=HARD
*RIGID BODY, NSET=RIGID, REF NODE={reference}, ROT NODE={rotation}
*SURFACE, NAME=SLAVE
TOP, S2
*SURFACE, NAME=MASTER
CAP, S1
*SURFACE INTERACTION, NAME=PUSH
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
{PENALTY}
*CONTACT PAIR, INTERACTION=PUSH, TYPE=SURFACE TO SURFACE
SLAVE, MASTER
*BOUNDARY
BOTTOM, 1, 3
{rotation}, 1, 3
{reference}, 1, 2
*STEP, NLGEOM, INC=200
*STATIC
0.25, 1
*BOUNDARY
{reference}, 3, 3, {-depth}
*NODE PRINT, NSET=BOTTOM, TOTALS=ONLY
RF
*END STEP""".splitlines()
    return "\n".join(lines) + "\n", 3 * nodes


def calculix(place, cells, depth):
    text, unknowns = deck(cells, depth)
    (place / "ball.inp").write_text(text)
    clock = time.perf_counter()
    done = subprocess.run(["ccx", "ball"], cwd=place, capture_output=True, text=True, check=False)
    seconds = time.perf_counter() - clock
    printed = place / "ball.dat"
    totals = printed.read_text().split("total force") if printed.exists() else []
    if done.returncode or len(totals) < 2:
        sys.exit(done.stdout[-2000:] + done.stderr)
    force = float(totals[-1].split("\n\n")[1].split()[2])
    iterations = done.stdout.count("iteration ")
    return {"seconds": seconds, "unknowns": unknowns, "iterations": iterations, "force": abs(force)}


def nastic(place, program, cells, depth):
    case = {
        "nastic": 1,
        "mesh": {"box": {"element": "hex8", "size": [2, 2, 1], "cells": [cells, cells, 2 * cells // 3]}},
        "materials": [{"region": "body", "law": "neo_hooke_isochoric", "shear": MU, "bulk": KAPPA}],
        "supports": [{"surface": "z-", "fix": "all"}],
        "obstacles": [
            {"name": "ball", "shape": {"sphere": {"center": [1, 1, 1 + RADIUS], "radius": RADIUS}}, "translation": [0, 0, -depth]}
        ],
        "contact": [{"name": "push", "surface": "z+", "obstacle": "ball"}],
    }
    (place / "ball.json").write_text(json.dumps(case))
    clock = time.perf_counter()
    done = subprocess.run([program, "solve", "ball.json", "--quiet", "--out", "out"], cwd=place, capture_output=True, text=True, check=False)
    seconds = time.perf_counter() - clock
    if done.returncode:
        sys.exit(done.stderr)
    found = json.loads((place / "out/result.json").read_text())
    force = abs(found["contributions"]["push"]["force_z"])
    return {"seconds": seconds, "solve": found["seconds"]["solve"], "iterations": found["newton_iterations"], "force": force}


def main():
    options = dict(cells="24", depth="0.1", runs="3") | dict(option.split("=") for option in sys.argv[2:])
    program, cells, depth = str(pathlib.Path(sys.argv[1]).resolve()), int(options["cells"]), float(options["depth"])
    os.environ.setdefault("OMP_NUM_THREADS", str(os.cpu_count()))
    found = {"calculix": [], "nastic": []}
    for _ in range(int(options["runs"])):
        with tempfile.TemporaryDirectory() as place:
            found["nastic"].append(nastic(pathlib.Path(place), program, cells, depth))
        with tempfile.TemporaryDirectory() as place:
            found["calculix"].append(calculix(pathlib.Path(place), cells, depth))
    for name, all_runs in found.items():
        middle = {key: statistics.median(run[key] for run in all_runs) for key in all_runs[0]}
        print(json.dumps({"program": name} | middle))


main()
