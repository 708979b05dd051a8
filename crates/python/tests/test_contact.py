"""Obstacles and contact: cases that touch, and derivatives by the pose of what they touch."""

import nastic
import numpy as np
import pytest
from conftest import ROOT


def indented() -> nastic.Case:
    return nastic.Case(
        {
            "nastic": 1,
            "units": "mm",
            "mesh": {"box": {"size": [20, 20, 10], "cells": [4, 4, 2], "element": "hex8"}},
            "materials": [{"region": "body", "law": "neo_hooke", "young": "0.1 MPa", "poisson": 0.3}],
            "supports": [{"surface": "z-", "fix": "all"}],
            "obstacles": [{"name": "ball", "shape": {"sphere": {"center": [10, 10, 25], "radius": 15}}}],
            "contact": [{"name": "dent", "surface": "z+", "obstacle": "ball"}],
            "controls": [
                {"of": "ball.translation", "space": "uniform", "lower": [0, 0, -3], "upper": [0, 0, 0], "start": [0, 0, -1]}
            ],
            "costs": [{"kind": "position", "point": [10, 10, 10], "target": {"z": 8}}],
        }
    )


def test_a_contact_reports_what_it_carries():
    found = indented().solve()
    dent = found.result["contributions"]["dent"]
    assert dent["force_z"] < 0 and dent["area"] > 0 and abs(dent["approach"] - 1) < 1e-12
    assert "pushes with" in found.log


def test_the_pose_of_an_obstacle_has_a_derivative():
    problem = indented().problem(accuracy=1e-12)
    m = np.array([0.0, 0.0, -1.0])
    _, gradient = problem.value_and_gradient(m)
    h = 1e-5
    ahead, behind = (problem.value(m + [0, 0, sign * h]) for sign in (1, -1))
    assert abs((ahead - behind) / (2 * h) - gradient[2]) < 1e-5 * abs(gradient[2])


def test_friction_is_there_in_motions():
    case = nastic.load(ROOT / "examples/cases/grasp.json")
    found = case.solve()
    grip = found.result["contributions"]["grip"]
    assert grip["sticking"] == 1.0 and abs(grip["force_y"] / (15 * 30 * 1070e-12 * 9810) - 1) < 1e-2


def test_a_block_is_dragged_over_a_floor_without_inertia():
    density, gravity, friction = 1000e-12, 10e3, 0.3
    case = nastic.Case(
        {
            "nastic": 1,
            "units": "mm",
            "mesh": {"box": {"size": [20, 20, 10], "cells": [2, 2, 1], "element": "hex8"}},
            "materials": [{"region": "body", "law": "neo_hooke", "young": 0.1, "poisson": 0.3, "density": density}],
            "supports": [{"surface": "y-", "fix": "y"}],
            "loads": [{"gravity": np.array([0, 0, -gravity])}],
            "time": {"end": 1, "step": 0.1, "scheme": "quasi_static", "start": "rest"},
            "actuation": [{"name": "pull", "kind": "motion", "surface": "x+", "fix": "x", "translation": ["2 mm * max(t - 0.1 s, 0 s) / (1 s)", 0, 0]}],
            "obstacles": [{"name": "floor", "shape": {"half_space": {"point": [0, 0, 0], "normal": [0, 0, 1]}}}],
            "contact": [{"name": "feet", "surface": "z-", "obstacle": "floor", "friction": friction, "slip_speed": 0.1}],
        }
    )
    found, weight = case.solve().result, 4000 * density * gravity
    feet = found["contributions"]["feet"]
    assert abs(feet["force_z"] / weight - 1) < 1e-8
    assert abs(feet["force_x"] / (-friction * weight) - 1) < 1e-6 and feet["sticking"] == 0
    assert abs(found["reactions"]["pull"][0] / (friction * weight) - 1) < 1e-6


def ball(centre: list[float]) -> nastic.Mesh:
    """A cube of eight cells blown up to a ball of radius 5."""
    x, y, z = (axis.ravel() for axis in np.meshgrid(*3 * [[-1.0, 0.0, 1.0]], indexing="ij"))
    points = np.column_stack([x, y, z])
    size = np.linalg.norm(points, axis=1, keepdims=True)
    points = 5 * np.divide(points, size, out=np.zeros_like(points), where=size > 0) + centre
    corners = np.array([0, 9, 12, 3, 1, 10, 13, 4])
    cells = [corners + 9 * i + 3 * j + k for i in (0, 1) for j in (0, 1) for k in (0, 1)]
    return nastic.Mesh(points, cells={"hex8": np.array(cells)}, regions={"ball": range(8)}, surfaces={"rim": size.ravel() > 0})


def test_a_rigid_ball_falls_on_a_slope_and_rolls():
    case = nastic.Case(
        {
            "nastic": 1,
            "units": "mm",
            "mesh": ball([0, 0, 6]),
            "materials": [
                {"region": "ball", "law": "neo_hooke", "young": 0.1, "poisson": 0.3, "density": 1000e-12, "rigid": True}
            ],
            "loads": [{"gravity": [1000, 0, -10e3]}],
            "time": {"end": 0.1, "step": 0.002, "scheme": "backward_euler", "start": "rest"},
            "obstacles": [{"name": "floor", "shape": {"half_space": {"point": [0, 0, 0], "normal": [0, 0, 1]}}}],
            "contact": [{"name": "rest", "surface": "rim", "obstacle": "floor", "friction": 1.0, "slip_speed": 1}],
        }
    )
    assert "1 rigid body of 6 unknowns" in case.check().log
    found = case.solve()
    moved = found.result["contributions"]["ball"]
    assert "rigid body  ball moves by (" in found.log
    places = found.points + found.displacement
    apart = lambda x: np.linalg.norm(x[:, None] - x[None], axis=2)  # noqa: E731
    assert np.abs(apart(places) - apart(found.points)).max() < 1e-9
    assert moved["translation_x"] > 0 and moved["rotation_y"] > 0 and -1 < moved["translation_z"] < 0
    case["time"]["velocity"] = ["X / (1 s)", 0, 0]
    with pytest.raises(nastic.CaseError, match="changes the shape"):
        case.check()


def test_an_obstacle_may_be_a_mesh_of_arrays():
    case = indented()
    case["obstacles"] = [{"name": "ball", "shape": {"mesh": ball([10, 10, 16])}, "grid": 1, "translation": [0, 0, -2]}]
    del case["controls"], case["costs"]
    dent = case.solve().result["contributions"]["dent"]
    assert dent["force_z"] < 0 and dent["approach"] > 0
