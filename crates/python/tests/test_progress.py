"""How far commands are: callbacks and bars."""

import sys
import types

import nastic
import pytest


@pytest.fixture
def motion(bar: nastic.Case) -> nastic.Case:
    """The bar in twenty steps of a motion."""
    bar["materials"][0]["density"] = "1000 kg/m^3"
    bar["time"] = {"end": "0.2 s", "step": "0.01 s", "scheme": "backward_euler"}
    bar["controls"] = [{"of": "tension", "space": "uniform", "start": "-50 kPa", "lower": "-100 kPa", "upper": 0}]
    bar["costs"] = [{"kind": "position", "surface": "x+", "target": {"x": 0.9}}]
    return bar


class Bar:
    """What nastic calls of tqdm, written down."""

    made: list["Bar"] = []

    def __init__(self, total, desc, unit, leave):
        self.total, self.desc, self.unit, self.n, self.shown, self.closed = total, desc, unit, 0, [], False
        Bar.made.append(self)

    def set_postfix_str(self, text, refresh):
        self.shown.append((self.n, text))

    def refresh(self):
        pass

    def close(self):
        self.closed = True


@pytest.fixture
def tqdm(monkeypatch):
    auto = types.ModuleType("tqdm.auto")
    auto.tqdm = Bar
    monkeypatch.setitem(sys.modules, "tqdm", types.ModuleType("tqdm"))
    monkeypatch.setitem(sys.modules, "tqdm.auto", auto)
    Bar.made = []
    return Bar.made


def test_a_motion_tells_every_step(motion):
    told = []
    result = motion.solve(callback=told.append)
    assert result.result["time"]["steps"] == 20
    assert told[0]["phase"] and told[0]["seconds"] >= 0
    steps = [one for one in told if "step" in one]
    assert {one["phase"] for one in steps} == {"motion"} and {one["steps"] for one in steps} == {20}
    assert sorted({one["step"] for one in steps}) == list(range(20)), "each is told, in its order"
    assert [one["step"] for one in steps] == sorted(one["step"] for one in steps)
    assert steps[0]["end"] == pytest.approx(0.2) and steps[9]["time"] <= 0.2
    assert all(a["seconds"] <= b["seconds"] for a, b in zip(told, told[1:]))


def test_an_exception_in_the_callback_ends_the_command(motion):
    def stop(standing):
        if standing.get("step") == 3:
            raise ValueError("enough")

    with pytest.raises(ValueError, match="enough"):
        motion.solve(callback=stop)


def test_a_bar_has_the_steps_of_a_motion_and_the_iterations_of_an_optimisation(motion, bar, tqdm):
    motion.solve(progress=True)
    steps = [one for one in tqdm if one.total == 20]
    assert len(steps) == 1 and steps[0].desc == "motion" and steps[0].shown[-1][0] == 19
    assert any("t = " in text and "of 0.2" in text for _, text in steps[0].shown)
    assert all(one.closed for one in tqdm)


def test_an_optimisation_has_a_bar_of_iterations(bar, tqdm):
    result = bar.optimize(progress=True)
    run = [one for one in tqdm if one.desc == "optimize"]
    assert len(run) == 1 and run[0].total == 40
    assert run[0].shown[-1][0] >= len([line for line in result.history if line["accepted"]]) - 2
    assert any("cost " in text for _, text in run[0].shown)


def test_there_is_no_bar_without_a_terminal_and_none_that_cannot_be_drawn(bar, tqdm, monkeypatch):
    bar.solve()
    assert tqdm == []
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    bar.solve()
    assert tqdm != []
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    bar.solve()  # where nobody asked, nothing is missed
    with pytest.raises(nastic.CaseError, match="pip install tqdm"):
        bar.solve(progress=True)
