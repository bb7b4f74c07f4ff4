"""Report cards of engines: `python python/report_cards --out results/2026-11-30-engines`.

Runs all engines that are installed over conformance tests and scenes, and writes numbers, page and
figures. Run times are kept apart: all other numbers are the same in each run.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import measure
from others import others
from page import write_page
from subjects import PRECISION, SCENES, STEPS_S, advice, cards

import cohaul


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=Path("results/2026-11-30-engines"), help="folder of results")
    parser.add_argument("--scenes", nargs="+", default=list(SCENES), help="scenes in scenarios/, without .json")
    parser.add_argument("--build", default="optimised", help="how the installed cohaul was built, for the page")
    parser.add_argument("--page", action="store_true", help="write page and figures from the stored numbers alone")
    asked = parser.parse_args()
    asked.out.mkdir(parents=True, exist_ok=True)
    if not asked.page:
        measure.write_json(asked.out / "manifest.json", manifest(asked))
        measure.write_json(asked.out / "cards.json", all_cards(asked))
        say("run times")
        measure.write_json(asked.out / "times.json", measure.run_times(cards()))
    stored = [json.loads((asked.out / f"{name}.json").read_text()) for name in ("cards", "times", "manifest")]
    write_page(asked.out, *stored)


def all_cards(asked: Any) -> dict[str, Any]:
    """All numbers but run times."""
    engines = []
    for card in cards():
        say(card.name)
        engines.append({
            "name": card.name,
            "version": getattr(card.engine, "version", None) or engine_version(str(card.engine)),
            "settings": card.settings,
            "conformance": measure.conformance(card),
            "friction_direction_deg": measure.friction_direction(card),
            "scenes": measure.on_scenes(card, scenes=tuple(asked.scenes)),
            "steps": {name: measure.errors_at_steps(card, name) for name in PRECISION},
        })
    say("changes of settings")
    found = {"step_s": measure.STEP_S, "steps_s": list(STEPS_S), "engines": engines}
    return {**found, "advice": [measure.effect(change) for change in advice()], "others": others(asked.out / "scenes")}


def engine_version(backend: str) -> str:
    """Version of a backend of cohaul, as its conformance table states it."""
    line: str = cohaul.conformance(backend).line
    return line.split("; ")[-1].split(" ")[1]


def manifest(asked: Any) -> dict[str, Any]:
    def of(package: str) -> str | None:
        try:
            return version(package)
        except PackageNotFoundError:
            return None

    commit = subprocess.run(["git", "rev-parse", "HEAD"], capture_output=True, text=True, cwd=measure.ROOT).stdout.strip()
    return {
        "format": {"name": "cohaul report cards", "version": 1},
        "command_line": ["python", "python/report_cards", *sys.argv[1:]],
        "commit": commit or None,
        "build": asked.build,
        "python": platform.python_version(),
        "libraries": {name: of(name) for name in ("pymunk", "Box2D", "mujoco", "drake", "numpy")},
        "machine": {"architecture": platform.machine(), "system": platform.system().lower(), "n_cpus": os.cpu_count()},
        "scenarios": {name: measure.scene(name).sha256 for name in asked.scenes},
    }


def say(what: str) -> None:
    print(f"report cards: {what}", file=sys.stderr, flush=True)


main()
