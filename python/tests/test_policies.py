"""Policies: their pages follow from the stored numbers, and trained weights and rules still arrive."""

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


def test_planned_pushes_bring_the_t_block_to_its_pose(monkeypatch: pytest.MonkeyPatch) -> None:
    gymnasium = pytest.importorskip("gymnasium")
    monkeypatch.syspath_prepend(str(POLICIES))
    import pushes
    from judge import success

    stored = json.loads((RESULTS / "judgement.json").read_text())["PushT"]["planned pushes"]["backends"]
    for backend in ("quasi-static", "inertial", "rapier"):
        assert stored[backend]["n"] == 200 and stored[backend]["interval_95"][0] >= 0.9, backend
        arrived = success("PushT", backend, pushes.planned_pushes, range(10))["arrived"]
        assert sum(arrived) >= 9, backend
    # Its plan matters: pushes that are thought to turn the block the other way do not bring it there.
    motions = pushes.motions
    monkeypatch.setattr(pushes, "motions", lambda *given: motions(*given) * [1.0, 1.0, -1.0])
    assert np.mean(success("PushT", "quasi-static", pushes.planned_pushes, range(5))["arrived"]) < 0.5
    # A push of the bar along the axis of symmetry moves the block as far, and does not turn it.
    env = gymnasium.make("cohaul/PushT-v0").unwrapped
    down = np.array([[0.0, -1.0]])
    assert np.allclose(motions(env, np.array([[0.0, 0.0558]]), down, down[None]), [0.0, -1.0, 0.0], atol=1e-6)


def test_a_steady_push_is_the_sum_of_its_periods(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("gymnasium")
    monkeypatch.syspath_prepend(str(POLICIES))
    from pushes import after

    moved, (x, y, heading) = np.array([0.01, -0.004, 0.1]), np.zeros(3)
    shift, turn = after(moved, np.array([1e-3, 12.0]))
    assert np.allclose(shift[0], 1e-3 * moved[:2], rtol=1e-4)
    for _ in range(12_000):
        cos, sin = np.cos(heading + 0.5e-3 * moved[2]), np.sin(heading + 0.5e-3 * moved[2])
        x, y, heading = x + 1e-3 * (cos * moved[0] - sin * moved[1]), y + 1e-3 * (sin * moved[0] + cos * moved[1]), heading + 1e-3 * moved[2]
    assert np.allclose([*shift[1], turn[1]], [x, y, heading], atol=1e-9)
