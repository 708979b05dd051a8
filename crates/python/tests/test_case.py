"""Cases as dictionaries, and the errors they give."""

import copy
import json
import pickle

import nastic
import numpy as np
import pytest
from conftest import ROOT


def test_a_file_is_read_as_a_dictionary():
    case = nastic.load(ROOT / "examples/cases/cantilever_arc.json")
    assert isinstance(case, dict) and case["nastic"] == 1
    case["optimizer"]["max_iterations"] = 5
    assert case["optimizer"]["max_iterations"] == 5
    assert case.directory == ROOT / "examples/cases" and case.name == "cantilever_arc.json"
    assert json.loads(json.dumps(case))["mesh"] == case["mesh"]


def test_names_of_files_count_from_the_directory_of_the_case(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    checked = nastic.load(ROOT / "examples/cases/cantilever_arc.json").check()
    assert checked.result["valid"] is True
    assert checked.states == {} and checked.controls == {}
    assert "the case is complete and consistent" in checked.log
    assert list(tmp_path.iterdir()) == []


def test_copies_and_pickles_are_cases_of_their_own(bar):
    for other in (bar.copy(), copy.copy(bar), copy.deepcopy(bar), pickle.loads(pickle.dumps(bar))):
        assert type(other) is nastic.Case and other == bar
        assert (other.directory, other.name) == (bar.directory, bar.name)
        other["optimizer"]["max_iterations"] = 7
        assert bar["optimizer"]["max_iterations"] == 40


def test_all_problems_of_a_case_are_told(bar):
    bar["supports"][0]["fix"] = ["w"]
    bar["materials"][0]["yuong"] = 1
    with pytest.raises(nastic.CaseError) as caught:
        bar.solve()
    error = caught.value
    assert isinstance(error, nastic.Error) and isinstance(error, ValueError)
    assert {problem["path"] for problem in error.problems} == {"supports/0/fix/0", "materials/0/yuong"}
    assert all(problem["file"] == "bar" and problem["line"] is None for problem in error.problems)
    assert 'did you mean "young"' in str(error)
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is nastic.CaseError and str(again) == str(error) and again.problems == error.problems


def test_problems_of_a_file_have_lines(tmp_path):
    file = tmp_path / "twice.json"
    file.write_text('{\n  "nastic": 1,\n  "nastic": 1\n}')
    with pytest.raises(nastic.CaseError, match="given before, in line 2") as caught:
        nastic.load(file)
    assert caught.value.problems[0]["line"] == 3
    with pytest.raises(nastic.CaseError, match="cannot be read"):
        nastic.load(tmp_path / "missing.json")


def test_what_json_does_not_know_is_refused_by_name(bar):
    bar["optimizer"]["tolerance"] = np.float32(0.5)
    bar["probes"][0]["point"] = np.array([1.0, 0.25, 0.25])
    bar.check()
    bar["title"] = object()
    with pytest.raises(nastic.CaseError, match="no object"):
        bar.check()
    bar["title"] = float("nan")
    with pytest.raises(nastic.CaseError, match="bar: .*JSON"):
        bar.check()


def hopeless(case):
    """A tension far beyond what the law bears."""
    case["controls"][0] = {"of": "tension", "space": "cell", "start": "100 MPa", "upper": "1 GPa"}


def test_a_failed_solve_says_what_it_knows(bar):
    hopeless(bar)
    with pytest.raises(nastic.SolveError) as caught:
        bar.solve()
    assert caught.value.kind in ("no_convergence", "inverted")
    assert caught.value.member == "" and caught.value.file is None and caught.value.result is None


def test_a_failed_solve_leaves_its_last_state_where_files_are_wanted(bar, tmp_path):
    hopeless(bar)
    with pytest.raises(nastic.SolveError) as caught:
        bar.solve(out=tmp_path / "out")
    assert caught.value.file == str(tmp_path / "out" / "failure.vtu")
    assert (tmp_path / "out" / "failure.vtu").is_file()


def test_a_failed_member_is_named(two_loads):
    hopeless(two_loads)
    with pytest.raises(nastic.SolveError, match="soft") as caught:
        two_loads.solve()
    assert caught.value.member == "soft"


def test_a_wrong_gradient_is_an_error_with_the_result(bar):
    # The target's distance has a kink where body and target are the same points.
    bar["controls"][0].update(start=0)
    bar["costs"] = [
        {
            "kind": "smoothed_hausdorff",
            "target": bar["mesh"],
            "phi": {"exponential": {"length": 0.1}},
            "stages": [{"alpha": 1, "beta": 4, "gamma": 4}],
        }
    ]
    with pytest.raises(nastic.GradientError, match="mismatch") as caught:
        bar.gradient()
    assert caught.value.result.result["gradient_check"]["verdict"] == "WRONG"


def test_a_directory_that_cannot_be_written_is_an_output_error(bar, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(nastic.OutputError) as caught:
        bar.solve(out=tmp_path / "file")
    assert isinstance(caught.value, OSError) and "file" in str(caught.value)


def test_threads_change_nothing_and_must_exist(bar):
    one, two = bar.solve(threads=1), bar.solve(threads=2)
    assert np.array_equal(one.displacement, two.displacement)
    assert one.result["threads"] == 1


def test_the_schema_is_that_of_cases():
    assert "materials" in nastic.schema()["properties"]
