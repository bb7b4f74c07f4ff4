"""Python gives the numbers of the program, to the bit."""

from __future__ import annotations

import csv
import json
import subprocess
from pathlib import Path

import numpy as np
import pytest
from conftest import PROGRAM, SCENES

import cohaul

ALL = sorted(SCENES.glob("*/*.json"))
# Longest run in the short test (s): enough for grasps, releases, jumps and contacts.
SHORT_S = 0.2


def program(*arguments: object) -> str:
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode in (0, 1), done.stderr
    return done.stdout


def without_time(results: dict) -> dict:
    return {name: value for name, value in results.items() if name != "wall_s"}


@pytest.mark.parametrize("path", ALL, ids=lambda path: path.stem)
def test_runs_equal_those_of_the_program(path: Path, tmp_path: Path, request: pytest.FixtureRequest) -> None:
    scenario = cohaul.Scenario(path)
    if not request.config.getoption("--all-scenes"):
        scenario = scenario.replace(duration_s=min(scenario.duration_s, SHORT_S))
    file = tmp_path / path.name
    scenario.save(file)
    for backend in cohaul.BACKENDS:
        run = cohaul.run(file, backend)
        expected = json.loads(program("run", file, "--backend", backend, "--json"))
        assert without_time(run.results) == without_time(expected), backend


def test_default_steps_become_shorter_where_springs_are_stretched() -> None:
    """This scene has springs that no default step resolves, later than the short test looks."""
    file = SCENES / "stress" / "stiff-light.json"
    steps = cohaul.run(file, "inertial").results["steps"]
    assert steps["unresolved_rad"] > 1.0
    assert steps == json.loads(program("run", file, "--backend", "inertial", "--json"))["steps"]


def test_the_trace_equals_that_of_the_program(four_ants: Path, tmp_path: Path) -> None:
    file = tmp_path / "four.json"
    cohaul.Scenario(four_ants, duration_s=5.0).save(file)
    out = tmp_path / "out"
    program("run", file, "--backend", "inertial", "--out", out, "--full-trace")
    run = cohaul.run(file, "inertial")
    with open(out / "trace.csv") as table:
        rows = list(csv.DictReader(table))
    columns = run.trace._flat()
    shared = [name for name in rows[0] if name in columns]
    assert len(shared) == 7 + 6 + 1 + 8
    for name in shared:
        expected = np.array([float(row[name]) if row[name] else np.nan for row in rows])
        assert np.array_equal(columns[name], expected, equal_nan=True), name
    with open(out / "events.csv") as table:
        expected_events = [(float(row["time_s"]), row["event"], int(row["spring"]), int(row["ant"])) for row in csv.DictReader(table)]
    assert [(event.time_s, event.kind, event.spring, event.ant) for event in run.events] == expected_events


def test_a_comparison_equals_that_of_the_program() -> None:
    file = SCENES / "analytic/release-jump.json"
    expected = json.loads(program("compare", file, "--json"))
    assert without_time(cohaul.compare(file).results) == without_time(expected)


def test_a_sweep_equals_that_of_the_program(four_ants: Path, tmp_path: Path) -> None:
    out = tmp_path / "sweep"
    varied = ["--vary", "duration_s=2", "--vary", "load.mass_kg=0.0008,0.0016"]
    program("sweep", four_ants, *varied, "--seeds", 3, "--backend", "quasi-static", "--backend", "inertial", "--out", out)
    vary = {"duration_s": [2], "load.mass_kg": [0.0008, 0.0016]}
    table = cohaul.sweep(four_ants, vary, seeds=3, backend=["quasi-static", "inertial"])
    assert table.csv == (out / "runs.csv").read_text()
    assert table.n_rows == 12 and table["seed"].tolist()[:3] == [1, 2, 3]


def test_error_control_and_options_reach_the_library(tmp_path: Path) -> None:
    file = SCENES / "analytic/ramp-and-hold.json"
    for options, arguments in [
        ({"tolerance_m": 1e-6}, ["--tolerance", "1e-6"]),
        ({"step_s": 1e-4, "second_order": True}, ["--step-s", "1e-4", "--second-order"]),
        ({"step_s": 1e-4, "backend": "inertial", "integrator": "euler"}, ["--step-s", "1e-4", "--backend", "inertial", "--integrator", "euler"]),
        ({"backend": "rapier", "rapier": {"springs": "force", "friction": "box"}}, ["--backend", "rapier", "--springs", "force", "--friction", "box"]),
    ]:
        expected = json.loads(program("run", file, *arguments, "--json"))
        assert without_time(cohaul.run(file, **options).results) == without_time(expected), options
