"""Engines of one's own: the same numbers in the interpreter and behind a pipe, and named faults."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import cohaul
from cohaul.engines import Engine

ROOT = Path(os.environ["COHAUL_ROOT"])
PINS = ROOT / "crates/engines/examples/pins.py"
SCENES = ["analytic/ramp-and-hold", "analytic/slide-spin", "analytic/release-jump", "paper/four-tips-prescribed"]

sys.path.append(str(PINS.parent))
from pins import AlongSlip, Pins  # noqa: E402


class Still(Engine):
    """A load that never moves."""

    name = "still"

    def start(self, scene, longest_step_s):
        self.pose = scene["pose"]

    def advance(self, tips_m, obstacles, duration_s, n_steps):
        return {"pose": self.pose}


@pytest.mark.parametrize("scene", SCENES)
def test_the_pipe_gives_the_same_bits(scene):
    path = ROOT / f"scenarios/{scene}.json"
    found = dict(cohaul.compare(path, engine=Pins))
    command = [os.environ["COHAUL"], "compare", str(path), "--json", "--engine", f"{sys.executable} {PINS}"]
    piped = json.loads(subprocess.run(command, capture_output=True, check=True).stdout)
    found.pop("wall_s"), piped.pop("wall_s")
    assert found == piped
    assert found["tiers"]["prescribed"]["engine"] == {"name": "pins", "version": "1"}
    assert "rapier" not in found["answer"]


def test_friction_at_pins_errs_by_its_model():
    """Each support opposes K^-1 v and not v, whatever the step."""
    found = cohaul.compare(ROOT / "scenarios/analytic/ramp-and-hold.json", engine=Pins)
    path = found.verdicts["path"]
    assert "engine model" in path["causes"] and path["engine"] == "not within", path


@pytest.mark.parametrize("scene", ["ramp-and-hold", "slide-spin"])
def test_friction_along_the_slip_errs_by_its_step_alone(scene):
    """The largest eigenvalue of K in place of K: 0.1 um of model error were found, and 7 mm before."""
    found = cohaul.compare(ROOT / f"scenarios/analytic/{scene}.json", engine=AlongSlip, step_s=1e-3)
    parts = found.verdicts["path"]["parts"]
    assert parts["engine_model"] < 1e-6 and parts["time_step"] > 1e-5, parts
    assert found.tiers["prescribed"]["engine"]["name"] == "pins (along the slip)"


def test_energy_of_a_released_spring_is_no_fault_of_an_engine():
    """The friction of 2.18 mJ is right to 1 %; the 2.27 mJ of the spring are not the engine's to know."""
    found = cohaul.compare(ROOT / "scenarios/analytic/release-jump.json", engine=AlongSlip, step_s=1e-3)
    assert found.verdicts["energy"]["engine"] == "within", found.verdicts["energy"]


def test_engines_side_by_side_are_judged_as_each_alone():
    scene = ROOT / "scenarios/analytic/slide-spin.json"
    command = f"{sys.executable} {PINS} --along-slip"
    found = cohaul.compare(scene, engine=[Pins, "rapier", command])
    others = {each["engine"]["name"]: each for each in found.other_engines}
    assert found.tiers["prescribed"]["engine"]["name"] == "pins" and list(others) == ["rapier", "pins (along the slip)"]
    for alone in (cohaul.compare(scene), cohaul.compare(scene, engine=AlongSlip)):
        alone = alone.tiers["prescribed"]
        assert others[alone["engine"]["name"]]["verdicts"] == alone["verdicts"]
    assert [len(found.trace(name)["x_m"]) for name in ("inertial", "pins", "rapier")] == [101] * 3
    assert "pins (along the slip)" in found.overview() and "engines side by side" in found.report()
    assert found._repr_html_().count("<table>") == 3


def test_what_an_engine_leaves_out_has_no_numbers():
    found = cohaul.compare(ROOT / "scenarios/analytic/ramp-and-hold.json", engine=Still)
    assert "measures" not in found.verdicts["energy"] and "measures" not in found.verdicts["speed"]
    assert found.verdicts["path"]["engine_error"] > 0.01
    assert list(found.trace("still")["x_m"]) == [0.0] * len(found.trace("still")["x_m"])
    with pytest.raises(ValueError, match="must be one that was compared"):
        found.trace("rapier")


def test_numpy_may_be_answered():
    class Arrays(Still):
        def advance(self, tips_m, obstacles, duration_s, n_steps):
            return {"pose": np.array(self.pose), "twist": np.zeros(3), "dissipated_j": np.float64(0.0)}

    assert cohaul.compare(ROOT / "scenarios/analytic/ramp-and-hold.json", engine=Arrays).verdicts["energy"]["measures"]


@pytest.mark.parametrize(
    "advance, error, says",
    [
        (lambda self, *a, **k: 1 / 0, ZeroDivisionError, "division by zero"),
        (lambda self, *a, **k: {"pose": [float("nan"), 0, 0]}, ValueError, "JSON"),
        (lambda self, *a, **k: {"pose": [0, 0]}, ValueError, "invalid length 2"),
        (lambda self, *a, **k: {}, ValueError, "missing field `pose`"),
        (lambda self, *a, **k: None, TypeError, "not iterable"),
        (lambda self, *a, **k: {"pose": [0, 0, 6.28]}, ValueError, "heading that is not wrapped"),
        (lambda self, *a, **k: {"pose": "far"}, ValueError, "invalid type: string"),
        (lambda self, *a, **k: {"pose": self.wrench([0.0], [0.0], 0.5)}, ValueError, "a sequence of length 3"),
    ],
)
def test_what_is_wrong_with_an_engine_is_raised(advance, error, says):
    wrong = type("Wrong", (Still,), {"advance": advance})
    with pytest.raises(error, match=says):
        cohaul.compare(ROOT / "scenarios/analytic/ramp-and-hold.json", engine=wrong)


def test_engines_that_do_not_start_are_refused():
    scene = ROOT / "scenarios/analytic/ramp-and-hold.json"
    with pytest.raises(NotImplementedError):
        cohaul.compare(scene, engine=Engine)
    with pytest.raises(TypeError, match="engine: must be a class"):
        cohaul.compare(scene, engine=3)
    with pytest.raises(TypeError, match="engine: must be a class"):
        cohaul.compare(scene, engine=[Still, 3])
    with pytest.raises(ValueError, match="engine: start: must answer each request, found its end"):
        cohaul.compare(scene, engine="exit 3")
    with pytest.raises(ValueError, match="engine: must be engines of different names, found still twice"):
        cohaul.compare(scene, engine=[Still, Still])
    with pytest.raises(ValueError, match="rapier: must be left out"):
        cohaul.compare(scene, engine=Still, rapier={"friction": "box"})
    with pytest.raises(ValueError, match="name: must have 1 to 40 bytes"):
        cohaul.compare(scene, engine=type("Long", (Still,), {"name": "x" * 41}))
    with pytest.raises(ValueError, match="tiers: must be replayed"):
        cohaul.compare(ROOT / "scenarios/paper/four-ants-four-springs.json", engine=Still, tiers="closed-loop")


def test_an_engine_that_hangs_in_the_interpreter_is_ended(monkeypatch):
    def hang(self, *a, **k):
        while True:
            pass

    monkeypatch.setattr(cohaul.engines, "PATIENCE_S", 1.0)
    with pytest.raises(TimeoutError, match="must answer within 1.0 s"):
        cohaul.compare(ROOT / "scenarios/analytic/ramp-and-hold.json", engine=type("Hanging", (Still,), {"advance": hang}))


def test_an_engine_that_refuses_the_scene_is_a_row_among_others():
    def start(self, scene, longest_step_s):
        raise NotImplementedError("springs: has none")

    refusing = type("Refusing", (Still,), {"name": "refusing", "start": start})
    scene = ROOT / "scenarios/analytic/ramp-and-hold.json"
    found = cohaul.compare(scene, engine=[refusing, "rapier"])
    assert found.tiers["prescribed"]["verdicts"] == cohaul.compare(scene).tiers["prescribed"]["verdicts"]
    assert found.refused_by == [{"engine": {"name": "refusing"}, "why": "springs: has none"}]
    assert found.answer.endswith("refusing refuses the scene: springs: has none.")
    assert "Engines that refuse the scene" in found.report()
    with pytest.raises(NotImplementedError, match="refusing refuses the scene: springs: has none"):
        cohaul.compare(scene, engine=refusing)
