"""Results: arrays, pictures, other packages' meshes."""

import json
import pickle

import nastic
import numpy as np
import pytest


def test_a_solve_gives_arrays(bar):
    found = bar.solve()
    assert found.points.shape == (30, 3) and found.points.dtype == np.float64
    assert found.cells["hex8"].shape == (8, 8) and found.cells["hex8"].max() == 29
    assert found.displacement.shape == (30, 3)
    assert np.abs(found.displacement[found.points[:, 0] == 0]).max() == 0
    tip = int(np.flatnonzero((found.points == [1.0, 0.25, 0.25]).all(axis=1))[0])
    assert np.allclose(found.displacement[tip], found.result["probes"]["tip"]["displacement"], rtol=1e-12)
    assert found.cell_data["J"].shape == (8,) and found.cell_data["cauchy_stress"].shape == (8, 3, 3)
    assert np.allclose(found.cell_data["cauchy_stress"], found.cell_data["cauchy_stress"].transpose(0, 2, 1))
    assert found.controls["tension"].shape == (8,)
    assert np.array_equal(found.cell_data["tension"], found.controls["tension"])
    assert found.gradient == {} and found.converged is None and found.history == []
    assert set(found.states) == {""}


def test_the_gradient_is_that_of_the_derivative_file(bar, tmp_path):
    found = bar.gradient(out=tmp_path)
    written = json.loads((tmp_path / "derivative.json").read_text())
    assert np.array_equal(found.gradient["tension"], written["tension"])
    volumes = 1.0 * 0.25 * 0.25 / 8
    assert np.allclose(found.cell_data["gradient_tension"], found.gradient["tension"] / volumes, rtol=1e-10, atol=0)


def test_shapes_are_compared_and_have_points(bar, tmp_path):
    a = bar.solve(out=tmp_path / "a")
    bar["controls"][0]["start"] = -2.5e4
    b = bar.solve(out=tmp_path / "b")
    found = nastic.compare(a, tmp_path / "b")
    apart = np.linalg.norm(a.displacement - b.displacement, axis=1)
    assert np.isclose(found["node_by_node"]["largest"], apart.max(), rtol=1e-9) and apart.max() > 0
    assert np.isclose(found["node_by_node"]["rms"], np.sqrt(np.mean(apart**2)), rtol=1e-9)
    cloud = nastic.cloud(b)
    assert np.allclose(cloud.points, b.points + b.displacement, rtol=0, atol=1e-15)
    assert np.array_equal(cloud.reference, b.points) and np.array_equal(cloud.nodes, np.arange(30))
    face = nastic.cloud(b, "start", surface="x+")
    assert (face.reference[:, 0] == 1.0).all() and 0 < len(face.nodes) < 30
    np.save(tmp_path / "scan.npy", 1e3 * face.points)
    assert nastic.compare(b, tmp_path / "scan.npy", surface="x+", scale=1e-3)["chamfer"] < 1e-12
    with pytest.raises(nastic.CaseError, match="lid"):
        nastic.cloud(b, surface="lid")
    with pytest.raises(nastic.Error, match="out="):
        nastic.compare(bar.solve(), b)


def test_an_optimisation_is_told_trial_by_trial(bar):
    told = []
    found = bar.optimize(callback=told.append)
    assert found.converged is True and found.result["stop"]
    assert found.history == told
    assert [trial["trial"] for trial in told] == list(range(len(told)))
    accepted = [trial["cost"] for trial in told if trial["accepted"]]
    assert accepted[-1] == found.result["cost"]["total"] < 0.2 * accepted[0]
    assert found.controls["tension"].min() >= -100e3 and found.controls["tension"].max() <= 0


def test_an_exception_in_the_callback_ends_the_run_and_is_raised(bar, tmp_path):
    class Enough(Exception):
        pass

    told = []

    def callback(trial):
        told.append(trial)
        if trial["iteration"] == 1:
            raise Enough("of it")

    with pytest.raises(Enough, match="of it"):
        bar.optimize(callback=callback, out=tmp_path)
    assert told[-1]["iteration"] == 1
    written = json.loads((tmp_path / "result.json").read_text())
    assert written["iterations"] == 1 and written["converged"] is False


def test_an_interrupted_optimisation_is_not_replaced_unasked(bar, tmp_path):
    bar["output"] = {"checkpoint": 1}

    def stop(trial):
        if trial["iteration"] == 3:
            raise RuntimeError

    with pytest.raises(RuntimeError):
        bar.optimize(callback=stop, out=tmp_path)
    with pytest.raises(nastic.CaseError, match="interrupted optimisation"):
        bar.optimize(out=tmp_path)
    assert bar.optimize(out=tmp_path, restart=True).converged


def test_several_states_have_names(two_loads):
    found = two_loads.solve()
    assert set(found.states) == {"soft", "stiff"}
    tip = {name: np.linalg.norm(state.displacement, axis=1).max() for name, state in found.states.items()}
    assert tip["soft"] > tip["stiff"] > 0
    with pytest.raises(nastic.Error, match="'soft', 'stiff'"):
        found.displacement


def test_results_survive_pickling_with_their_picture(bar):
    found = bar.gradient()
    again = pickle.loads(pickle.dumps(found))
    assert again.result == found.result and again.log == found.log
    assert np.array_equal(again.displacement, found.displacement)
    assert np.array_equal(again.gradient["tension"], found.gradient["tension"])
    assert again._repr_png_() == found._repr_png_()
    assert again._repr_png_()[:8] == b"\x89PNG\r\n\x1a\n"


def test_a_result_shows_itself_as_a_table_or_as_its_page(bar, tmp_path):
    found = bar.solve()
    table = found._repr_html_()
    assert table.startswith("<table>") and "Bar" in table and "min_J" in table
    assert f"<td>{found.result['cost']['total']:.6g}</td>" in table
    written = bar.solve(out=tmp_path / "out")
    page = written._repr_html_()
    assert page.startswith("<iframe srcdoc=") and "&lt;html" in page.lower()
    assert page.count("<") == 2, "everything of the page is escaped"
    without = bar.solve(out=tmp_path / "other", report=False)
    assert not (tmp_path / "other" / "report.html").exists() and without._repr_html_().startswith("<table>")


def test_the_picture_is_the_one_that_is_written(bar, tmp_path):
    found = bar.solve(out=tmp_path)
    assert found._repr_png_() == (tmp_path / "picture.png").read_bytes()


def test_a_check_has_no_state(bar):
    with pytest.raises(nastic.Error, match="0 states"):
        bar.check().points


def test_meshio_gets_all_fields(bar, tmp_path):
    meshio = pytest.importorskip("meshio", reason="meshio is not installed")
    found = bar.gradient(out=tmp_path)
    mesh, file = found.to_meshio(), meshio.read(tmp_path / "start.vtu")
    assert np.array_equal(mesh.points, file.points)
    assert mesh.cells[0].type == "hexahedron" and np.array_equal(mesh.cells[0].data, file.cells[0].data)
    assert set(mesh.point_data) == set(file.point_data)
    for name in mesh.cell_data:
        assert np.allclose(mesh.cell_data[name][0], file.cell_data[name][0], rtol=1e-14), name
    mesh.write(tmp_path / "own.vtu")


@pytest.mark.parametrize(
    "kind", ["tri3", "tri6", "quad4", "quad8", "quad9", "tet4", "tet10", "hex8", "hex20", "hex27"]
)
def test_meshio_knows_all_kinds_of_cells(bar, tmp_path, kind):
    meshio = pytest.importorskip("meshio", reason="meshio is not installed")
    plane = kind[:3] in ("tri", "qua")
    bar["mesh"] = {"box": {"size": [1, 0.3, 0.3][: 2 if plane else 3], "cells": [1, 1, 1][: 2 if plane else 3], "element": kind}}
    bar["supports"][0]["fix"] = ["x", "y"] if plane else ["x", "y", "z"]
    bar["controls"][0]["start"] = "-10 kPa"
    bar["probes"] = []
    own, file = bar.solve(out=tmp_path, report=False).to_meshio(), meshio.read(tmp_path / "start.vtu")
    assert [block.type for block in own.cells] == [block.type for block in file.cells]
    assert np.array_equal(own.cells[0].data, file.cells[0].data)


def test_pyvista_gets_all_fields(bar):
    pytest.importorskip("pyvista", reason="pyvista is not installed")
    found = bar.solve()
    grid = found.to_pyvista()
    assert grid.n_cells == 8 and grid.n_points == 30
    assert np.array_equal(grid.point_data["displacement"], found.displacement)
    assert grid.volume == pytest.approx(0.0625)


@pytest.mark.parametrize("package", ["meshio", "pyvista"])
def test_a_package_that_is_missing_is_named(bar, package, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, package, None)
    with pytest.raises(ImportError, match=f"pip install {package}"):
        getattr(bar.solve(), f"to_{package}")()
