"""What solve can be asked for, modes, fit, figures, plots; meshes of other programs."""

import json
import pathlib

import numpy as np
import pytest

import nastic

ROOT = pathlib.Path(__file__).resolve().parents[3]


def test_solve_does_what_its_options_say(bar):
    ramp = bar.solve(ramp="tension=0:-20 kPa:3").result["ramp"]
    assert len(ramp["points"]) == 3, ramp
    assert len(bar.solve(modes=2).result["modes"]["eigenvalues"]) == 2
    assert bar.solve(path=True).result["path"]["points"]
    with pytest.raises(nastic.CaseError, match="one of these at a time, and path and modes"):
        bar.solve(path=True, modes=3)


def test_modes(bar):
    bar["materials"][0]["density"] = "1000 kg/m^3"
    about = bar.modes(3).result["modes"]["frequencies"]
    rest = bar.modes(3, undeformed=True).result["modes"]["frequencies"]
    assert len(about) == len(rest) == 3 and about[0] > 0 and about != rest


def test_identify_finds_a_modulus_from_markers():
    case = {
        "nastic": 1,
        "units": {"length": "mm", "force": "N"},
        "mesh": {"box": {"size": [50, 5, 5], "cells": [2, 1, 1], "element": "hex8"}},
        "materials": [{"name": "rubber", "region": "body", "law": "neo_hooke", "young": "150 kPa", "poisson": 0.0}],
        "supports": [{"surface": f"{axis}-", "fix": [axis]} for axis in "xyz"],
        "loads": [{"surface": "x+", "traction": ["0.2 kPa", 0, 0]}],
        "controls": [{"of": "rubber.young", "space": "uniform", "log": True}],
        "costs": [{"kind": "markers", "deviation": "1 um", "markers": [{"point": [50, y, 2], "position": {"x": 50 + 1 / 12}} for y in (1, 4)]}],
    }
    found = nastic.Case(case).identify().result["identification"]
    modulus = found["parameters"]["rubber.young"]
    low, high = modulus["interval"]
    assert found["readings"] == 2 and low < 0.12 < high and modulus["deviation"] == pytest.approx(0.12 * 0.012 / 2**0.5, rel=0.02)
    case["costs"] = [{"kind": "tracking", "surface": "x+", "target": ["X", "Y", "Z"]}]
    with pytest.raises(nastic.CaseError, match="no sum of squared readings"):
        nastic.Case(case).identify()


def test_gains_are_sensitivities_and_a_law():
    case = {
        "nastic": 1,
        "mesh": {"box": {"size": [0.1, 0.01, 0.01], "cells": [4, 1, 1], "element": "hex8"}},
        "materials": [{"region": "body", "law": "neo_hooke", "young": "0.3 MPa", "poisson": 0.3}],
        "supports": [{"surface": "x-", "fix": "all"}],
        "actuation": [{"name": "fibers", "kind": "fiber_tension", "region": "body", "direction": [1, 0, 0]}],
        "controls": [{"of": "fibers", "space": "uniform", "lower": "-60 kPa", "upper": 0}],
        "costs": [{"kind": "position", "surface": "x+", "target": {"x": 0.097}}],
    }
    found = nastic.Case(case).gains().result["gains"]
    (row,) = found["outputs"]
    # u = sigma L / E of a bar, stiffer by what holds its end
    assert row["sensitivities"][0] == pytest.approx(0.1 / 0.3e6, rel=0.1)
    assert found["nominal"]["errors"][-1] < 1e-6 * found["nominal"]["errors"][0]
    with pytest.raises(nastic.CaseError, match="needs costs"):
        nastic.Case({**case, "costs": []}).gains()


def test_fit_takes_a_file_or_a_dictionary(tmp_path):
    place = ROOT / "examples/fit"
    asked = {
        "nastic_fit": 1,
        "tests": [{"kind": "uniaxial", "file": "treloar_uniaxial.csv"}],
        "laws": ["yeoh", "neo_hooke"],
        "bulk": "1 GPa",
    }
    found = nastic.fit(asked, directory=place, out=tmp_path / "out")
    assert (tmp_path / "out/fit.json").is_file() and len(found["laws"]) == 2
    asked["tests"][0]["file"] = str(place / "treloar_uniaxial.csv")
    (tmp_path / "asked.json").write_text(json.dumps(asked))
    assert nastic.fit(tmp_path / "asked.json")["laws"][0] == found["laws"][0]
    assert sorted(file.name for file in tmp_path.iterdir()) == ["asked.json", "out"]
    with pytest.raises(nastic.Error, match="nothing.csv"):
        nastic.fit({**asked, "tests": [{"kind": "uniaxial", "file": "nothing.csv"}]}, directory=place)
    # a table alone
    alone = nastic.fit("treloar_uniaxial.csv", directory=place, bulk="1 GPa", laws=["yeoh", "neo_hooke"])
    assert alone["laws"][0] == found["laws"][0]
    with pytest.raises(TypeError, match="in data files and dictionaries they are keys"):
        nastic.fit(asked, bulk="1 GPa")


def test_figures_and_plots(bar, tmp_path):
    bar["optimizer"]["max_iterations"] = 2
    best = bar.optimize(out=tmp_path / "run", figure=True)
    assert {"figure.png", "figure.svg"} <= set(best.result["files"])
    drawn = best.figure(tmp_path / "a.svg", field="|u|", clip=((0.0, 1.0, 0.0), 0.1), behind=[], edges=True)
    assert "displacement |u|" in drawn.read_text() and "target" not in drawn.read_text()
    with pytest.raises(nastic.Error, match="there is no field \"q\""):
        best.figure(field="q")
    bar["output"] = {"every": 1}
    film = bar.optimize(out=tmp_path / "film").frames(tmp_path / "frames", series="iteration", field="|u|", size=(320, 200))
    assert film == tmp_path / "frames" / "frames.gif" and film.read_bytes().startswith(b"GIF89a")
    assert (tmp_path / "frames" / "frame_0002.png").exists()
    with pytest.raises(nastic.Error, match="there is no series of states \"motion\""):
        best.frames(series="motion")
    with pytest.raises(nastic.Error, match="fps is from 1 to 50"):
        best.frames(fps=0.0)
    with pytest.raises(nastic.Error, match="out="):
        bar.solve().figure()
    matplotlib = pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    matplotlib.use("agg")
    assert len(best.plot().axes) == 2 and len(bar.solve().plot().axes) == 1


def test_mesh_files_are_read(tmp_path):
    mesh = nastic.Mesh.read(ROOT / "meshes/finger.msh")
    assert {"clamp", "tip"} <= set(mesh.surfaces) and len(mesh.points) > 100
    assert np.allclose(nastic.Mesh.read(ROOT / "meshes/finger.msh", scale=2.0).points, 2 * mesh.points)
    with pytest.raises(nastic.Error, match="nowhere.msh"):
        nastic.Mesh.read(tmp_path / "nowhere.msh")


def test_meshes_come_from_meshio(tmp_path):
    meshio = pytest.importorskip("meshio", reason="meshio is not installed")
    own = nastic.Mesh.read(ROOT / "meshes/finger.msh")
    given = nastic.Mesh.from_meshio(meshio.read(ROOT / "meshes/finger.msh"))
    assert {kind: len(cells) for kind, cells in given.cells.items()} == {kind: len(cells) for kind, cells in own.cells.items()}
    assert {name: len(facets) for name, facets in given.surfaces.items()} == {name: len(facets) for name, facets in own.surfaces.items()}
    assert given.regions.keys() == own.regions.keys()
    square = meshio.Mesh(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0]],
        [("triangle", [[0, 1, 2], [0, 2, 3]]), ("triangle", [[1, 4, 2]]), ("line", [[0, 3]])],
        cell_sets={"left": [np.array([0, 1]), np.array([], int), None], "wall": [None, None, np.array([0])]},
        point_sets={"corner": np.array([4])},
    )
    found = nastic.Mesh.from_meshio(square, scale=0.5)
    assert len(found.cells["tri3"]) == 3 and list(found.regions["left"]) == [0, 1] and len(found.surfaces["wall"]) == 1
    assert list(found.nodes) == ["corner"] and found.points.max() == 1.0
    with pytest.raises(nastic.CaseError, match="pyramid"):
        nastic.Mesh.from_meshio(meshio.Mesh(np.zeros((5, 3)), [("pyramid", [[0, 1, 2, 3, 4]])]))


def test_meshes_come_from_gmsh():
    gmsh = pytest.importorskip("gmsh", reason="Gmsh is not installed")
    gmsh.initialize()
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        box = gmsh.model.occ.addBox(0, 0, 0, 2, 1, 1)
        gmsh.model.occ.synchronize()
        gmsh.model.addPhysicalGroup(3, [box], name="arm")
        gmsh.model.addPhysicalGroup(2, [1], name="clamp")
        gmsh.model.mesh.generate(3)
        mesh = nastic.Mesh.from_gmsh(gmsh)
    finally:
        gmsh.finalize()
    assert list(mesh.regions) == ["arm"] and list(mesh.surfaces) == ["clamp"] and mesh.points[:, 0].max() == 2.0
