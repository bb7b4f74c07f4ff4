"""What the tests share."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

pytest_plugins = ["pytester"]

ROOT = Path(os.environ.get("COHAUL_ROOT", Path(__file__).resolve().parents[2]))
SCENES = ROOT / "scenarios"
PROGRAM = Path(os.environ.get("COHAUL", ROOT / "target/debug/cohaul"))


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--all-scenes", action="store_true", help="whole runs of every scene on every backend")
    parser.addoption("--misuses", type=int, default=0, help="random misuses of engines, in the interpreter and through the pipe")
    parser.addoption("--calls", type=int, default=100_000, help="calls of the step loop in the test of memory")


@pytest.fixture
def four_ants() -> Path:
    return SCENES / "paper/four-ants-four-springs.json"


@pytest.fixture
def pulled() -> Path:
    return SCENES / "analytic/centre-pull.json"
