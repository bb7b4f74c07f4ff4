"""Scenarios from recordings and drawings, from Python as from the program."""

import json
import re
import subprocess

import pytest

import cohaul
from conftest import PROGRAM, ROOT

SAMPLES = ROOT / "examples" / "recordings"
ANTS = SAMPLES / "ants.json"


def of_program(*options):
    """Scenario and account of the program."""
    command = [str(PROGRAM), "scenario", "import", *map(str, options)]
    ran = subprocess.run([*command, "--quiet"], capture_output=True, text=True)
    told = subprocess.run([*command, "--json"], capture_output=True, text=True)
    assert ran.returncode == told.returncode == 0, ran.stderr
    return json.loads(ran.stdout), json.loads(told.stdout)


@pytest.mark.parametrize(
    ("file", "options", "keywords"),
    [
        ("table.csv", ["--fps", "50"], {"fps": 50}),
        (
            "deeplabcut.csv",
            ["--fps", "50", "--scale-m", "1e-4", "--min-confidence", "0.5", "--load", "rear", "front"],
            {"fps": 50, "scale_m": 1e-4, "min_confidence": 0.5, "load": ["rear", "front"]},
        ),
        ("t-block.svg", ["--name", "T"], {"name": "T"}),
        ("t-block.obj", ["--scale-m", "0.001", "--tolerance-m", "1e-5"], {"scale_m": 1e-3, "tolerance_m": 1e-5}),
    ],
)
def test_the_program_makes_the_same(file, options, keywords):
    found = cohaul.import_scenario(SAMPLES / file, ANTS, **keywords)
    written, account = of_program(SAMPLES / file, "--like", ANTS, *options)
    assert found.account["notes"] == account["notes"]
    assert found.scenario == cohaul.Scenario(written)


def test_tracks_and_frames_are_imported_again():
    found = cohaul.import_scenario(SAMPLES / "table.csv", ANTS, fps=50)

    class Frame:
        def to_csv(self, index):
            assert index is False
            return found.tracks_csv

    again = cohaul.import_scenario(Frame(), cohaul.Scenario(ANTS))
    assert again.tracks_csv == found.tracks_csv and again.tips_csv == found.tips_csv
    assert again.scenario.to_dict()["drive"] == found.scenario.to_dict()["drive"]
    assert "table" in str(found) and "table.csv" in repr(found)
    drawn = cohaul.import_scenario(SAMPLES / "t-block.svg", json.loads(ANTS.read_text()))
    assert drawn.tracks_csv is None and drawn.tips_csv is None


@pytest.mark.parametrize(
    ("options", "error", "rule"),
    [
        ({"like": None}, ValueError, "like: is required, the scenario with the ground and the springs"),
        ({"spring": {"two": 0}}, ValueError, "spring: must name a track of the recording"),
        ({"y": "left"}, ValueError, "y: must be 'up' or 'down', found 'left'"),
        ({"fps": -1}, ValueError, "fps: must be a positive finite number"),
        ({"format": "avi"}, ValueError, "format: must be one of table, deeplabcut"),
        ({"spring": {"1": -1}}, ValueError, "spring['1']: must be from 0 to 1000000000, found -1"),
        ({"spring": ["1"]}, TypeError, "spring: must be a dict by the names of tracks, found list"),
        ({"spring": {"1": "0"}}, TypeError, "spring['1']: must be a whole number, found str"),
        ({"obstacle": {"blue": 2}}, TypeError, "obstacle['blue']: must be text, found int"),
        ({"load": b"crate"}, TypeError, "load: must be the name of a track, or two of them"),
        ({"load": 5}, TypeError, "load: must be the name of a track, or two of them, found 5"),
        ({"origin_m": (0,)}, ValueError, "origin_m: must be two finite numbers (x, y), found (0,)"),
        ({"origin_m": 5}, ValueError, "origin_m: must be two finite numbers (x, y), found 5"),
        ({"name": "\ud800"}, ValueError, "name: must be text in Unicode"),
        ({"fps": 10**400}, ValueError, "fps: must be a positive finite number, found inf"),
        ({"y_up": "no"}, TypeError, "y_up: must be True or False, found str"),
        ({"min_confidence": 25}, ValueError, "min_confidence: must be from 0 to 1, found 25"),
        ({"body": "x"}, ValueError, "body: is for drawings, found a recording"),
        ({"files": SAMPLES / "t-block.svg"}, ValueError, "fps: is for recordings, found a drawing"),
        ({"files": None}, TypeError, "files: must be a path, a list of paths or a data frame, found NoneType"),
        ({"files": ""}, TypeError, "files: must be a path, found ''"),
        ({"duration_s": "long"}, TypeError, "duration_s: must be a number"),
        ({"files": SAMPLES / "none.csv"}, OSError, "none.csv"),
        ({"files": []}, ValueError, "must be at least one file"),
    ],
)
def test_wrong_arguments_are_refused(options, error, rule):
    options = {"files": SAMPLES / "table.csv", "like": ANTS, "fps": 50, **options}
    with pytest.raises(error, match=re.escape(rule)):
        cohaul.import_scenario(options.pop("files"), options.pop("like"), **options)


def test_frames_of_polars_dicts_and_numbers_of_numpy_are_taken():
    import numpy as np

    polars = pytest.importorskip("polars")
    found = cohaul.import_scenario(SAMPLES / "table.csv", ANTS, fps=50)
    frame = polars.read_csv(found.tracks_csv.encode())
    again = cohaul.import_scenario(frame, ANTS, spring={"0": np.int64(0), "1": np.int32(1)})
    assert again.scenario.to_dict()["drive"] == found.scenario.to_dict()["drive"]
    ring = [[0.0, 0.0], [0.2, 0.0], [0.2, 0.1], [0.0, 0.1], [0.0, 0.0]]
    scene = {**json.loads((SAMPLES / "doorway.json").read_text()), "springs": [], "drive": {"kind": "tips", "paths": []}}
    scene["load"] = {"mass_kg": 1.0, "outline": {"polygon": {"points_m": ring}}}
    scene["obstacles"] = []
    assert cohaul.import_scenario(scene).account["notes"][-1]["kind"] == "moved"
