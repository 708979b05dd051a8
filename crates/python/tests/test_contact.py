"""Obstacles and contact: cases that touch, and derivatives by the pose of what they touch."""

import nastic
import numpy as np
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
