"""Trained policies of the environments: `python python/policies all`.

`train` needs stable-baselines3 and torch, and writes weights as arrays of numpy; `judge` needs these
alone; `page` needs the numbers that both have stored.
"""

from __future__ import annotations

import argparse
import json
import subprocess
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from page import write_book, write_page

NAMES = ("Transport", "Doorway", "PushT")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=["train", "judge", "page", "all"])
    parser.add_argument("--out", type=Path, default=Path("results/2026-11-30-policies"), help="folder of results")
    parser.add_argument("--book", type=Path, default=Path("docs/src/environments"), help="folder of the book's pages")
    parser.add_argument("--only", nargs="+", choices=NAMES, default=list(NAMES), help="environments that are trained or judged")
    asked = parser.parse_args()
    asked.out.mkdir(parents=True, exist_ok=True)
    if asked.what in ("train", "all"):
        train(asked)
    if asked.what in ("judge", "all"):
        judge(asked)
    if asked.what != "page":
        write(asked.out / "manifest.json", manifest())
    if asked.what in ("page", "all"):
        training, judgement, made_by = (json.loads((asked.out / f"{name}.json").read_text()) for name in ("training", "judgement", "manifest"))
        write_page(asked.out, training, judgement, made_by)
        write_book(asked.book, training, judgement)


def train(asked: Any) -> None:
    from train import train as trained

    training = stored(asked.out / "training.json")
    for name in asked.only:
        training[name] = trained(name, asked.out)
        write(asked.out / "training.json", training)


def judge(asked: Any) -> None:
    from judge import judged
    from policy import Network, towards_the_goal
    from pushes import planned_pushes

    found = stored(asked.out / "judgement.json")
    for name in asked.only:
        found[name] = {}
        if (asked.out / f"{name}.npz").exists():
            network = Network.load(asked.out / f"{name}.npz")
            found[name]["PPO"] = judged(name, lambda env: network)  # noqa: B023
        rule, make = ("planned pushes", planned_pushes) if name == "PushT" else ("towards the goal", towards_the_goal)
        found[name][rule] = judged(name, make)
        write(asked.out / "judgement.json", found)


def manifest() -> dict[str, Any]:
    def of(package: str) -> str | None:
        try:
            return version(package)
        except PackageNotFoundError:
            return None

    commit = subprocess.run(["git", "rev-parse", "HEAD"], capture_output=True, text=True, cwd=Path(__file__).parents[2]).stdout.strip()
    return {
        "format": {"name": "cohaul policies", "version": 1},
        "commit": commit or None,
        "libraries": {name: of(name) for name in ("stable-baselines3", "torch", "gymnasium", "numpy")},
    }


def stored(path: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(path.read_text()) if path.exists() else {}
    return found


def write(path: Path, value: Any) -> None:
    path.write_text(json.dumps(value, indent=1) + "\n")


main()
