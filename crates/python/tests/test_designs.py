"""Layouts: by mma, with a medium in the void, cut and made."""

import zipfile

import pytest

import nastic


@pytest.fixture
def layout() -> nastic.Case:
    """A cantilever, of which at most 0.6 may be filled."""
    return nastic.Case(
        {
            "nastic": 1,
            "title": "Layout",
            "mesh": {"box": {"size": [0.06, 0.03], "cells": [16, 8], "element": "quad4"}},
            "materials": [
                {
                    "region": "body",
                    "law": "neo_hooke",
                    "young": "1 MPa",
                    "poisson": 0.3,
                    "design": [{"name": "rho", "kind": "density", "least": 1e-3}],
                }
            ],
            "media": [{"name": "void", "region": "body", "stiffness": "20 Pa"}],
            "supports": [{"surface": "x-", "fix": "all"}],
            "loads": [{"surface": "x+", "traction": [0, "-500 Pa"]}],
            "controls": [
                {"of": "rho", "space": "cell", "start": 0.5, "filter": "4 mm", "projection": {"sharpness": 4}, "least_bar": "1 m"}
            ],
            "costs": [{"kind": "displacement", "surface": "x+", "direction": [0, -1]}],
            "constraints": [{"cost": {"kind": "design_volume", "of": "rho"}, "at_most": 0.6}],
            "optimizer": {"method": "mma", "max_iterations": 20, "tolerance": 1e-6},
        },
        name="layout",
    )


def test_a_layout_is_sought_by_mma_and_cut(layout, tmp_path):
    found = layout.optimize(out=tmp_path / "out")
    result = found.result
    rho = result["controls"]["rho"]
    assert result["cost"]["total"] < 0.8 * result["start"]["cost"]["total"]
    assert rho["volume"] < 0.6 + 1e-3 and abs(rho["cut_volume"] - rho["volume"]) < 0.02
    assert result["contributions"]["void"]["energy"] > 0 and result["cut_cost"] > 0
    assert 0 < rho["smallest_bar"]["width"] < 0.03 and len(rho["smallest_bar"]["position"]) == 3
    assert any(warning["code"] == "thin" for warning in result["warnings"])
    with zipfile.ZipFile(tmp_path / "out/design.3mf") as made:
        assert b'unit="millimeter"' in made.read("3D/3dmodel.model") and made.testzip() is None
    # each cell filled or not, by a level in the case
    control = layout["controls"][0]
    control.update(start={"file": str(tmp_path / "out/controls.json")}, cut=rho["level"])
    del control["projection"], layout["constraints"]
    cut = layout.solve().result
    assert (cut["controls"]["rho"]["min"], cut["controls"]["rho"]["max"]) == (0, 1)
    with pytest.raises(nastic.CaseError, match="a field that is cut has no derivative"):
        layout.optimize()
