"""Maps, thresholds, baselines and recorded paths: those of the program."""

from __future__ import annotations

import json
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import SCENES
from test_numbers import program, without_time

import cohaul

JUMP, PULL, PUSHER = SCENES / "analytic/release-jump.json", SCENES / "analytic/centre-pull.json", SCENES / "contact/pusher.json"


def test_a_map_equals_that_of_the_program(tmp_path: Path) -> None:
    asked = ["compare", JUMP, "--vary", "load.mass_kg=log:1e-4:1:4", "--vary", "speed=0.5,2"]
    expected = json.loads(program(*asked, "--json"))
    found = cohaul.compare_map(JUMP, {"load.mass_kg": "log:1e-4:1:4", "speed": [0.5, 2]})
    assert without_time(found.results) == without_time(expected)
    assert found.shares().shape == (4, 2) and [len(axis) for axis in found.axes] == [4, 2]
    # The corners are compared in full.
    assert np.isfinite(found.shares("pulls")[[0, 0, -1, -1], [0, -1, 0, -1]]).all()
    found.save(tmp_path / "map")
    assert (tmp_path / "map/map.csv").exists() and "<svg" in found.figure() and "<svg" in found._repr_html_()
    assert found.to_pandas()["load.mass_kg"].nunique() == 4 and found.report().startswith("<!DOCTYPE html>")
    again = pickle.loads(pickle.dumps(found))
    assert again.text == found.text and again.results == found.results and again.report() == found.report()
    everywhere = cohaul.compare_map(JUMP, {"load.mass_kg": [1e-4, 1e-3, 1e-2]}, everywhere=True)
    assert everywhere["n_compared"] == 3 > cohaul.compare_map(JUMP, {"load.mass_kg": [1e-4, 1e-3, 1e-2]})["n_compared"]


def test_faster_tips_have_the_larger_share() -> None:
    found = cohaul.compare_map(PULL, {"speed": [0.5, 4.0]})
    slow, fast = found.shares()
    assert 0.0 < slow < 1.0 < fast and found.axes[0].tolist() == [0.5, 4.0]
    assert found.shares("path")[1] == found["cells"][1]["compared"][0]["inertia_effect"] / found["cells"][1]["compared"][0]["tolerance"]


def test_a_threshold_equals_that_of_the_program(tmp_path: Path) -> None:
    for scene, path, limits, text in [(JUMP, "speed", (0.5, 2.0, 3), "speed=0.5:2:3"), (PUSHER, "inertia", (0.5, 2.0, 3), "inertia=0.5:2:3")]:
        expected = json.loads(program("compare", scene, "--threshold", text, "--json"))
        found = cohaul.threshold(scene, path, limits)
        assert without_time(found.results) == without_time(expected)
    first = cohaul.threshold(PULL, "speed", (0.8, 3.0, 2), tolerance_m=1e-6)
    valid, not_valid = first.bands("path")
    assert (valid["class"], not_valid["class"]) == ("valid", "not_valid") and valid["to"] == not_valid["from"]
    low, high = valid["to"]["range"]
    assert low <= valid["to"]["value"] <= high < 1.02 * low and not valid["to"]["is_end"]
    # On both sides of the boundary a map says the same.
    assert [share < 1.0 for share in cohaul.compare_map(PULL, {"speed": [0.95 * low, 1.05 * high]}).shares()] == [True, False]
    first.save(tmp_path / "threshold")
    assert (tmp_path / "threshold/points.csv").exists() and first.to_pandas().shape[0] == len(first["points"])
    assert pickle.loads(pickle.dumps(first)).results == first.results


@pytest.mark.parametrize(
    ("call", "rule"),
    [
        (lambda: cohaul.compare_map(JUMP, {}), "vary: must have one parameter or two, found 0"),
        (lambda: cohaul.compare_map(JUMP, {"no.such": [1.0]}), "no.such"),
        (lambda: cohaul.compare_map(JUMP, {"load.mass_kg": []}), "must have at least one value"),
        (lambda: cohaul.threshold(JUMP, "speed=1"), "parameter: must be a factor or a key"),
        (lambda: cohaul.threshold(JUMP, "speed", (2.0, 1.0)), "must"),
        (lambda: cohaul.threshold(JUMP, "speed", (1.0,)), "limits: must be two numbers"),  # type: ignore[arg-type]
        (lambda: cohaul.threshold(JUMP, "speed", (0.5, 2.0, 3)).bands("contacts"), "quantity: must be one of"),
        (lambda: cohaul.check("no/such/folder"), "no/such/folder: cannot be listed"),
        (lambda: cohaul.check(".", "../x"), "name: must be that of a file without its folder"),
        (lambda: cohaul.check(".", scenario=JUMP), "scenario: must come with names"),
        (lambda: cohaul.compare(JUMP, beside=3), "beside: must be a CSV file"),
    ],
)
def test_wrong_arguments_are_refused(call: Any, rule: str) -> None:
    with pytest.raises((ValueError, TypeError), match=rule):
        call()


def test_baselines_are_those_of_the_program(tmp_path: Path) -> None:
    stored = cohaul.store_baseline(JUMP, tmp_path / "python", "rapier", rows=50)
    program("check", "store", JUMP, "--baselines", tmp_path / "program", "--backend", "rapier", "--rows", 50)
    assert stored.name == "release-jump-rapier.json"
    one, other = (json.loads(path.read_text()) for path in (stored, tmp_path / "program" / stored.name))
    # The commits of library and program may differ, where one was built before the other.
    assert {**one, "build": None} == {**other, "build": None} and one["build"].keys() == other["build"].keys()
    with pytest.raises(FileExistsError, match="replace=True"):
        cohaul.store_baseline(JUMP, tmp_path / "python", "rapier")
    found = cohaul.check(tmp_path / "python")
    assert found and found["n_agree"] == 1 and found.baselines[0]["is_exact"] and found.answer == "All agree."
    heavier = cohaul.Scenario(JUMP).replace({"load.mass_kg": 0.002})
    changed = cohaul.check(tmp_path / "python", "release-jump-rapier", scenario=heavier)
    expected = json.loads(program("check", tmp_path / "python", "release-jump-rapier", "--scenario", saved(heavier, tmp_path), "--json"))
    assert not changed and without_time(changed.results) == without_time(expected)
    assert changed.baselines[0]["first_divergence"] is not None and "differs" in changed.text
    changed.save(tmp_path / "out")
    assert (tmp_path / "out/difference-release-jump-rapier.svg").exists()
    assert pickle.loads(pickle.dumps(changed)).text == changed.text
    assert cohaul.check(tmp_path / "python", "release-jump-rapier", scenario=heavier, accept=True)
    assert cohaul.check(tmp_path / "python").baselines[0]["scenario_changes"] == []


def saved(scenario: cohaul.Scenario, folder: Path) -> Path:
    scenario.save(folder / "scene.json")
    return folder / "scene.json"


def test_a_recorded_path_lies_beside_the_others(tmp_path: Path) -> None:
    run = cohaul.run(JUMP, "inertial", step_s=1e-3)
    run.to_pandas()[["time_s", "x_m", "y_m", "heading_rad"]].to_csv(tmp_path / "path.csv", index=False)
    expected = json.loads(program("compare", JUMP, "--beside", tmp_path / "path.csv", "--json"))["beside"]
    found = cohaul.compare(JUMP, beside=tmp_path / "path.csv")["beside"]
    assert found["differences"] == expected["differences"] and found["n"] == run.trace.n_rows
    for other in (run.trace, run.to_pandas(), run.to_polars()):
        assert cohaul.compare(JUMP, beside=other)["beside"]["differences"] == expected["differences"]
    by_name = {difference["backend"]: difference["position_max_m"] for difference in found["differences"]}
    assert by_name["inertial"] < by_name["quasi-static"]
