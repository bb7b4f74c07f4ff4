"""The report cards of engines: page and figures follow from the stored numbers."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

from conftest import ROOT

CARDS = ROOT / "results/2026-11-30-engines"


def test_the_page_is_that_of_the_stored_numbers(tmp_path: Path) -> None:
    for name in ("cards.json", "times.json", "manifest.json"):
        shutil.copy(CARDS / name, tmp_path)
    subprocess.run([sys.executable, str(ROOT / "python/report_cards"), "--page", "--out", str(tmp_path)], check=True)
    for name in ("README.md", "errors.svg", "work-precision.svg"):
        assert (tmp_path / name).read_text() == (CARDS / name).read_text(), name
