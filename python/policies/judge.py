"""Judging policies: how often they arrive on each backend, and why their motions differ."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any, Callable

import gymnasium
import numpy as np

import cohaul
import cohaul.gym
from cohaul.gym import TransportEnv
from cohaul.results import BackendName
from policy import Policy

N_EPISODES = 200
"""Episodes on each backend, with the same starts and goals (1)."""
N_VERDICTS = 3
"""Episodes that are compared as runs (1)."""

Maker = Callable[[TransportEnv], Policy]


def judged(name: str, make: Maker) -> dict[str, Any]:
    """What a policy does on each backend, and verdicts on its first episodes."""
    by_backend = {}
    for backend in cohaul.BACKENDS:
        found = success(name, backend, make, range(N_EPISODES))
        arrived, times = np.array(found["arrived"]), np.array(found["time_s"])
        low, high = wilson(int(arrived.sum()), len(arrived))
        mean = float(times[arrived].mean()) if arrived.any() else None
        by_backend[backend] = {"n": len(arrived), "n_arrived": int(arrived.sum()), "interval_95": [low, high], "mean_time_s": mean}
    return {"backends": by_backend, "episodes": [verdict(name, make, seed) for seed in range(N_VERDICTS)]}


def success(name: str, backend: BackendName, make: Maker, seeds: Iterable[int]) -> dict[str, list[Any]]:
    """Whether each episode arrives, and when it ends (s)."""
    env: Any = gymnasium.make(f"cohaul/{name}-v0", backend=backend).unwrapped
    policy, found = make(env), {"arrived": [], "time_s": []}
    for seed in seeds:
        observation, info = env.reset(seed=seed)
        is_over = arrived = False
        while not is_over:
            observation, _, arrived, is_late, info = env.step(policy(observation))
            is_over = arrived or is_late
        found["arrived"].append(bool(arrived))
        found["time_s"].append(float(info["time_s"]))
    return found


def verdict(name: str, make: Maker, seed: int) -> dict[str, Any]:
    """Does an episode hold with inertia and on the engine? The policy answers to what it sees there."""
    env: Any = gymnasium.make(f"cohaul/{name}-v0").unwrapped
    scenario, controller = env.episode(make(env), seed)
    goal = env.goal_now
    missed = cohaul.Measure("distance to the goal", "m", lambda trace: math.hypot(goal[0] - trace["x_m"][-1], goal[1] - trace["y_m"][-1]), tolerance=env.goal_radius_m)
    found = cohaul.compare_controller(scenario, controller, tiers="controlled", measure=missed)
    path = found.verdicts["path"]
    numbers = {key: path[key] for key in ("inertia_effect", "engine_error", "reference_error", "tolerance")}
    return {
        "seed": seed,
        "answer": found.answer,
        "path": {"verdict": path["verdict"], **numbers},
        "goal": found.verdicts["measure"]["verdict"],
        "distances_m": {key: found.verdicts["measure"]["measures"][0][key] for key in ("quasi_static", "inertial", "engine")},
    }


def wilson(n_arrived: int, n: int, z: float = 1.959964) -> tuple[float, float]:
    """Confidence interval of a share at 95 %, after Wilson (1)."""
    share, more = n_arrived / n, z * z / n
    middle, half = share + 0.5 * more, z * math.sqrt(share * (1.0 - share) / n + 0.25 * more / n)
    return max(0.0, (middle - half) / (1.0 + more)), min(1.0, (middle + half) / (1.0 + more))
