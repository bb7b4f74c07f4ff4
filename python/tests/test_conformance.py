"""Known answers put to engines: the same numbers as the program, and rows for what goes wrong."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import cohaul
from cohaul.engines import Engine

ROOT = Path(os.environ["COHAUL_ROOT"])
PINS = ROOT / "crates/engines/examples/pins.py"

sys.path.append(str(PINS.parent))
from pins import Pins  # noqa: E402


class NoWalls(Engine):
    """A load that never moves, in scenes without obstacles."""

    name = "no walls"

    def start(self, scene, longest_step_s):
        if scene["obstacles"]:
            raise NotImplementedError("obstacles")
        if not scene["springs"] and scene["twist"][2] == 40.0:
            self.pose = None
        else:
            self.pose = scene["pose"]

    def advance(self, tips_m, obstacles, duration_s, n_steps):
        return {"pose": self.pose}


def test_the_table_is_that_of_the_program():
    found = cohaul.conformance("inertial")
    command = [os.environ["COHAUL"], "conformance", "--engine", "inertial", "--json"]
    assert dict(found) == json.loads(subprocess.run(command, capture_output=True, check=True).stdout)
    assert found.grades["C1"] == "to 1 %" and found["counts"]["failed"] == 0
    assert found.line in " ".join(found.text.split()) and "# Conformance of inertial" in found.markdown
    assert found.html.startswith("<!DOCTYPE html>") and "<td>C1 slide</td>" in found._repr_html_()


def test_friction_at_pins_points_elsewhere_at_every_step():
    """Each support opposes K^-1 v and not v: 62.1 deg in place of 45 deg."""
    for step_s in (1e-3, 5e-4):
        tests = {test["key"]: test for test in cohaul.conformance(Pins, step_s=step_s)["tests"]}
        direction = tests["C4"]["measures"][0]
        assert direction["found"] == pytest.approx(1.0839, abs=5e-3), direction
        assert tests["C4"]["grade"] == "beyond"


def test_refusals_and_faults_are_rows():
    found = cohaul.conformance(NoWalls)
    tests = {test["key"]: test for test in found["tests"]}
    assert {key for key, test in tests.items() if test["outcome"] == "refused"} == {"C10a", "C10b", "C11a", "C11b"}
    assert tests["C10a"]["why"] == "obstacles"
    assert [key for key, test in tests.items() if test["outcome"] == "failed"] == ["C2"]
    assert tests["C3"]["grade"] == "exact" and tests["C1"]["grade"] == "beyond"
    # What never moves is the same in every scene, and right about nothing but that it holds.
    assert {tests[key]["grade"] for key in ("C8", "C9", "C13", "C14")} == {"beyond"}


def test_an_engine_that_refuses_every_scene_has_a_table():
    found = cohaul.conformance(Engine)
    assert found["engine"]["name"] == "engine" and found["counts"]["refused"] == found["counts"]["all"] == 18


def test_wrong_questions_are_refused():
    with pytest.raises(ValueError, match="step_s: must be from 1e-5 to 0.01, found 1"):
        cohaul.conformance(step_s=1.0)
    with pytest.raises(TypeError, match="engine: must be a name, or a class"):
        cohaul.conformance(3)
    with pytest.raises(ValueError, match="engine: "):
        cohaul.conformance("no such engine")
