"""Trained policies: their pages follow from the stored numbers, and their weights still arrive."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT

RESULTS, POLICIES = ROOT / "results/2026-11-30-policies", ROOT / "python/policies"


def test_pages_are_those_of_the_stored_numbers(tmp_path: Path) -> None:
    for name in ("training.json", "judgement.json", "manifest.json"):
        shutil.copy(RESULTS / name, tmp_path)
    command = [sys.executable, str(POLICIES), "page", "--out", str(tmp_path), "--book", str(tmp_path)]
    subprocess.run(command, check=True)
    assert (tmp_path / "README.md").read_text() == (RESULTS / "README.md").read_text()
    for name in ("transport", "doorway", "push-t"):
        assert (tmp_path / f"{name}.md").read_text() == (ROOT / f"docs/src/environments/{name}.md").read_text(), name


def test_transport_is_learned_in_100_000_steps_and_its_weights_arrive(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("gymnasium")
    monkeypatch.syspath_prepend(str(POLICIES))
    from judge import success, wilson
    from policy import Network

    found = json.loads((RESULTS / "training.json").read_text())["Transport"]
    assert found["n_steps"] <= 100_000 and found["curve"][-1]["success"] >= 0.9
    network = Network.load(RESULTS / "Transport.npz")
    stored = json.loads((RESULTS / "judgement.json").read_text())["Transport"]["PPO"]["backends"]
    for backend in ("quasi-static", "inertial", "rapier"):
        arrived = success("Transport", backend, lambda env: network, range(20))["arrived"]
        low, _ = stored[backend]["interval_95"]
        assert np.mean(arrived) >= low - 0.1, backend
    # An untrained network does not: the weights matter.
    noise = np.random.default_rng(1)
    other = Network([(noise.normal(0.0, 0.1, weights.shape), np.zeros(len(bias))) for weights, bias in network.layers])
    assert np.mean(success("Transport", "quasi-static", lambda env: other, range(5))["arrived"]) < 0.5
    assert wilson(0, 10)[0] == 0.0 and 1.0 - 1e-12 < wilson(10, 10)[1] <= 1.0
    # Agresti and Coull (1998): 8 of 10 at 95 %.
    assert np.allclose(wilson(8, 10), (0.490, 0.943), atol=5e-4)
