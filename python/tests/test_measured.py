"""Measured runs: what the program prints, and arguments that are refused."""

import json
import os
from pathlib import Path

import pytest

import cohaul

DATA = Path(os.environ["COHAUL_ROOT"]) / "data/measured"
TABLE, BLOCK = DATA / "pushes.csv", DATA / "block.json"


def test_a_fit_is_checked_on_the_other_runs():
    found = cohaul.measured(TABLE, BLOCK, fit="side-friction", engine=None)
    number = found["fit"]["numbers"][0]
    low, high = number["interval_95"]
    # The recording was made with 0.36.
    assert low < 0.36 < high and low < number["value"] < high
    assert (found["fit"]["n_fit"], found["n_runs"]) == (6, 6)
    # Printed text is wrapped.
    assert "model" in found.answer and found.answer in " ".join(str(found).split())


def test_tables_come_from_files_folders_and_frames(tmp_path):
    text = open(TABLE).read()

    class Frame:
        def to_csv(self, index):
            assert index is False
            return text

    (tmp_path / "pushes.csv").write_text(text)
    whole = cohaul.measured(TABLE, BLOCK, engine=None)
    for recording in (Frame(), tmp_path, [TABLE]):
        assert cohaul.measured(recording, BLOCK, engine=None)["over_runs"] == whole["over_runs"]
    whole.save(tmp_path / "out")
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["answer"] == whole.answer


@pytest.mark.parametrize(
    ("options", "rule"),
    [
        ({"engine": "bullet"}, "engine: must be 'rapier' or None, found 'bullet'"),
        ({"start": "near"}, "start: must be 'touching' or 'recorded', found 'near'"),
        ({"fit": "mass"}, "must be ground-friction, side-friction or a number of the scene"),
        ({"fit": "side-friction", "fit_runs": 99}, "must be on at most 12 runs"),
        ({"columns": {"load_x_m": "X"}}, "load_x_m: must be a column of the table, found X"),
    ],
)
def test_wrong_arguments_are_refused(options, rule):
    with pytest.raises(ValueError, match=rule.replace("(", r"\(")):
        cohaul.measured(TABLE, BLOCK, **options)
