"""Training by PPO of stable-baselines3 with its default settings, on the CPU and one thread."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import gymnasium
import numpy as np

import cohaul.gym
from judge import success
from policy import Network

N_STEPS = {"Transport": 100_000, "Doorway": 60_000, "PushT": 300_000}
"""Steps of the training of each environment (1)."""
EVERY = 10_000
"""Steps between two evaluations (1)."""
N_EPISODES = 100
"""Episodes of an evaluation, whose seeds no judgement uses (1)."""
FIRST_SEED = 1_000_000


def train(name: str, out: Path, seed: int = 0) -> dict[str, Any]:
    """Trains a policy on the quasi-static backend, and writes its weights to ``NAME.npz``."""
    import torch
    from stable_baselines3 import PPO
    from stable_baselines3.common.callbacks import BaseCallback

    torch.set_num_threads(1)
    curve: list[dict[str, float]] = []

    class Evaluation(BaseCallback):
        def _on_step(self) -> bool:
            if self.num_timesteps % EVERY == 0:
                seeds = range(FIRST_SEED, FIRST_SEED + N_EPISODES)
                found = success(name, "quasi-static", lambda env: network(self.model), seeds)
                curve.append({"n_steps": self.num_timesteps, "success": float(np.mean(found["arrived"]))})
                print(f"{name}: {self.num_timesteps} steps, success {curve[-1]['success']:.2f}", flush=True)
            return True

    model = PPO("MlpPolicy", gymnasium.make(f"cohaul/{name}-v0"), seed=seed, device="cpu")
    model.learn(N_STEPS[name], callback=Evaluation())
    network(model).save(out / f"{name}.npz")
    return {"n_steps": N_STEPS[name], "seed": seed, "curve": curve}


def network(model: Any) -> Network:
    """The network that gives the mean of the actions."""
    policy = model.policy
    layers = [layer for layer in [*policy.mlp_extractor.policy_net, policy.action_net] if hasattr(layer, "weight")]
    return Network([(layer.weight.detach().numpy().astype(float), layer.bias.detach().numpy().astype(float)) for layer in layers])
