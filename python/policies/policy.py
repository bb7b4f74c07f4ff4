"""Policies that need numpy alone: networks that were trained elsewhere, and rules by hand."""

from __future__ import annotations

from pathlib import Path
from typing import Callable

import numpy as np

from cohaul.gym import TransportEnv
from cohaul.results import FloatArray

Policy = Callable[[FloatArray], FloatArray]


class Network:
    """Layers with tanh between them, as those of PPO by default. Its action is the mean."""

    def __init__(self, layers: list[tuple[FloatArray, FloatArray]]) -> None:
        self.layers = layers

    def __call__(self, observation: FloatArray) -> FloatArray:
        *hidden, (weights, bias) = self.layers
        for matrix, shift in hidden:
            observation = np.tanh(matrix @ observation + shift)
        return np.clip(weights @ observation + bias, -1.0, 1.0)

    def save(self, path: Path) -> None:
        """Writes all layers in single precision."""
        arrays = {f"{name}{at}": one.astype(np.float32) for at, layer in enumerate(self.layers) for name, one in zip(("weights", "bias"), layer)}
        np.savez_compressed(path, allow_pickle=False, **arrays)

    @classmethod
    def load(cls, path: Path) -> Network:
        with np.load(path, allow_pickle=False) as arrays:
            n = len(arrays.files) // 2
            return cls([(arrays[f"weights{at}"].astype(float), arrays[f"bias{at}"].astype(float)) for at in range(n)])


def towards_the_goal(env: TransportEnv) -> Policy:
    """All tips move towards the goal at full speed; pushers stand still."""
    n_springs, n_actions = env.scenario.n_springs, env.action_space.shape[0]

    def act(observation: FloatArray) -> FloatArray:
        action = np.zeros(n_actions)
        far = max(float(np.hypot(*observation[:2])), 1e-12)
        action[: 2 * n_springs] = np.tile(observation[:2] / far, n_springs)
        return action

    return act
