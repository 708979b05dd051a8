"""Meshes from arrays."""

import copy
import json
import pickle

import nastic
import numpy as np
import pytest


@pytest.fixture
def plain(bar):
    """The bar without a mesh, for one of a user's own."""
    bar["mesh"] = None
    bar["supports"][0]["surface"] = "clamp"
    bar["costs"][0]["surface"] = "tip"
    del bar["probes"]
    return bar


def make(box, **more):
    points, cells = box
    given = {"surfaces": {"clamp": points[:, 0] == 0, "tip": points[:, 0] == 1}, **more}
    return nastic.Mesh(points, cells={"hex8": cells}, **given)


def test_arrays_make_the_mesh_of_a_case(plain, box):
    plain["mesh"] = make(box)
    found = plain.solve()
    assert np.array_equal(found.points, box[0]) and np.array_equal(found.cells["hex8"], box[1])
    boxed = plain.copy()
    boxed["mesh"] = {"box": {"size": [1, 0.2, 0.2], "cells": [3, 1, 1], "element": "hex8"}}
    boxed["supports"][0]["surface"], boxed["costs"][0]["surface"] = "x-", "x+"
    other = boxed.solve()
    assert found.result["cost"]["total"] == pytest.approx(other.result["cost"]["total"], rel=1e-10)


def test_surfaces_may_be_lists_of_facets(plain, box):
    points, _ = box
    facets = np.array([[12, 14, 15, 13]])
    mesh = make(box, surfaces={"clamp": np.flatnonzero(points[:, 0] == 0), "tip": facets})
    assert np.array_equal(mesh.surfaces["tip"], make(box).surfaces["tip"]) and len(mesh.surfaces["tip"]) == 1
    plain["mesh"] = mesh
    assert plain.solve().result["cost"]["total"] > 0


def test_regions_have_laws_of_their_own(plain, box):
    plain["mesh"] = make(box, regions={"root": [0], "rest": np.array([False, True, True])})
    assert plain["mesh"].regions["rest"].tolist() == [1, 2]
    plain["materials"] = [
        {"region": "root", "law": "neo_hooke", "young": "3 MPa", "poisson": 0.3},
        {"region": "rest", "law": "neo_hooke", "young": "300 kPa", "poisson": 0.3},
    ]
    plain["actuation"][0]["region"] = "rest"
    found = plain.solve()
    assert found.states[""].regions["root"].tolist() == [0]
    assert found.controls["tension"].shape == (2,)


def test_node_sets_and_plane_meshes(plain):
    points = np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]])
    mesh = nastic.Mesh(
        points, {"tri3": [[0, 1, 2], [0, 2, 3]]}, surfaces={"clamp": points[:, 0] == 0}, nodes={"corner": [2]}
    )
    assert mesh.nodes["corner"].tolist() == [2] and mesh.points.shape == (4, 3)
    plain["mesh"] = mesh
    plain["supports"][0]["fix"] = ["x", "y"]
    plain["actuation"][0]["direction"] = [1, 0]
    plain["controls"][0]["start"] = "-10 kPa"
    plain["costs"] = [{"kind": "tracking", "nodes": "corner", "target": ["X", "Y + 0.1"]}]
    assert plain.gradient().gradient["tension"].shape == (2,)


def test_a_mesh_may_be_a_target(plain, box):
    plain["mesh"] = make(box)
    plain["costs"] = [
        {
            "kind": "smoothed_hausdorff",
            "target": nastic.Mesh(box[0] * [1, 1, 0.9], {"hex8": box[1]}, name="flatter"),
            "phi": {"exponential": {"length": 0.1}},
            "stages": [{"alpha": 1, "beta": 4, "gamma": 4}],
        }
    ]
    assert plain.solve().result["hausdorff"]["true"] > 0


def test_the_hash_of_a_case_knows_its_mesh(plain, box):
    plain["mesh"] = make(box)
    same = plain.copy()
    same["mesh"] = make(box)
    other = plain.copy()
    other["mesh"] = make((box[0] * 1.1, box[1]), surfaces={"clamp": box[0][:, 0] == 0, "tip": box[0][:, 0] == 1})
    hashes = [case.solve().result["case_hash"] for case in (plain, same, other)]
    assert hashes[0] == hashes[1] != hashes[2]


def test_meshes_are_values(box):
    mesh = make(box, regions={"all": range(3)}, nodes={"corner": [0]})
    again = pickle.loads(pickle.dumps(mesh))
    assert again._key == mesh._key and again.name == mesh.name
    assert np.array_equal(again.surfaces["tip"], mesh.surfaces["tip"])
    assert copy.deepcopy(mesh) is mesh
    with pytest.raises(ValueError):
        mesh.points[0, 0] = 1
    assert "3 hex8" in repr(mesh) and "tip" in repr(mesh)


def test_what_a_run_writes_reads_as_the_mesh_again(plain, box, tmp_path):
    plain["mesh"] = make(box)
    first = plain.solve(out=tmp_path)
    plain["mesh"] = tmp_path / "start.vtu"
    assert np.allclose(plain.solve().displacement, first.displacement, rtol=0, atol=1e-12)
    assert json.loads((tmp_path / "case.json").read_text())["mesh"].startswith("arrays:")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (dict(cells={"hex9": [[0]]}), "no kind of cell"),
        (dict(cells={"hex8": [[0, 1, 2]]}), "have 8 nodes, found 3"),
        (dict(cells={"hex8": [[0, 1, 2, 3, 4, 5, 6, 99]]}), "no node 99"),
        (dict(cells={"hex8": [[-1, 1, 2, 3, 4, 5, 6, 7]]}), "no node -1"),
        (dict(cells={"hex8": [[0.5, 1, 2, 3, 4, 5, 6, 7]]}), "numbers of type int64"),
        (dict(cells={}), "needs cells"),
        (dict(points=np.zeros((4, 4))), "2 or 3 coordinates, found 4"),
        (dict(points=np.zeros(4)), "2 dimensions"),
        (dict(regions={"a": [3]}), 'region "a": there is no cell 3'),
        (dict(regions={"a": [True, False]}), "one entry for each of 3"),
        (dict(surfaces={"a": [[0, 1, 2, 7]]}), "a"),
        (dict(surfaces={"a": [[0, 1]]}), "no facet in 3 dimensions has 2 nodes"),
        (dict(surfaces={"a": [0, 1]}), "no facet of the boundary has all its nodes"),
        (dict(nodes={"a": [100]}), "no node 100"),
    ],
)
def test_arrays_that_make_no_mesh_are_refused(box, change, message):
    given = {"points": box[0], "cells": {"hex8": box[1]}, **change}
    with pytest.raises(nastic.CaseError, match=message):
        nastic.Mesh(**given)


def test_names_that_a_mesh_lacks_are_told_with_its_name(plain, box):
    plain["mesh"] = make(box)
    plain["supports"][0]["surface"] = "clmp"
    with pytest.raises(nastic.CaseError, match='surface "clmp" not found in mesh.*clamp'):
        plain.check()
    plain["mesh"] = {"file": make(box), "scale": 1e-3}
    with pytest.raises(nastic.CaseError, match="multiply its points"):
        plain.check()
