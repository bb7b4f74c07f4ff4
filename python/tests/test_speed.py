"""The step loop from Python against the same loop in Rust, in one process."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np

import cohaul
from cohaul import _native
from cohaul._options import as_json

# Longest time that a call from Python adds (s).
MOST_ADDED_S = 2e-6


def added_s(scenario: cohaul.Scenario, n: int = 2_000, repeats: int = 60) -> tuple[float, float]:
    """Time that one call adds, and time of one call in Rust (s): the least of many short loops,
    which alternate, so that other load on the machine leaves some of them alone."""
    options, shift, step = as_json({"step_s": 1e-3}), 1e-6, 1e-3

    def python() -> float:
        sim = cohaul.Simulation(scenario, step_s=1e-3)
        sim.attach(0, (0.0, 0.0))
        x = 0.0
        started = time.perf_counter()
        for _ in range(n):
            x += shift
            sim.advance(((x, 0.0),), step)
        return time.perf_counter() - started

    def rust() -> float:
        return _native.rust_loop_s(scenario._scene, options, [(0.0, 0.0)], (shift, 0.0), step, n)

    pairs = [(python(), rust()) for _ in range(repeats)]
    fastest = [min(pair[at] for pair in pairs) for at in (0, 1)]
    return (fastest[0] - fastest[1]) / n, fastest[1] / n


def test_a_call_from_python_adds_at_most_two_microseconds(pulled: Path) -> None:
    added, rust = added_s(cohaul.Scenario(pulled))
    print(f"\na call adds {1e6 * added:.2f} us to {1e6 * rust:.2f} us in Rust")
    assert added < MOST_ADDED_S


def added_to_period_s(scenario: cohaul.Scenario, n: int = 1_000, periods: int = 50, repeats: int = 15) -> tuple[float, float]:
    """Time that a rollout adds to a control period, and time of one in Rust (s), on two threads: the
    least times of calls that alternate."""
    shift, step = 3e-4, 1e-3
    options = as_json({"step_s": step, "backend": "inertial"})
    sim = cohaul.Simulation(scenario, "inertial", step_s=step)
    sim.attach(0, (0.0, 0.0))
    tips = np.zeros((n, periods, 1, 2))
    tips[..., 0, 0] = shift * np.arange(1, periods + 1)

    def python() -> float:
        started = time.perf_counter()
        assert cohaul.rollouts(scenario, "inertial", states=sim.state, tips=tips, period_s=step, step_s=step, threads=2).poses.size
        return time.perf_counter() - started

    def rust() -> float:
        return _native.rust_rollouts_s(scenario._scene, options, [(0.0, 0.0)], (shift, 0.0), step, (n, periods), 2)

    pairs = [(python(), rust()) for _ in range(repeats)]
    fastest = [min(pair[at] for pair in pairs) for at in (0, 1)]
    return (fastest[0] - fastest[1]) / (n * periods), fastest[1] / (n * periods)


def test_a_rollout_adds_at_most_two_microseconds_to_a_period(pulled: Path) -> None:
    added, rust = added_to_period_s(cohaul.Scenario(pulled))
    print(f"\na period of a rollout takes {1e6 * added:.2f} us more than the {1e6 * rust:.2f} us in Rust: a share of {rust / (rust + added):.2f}")
    assert added < MOST_ADDED_S
