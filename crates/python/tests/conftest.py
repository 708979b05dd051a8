"""Small cases."""

from pathlib import Path

import nastic
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture
def bar() -> nastic.Case:
    """A bar of eight cells with a fibre along it, whose end is to be lifted."""
    return nastic.Case(
        {
            "nastic": 1,
            "title": "Bar",
            "mesh": {"box": {"size": [1.0, 0.25, 0.25], "cells": [4, 1, 2], "element": "hex8"}},
            "materials": [{"region": "body", "law": "neo_hooke", "young": "300 kPa", "poisson": 0.3}],
            "supports": [{"surface": "x-", "fix": ["x", "y", "z"]}],
            "actuation": [{"name": "tension", "kind": "fiber_tension", "region": "body", "direction": [1, 0, 0]}],
            "controls": [{"of": "tension", "space": "cell", "start": "-50 kPa * Z / 0.25 m", "lower": "-100 kPa", "upper": 0}],
            "costs": [
                {"kind": "tracking", "surface": "x+", "target": ["X - 0.05", "Y", "Z + 0.1"]},
                {"kind": "control_norm", "of": "tension", "weight": 1e-12},
            ],
            "optimizer": {"method": "lbfgs", "max_iterations": 40, "tolerance": 1e-5},
            "probes": [{"name": "tip", "point": [1.0, 0.25, 0.25]}],
        },
        name="bar",
    )


@pytest.fixture
def two_loads(bar: nastic.Case) -> nastic.Case:
    """The bar in two scenarios."""
    bar["scenarios"] = [
        {"name": "soft", "probability": 0.5, "set": {"materials/0/young": "250 kPa"}},
        {"name": "stiff", "probability": 0.5, "set": {"materials/0/young": "350 kPa"}},
    ]
    return bar


def brick(cells: int = 3) -> tuple[np.ndarray, np.ndarray]:
    """Points and hex8 cells of a bar 1 x 0.2 x 0.2 along x."""
    x, y, z = np.meshgrid(np.linspace(0, 1, cells + 1), [0, 0.2], [0, 0.2], indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    first = 4 * np.arange(cells)[:, None]
    return points, first + np.array([0, 4, 6, 2, 1, 5, 7, 3])


@pytest.fixture
def box() -> tuple[np.ndarray, np.ndarray]:
    return brick()
