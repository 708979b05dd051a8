"""The soft torus of Drake's deformable example dropped on a floor, by Drake and by nastic, side by side.

    pip install drake numpy
    python benches/peers/torus_drake.py torus.vtk [modulus=5000] [height=0.28] [step=0.01] [until=6] [mu=1.15] [approximation=lagged]

The mesh of the example, scaled by 0.65; Poisson's ratio 0.4, density 800, stiffness damping 0.01 s, steps of backward Euler, the torus at rest with its lowest
node at `height` less half of its thickness. Drake: neo-Hookean law, the floor and contact properties of its example. Then
`cargo bench --bench torus -- what=drop`. One line of JSON for each (milliseconds per step, lowest node over the run with the floor at 0, smallest det F of a cell,
all but times in mm), and one of both: distances of corresponding nodes at the end.
"""

import json
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np
from pydrake.geometry import AddContactMaterial, Box, GeometryInstance, Mesh, ProximityProperties
from pydrake.math import RigidTransform
from pydrake.multibody.fem import DeformableBodyConfig, MaterialModel
from pydrake.multibody.plant import AddMultibodyPlant, CoulombFriction, MultibodyPlantConfig
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

SCALE = 0.65


def read_vtk(path):
    """Points and tetrahedra of a legacy VTK file."""
    lines = pathlib.Path(path).read_text().split("\n")

    def section(key):
        start = next(k for k, line in enumerate(lines) if line.startswith(key))
        count = int(lines[start].split()[1])
        return [line.split() for line in lines[start + 1 : start + 1 + count]]

    points = SCALE * np.array(section("POINTS"), float)
    return points, np.array(section("CELLS"), int)[:, 1:]


def volumes(points, cells):
    edges = [points[cells[:, k]] - points[cells[:, 0]] for k in (1, 2, 3)]
    return np.linalg.det(np.stack(edges, 2))


def drake(path, lift, asked):
    """Positions of the nodes after every step, and seconds per step."""
    builder = DiagramBuilder()
    config = MultibodyPlantConfig()
    config.time_step = asked["step"]
    config.discrete_contact_approximation = asked["approximation"]
    plant, _ = AddMultibodyPlant(config, builder)
    friction = CoulombFriction(asked["mu"], asked["mu"])
    of_floor = ProximityProperties()
    AddContactMaterial(None, None, friction, of_floor)
    of_floor.AddProperty("hydroelastic", "resolution_hint", 0.01)
    plant.RegisterCollisionGeometry(plant.world_body(), RigidTransform([0, 0, -2]), Box(4, 4, 4), "floor", of_floor)
    body = DeformableBodyConfig()
    body.set_youngs_modulus(asked["modulus"])
    body.set_poissons_ratio(0.4)
    body.set_mass_density(800)
    body.set_stiffness_damping_coefficient(0.01)
    body.set_material_model(MaterialModel.kNeoHookean)
    geometry = GeometryInstance(RigidTransform([0, 0, lift]), Mesh(str(pathlib.Path(path).resolve()), SCALE), "torus")
    of_torus = ProximityProperties()
    AddContactMaterial(10.0, None, friction, of_torus)
    geometry.set_proximity_properties(of_torus)
    model = plant.mutable_deformable_model()
    identity = model.RegisterDeformableBody(geometry, body, 1.0)
    plant.Finalize()
    diagram = builder.Build()
    context = diagram.CreateDefaultContext()
    simulator = Simulator(diagram, context)
    simulator.Initialize()
    state = plant.GetMyContextFromRoot(context)
    index = model.GetDiscreteStateIndex(identity)
    shots, seconds = [], 0.0
    for n in range(1, round(asked["until"] / asked["step"]) + 1):
        began = time.perf_counter()
        simulator.AdvanceTo(n * asked["step"])
        seconds += time.perf_counter() - began
        values = np.array(state.get_discrete_state(index).value())
        shots.append(values[: len(values) // 3].reshape(-1, 3))
    return np.array(shots), seconds / len(shots)


def nastic(path, asked):
    """The line of the bench, and the positions at the end."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "end.txt"
        keys = [f"{key}={asked[key]:g}" for key in ("modulus", "height", "step", "until", "mu")]
        command = ["cargo", "bench", "--quiet", "--workspace", "--bench", "torus", "--", f"mesh={path}", "what=drop", f"out={out}"]
        done = subprocess.run(command + keys, check=True, capture_output=True, text=True)
        found = json.loads(next(line for line in reversed(done.stdout.split("\n")) if line.startswith("{")))
        return found, np.loadtxt(out)


def main():
    path = sys.argv[1]
    asked = {"modulus": 5000.0, "height": 0.28, "step": 0.01, "until": 6.0, "mu": 1.15, "approximation": "lagged"}
    for argument in sys.argv[2:]:
        key, value = argument.split("=")
        asked[key] = type(asked[key])(value)
    points, cells = read_vtk(path)
    tube = -points[:, 2].min()
    lift = asked["height"]  # of the middle of the mesh: its lowest node is at the height less half of its thickness
    rest = volumes(points, cells)
    began = time.perf_counter()
    try:
        shots, seconds = drake(path, lift, asked)
    except RuntimeError as error:
        print(json.dumps({"code": "drake", "failed": str(error)[:200], "seconds": time.perf_counter() - began}))
        shots = None
    if shots is not None:
        line = {
            "code": "drake",
            "steps": len(shots),
            "ms_per_step": round(1e3 * seconds, 3),
            "lowest_node_mm": round(1e3 * shots[:, :, 2].min(), 3),
            "lowest_node_end_mm": round(1e3 * shots[-1, :, 2].min(), 3),
            "min_j": round(min((volumes(x, cells) / rest).min() for x in shots), 4),
            "fastest_end_mm_per_s": round(1e3 * np.abs(shots[-1] - shots[-2]).max() / asked["step"], 4),
        }
        print(json.dumps(line))
    found, end = nastic(path, asked)
    print(json.dumps({"code": "nastic", **found}))
    if shots is not None:
        # friction and the way there leave the place on the floor open: both with their middle at the origin
        there, here = shots[-1].copy(), end.copy()
        moved = there.mean(0) - here.mean(0)
        there[:, :2] -= moved[:2]
        apart = np.linalg.norm(there - here, axis=1)
        line = {
            "apart_largest_mm": round(1e3 * apart.max(), 3),
            "apart_rms_mm": round(1e3 * np.sqrt((apart**2).mean()), 3),
            "mean_height_differs_mm": round(1e3 * moved[2], 3),
            "moved_aside_mm": round(1e3 * np.hypot(*moved[:2]), 3),
            "thickness_mm": round(2e3 * tube, 3),
        }
        print(json.dumps(line))


main()
