"""Gymnasium environment: move the tips of springs, and pushers, so that the load reaches a goal.

>>> import gymnasium, cohaul.gym
>>> env = gymnasium.make("cohaul/Transport-v0", backend="inertial")
>>> observation, info = env.reset(seed=1)
>>> observation.shape, env.action_space.shape
((23,), (8,))
>>> environments = gymnasium.make_vec("cohaul/Transport-v0", num_envs=3)
>>> environments.reset(seed=1)[0].shape
(3, 23)

Obstacles can be steered too, here a disc that pushes the load:

>>> env = gymnasium.make("cohaul/Transport-v0", scenario="scenarios/contact/pusher.json", pushers=[0])
>>> env.reset(seed=1)[0].shape, env.action_space.shape
((13,), (3,))
"""

from __future__ import annotations

import math
from typing import Any, Sequence

import numpy as np

from ._options import whole
from ._run import library
from ._scenario import Scenario, Source
from ._simulation import Simulation

gymnasium: Any = library("gymnasium", "cohaul.gym")

PAPER_LOAD: dict[str, Any] = {
    "name": "the paper's load on four springs",
    "duration_s": 30.0,
    "control_period_s": 0.05,
    "load": {"mass_kg": 0.0016, "radius_m": 0.0122},
    "ground": {"friction_coefficient": 1.4, "supports": {"tripod": {"radius_m": 0.0081333}}},
    "springs": [
        {
            "ring": {
                "n": 4,
                "radius_m": 0.0122,
                "rest_length_m": 0.0263,
                "radial_stiffness_n_per_m": 0.664,
                "torsional_stiffness_nm_per_rad": 4.52e-4,
            }
        }
    ],
    "drive": {"kind": "tips", "paths": []},
}
"""The scene that an environment has by default."""


class TransportEnv(gymnasium.Env):  # type: ignore[misc, name-defined, unused-ignore]
    """A load that springs drag and obstacles push to a goal, on any backend.

    All springs are attached, undeformed, at the start. An action has a velocity for each tip in
    units of ``max_speed_m_per_s``, (x, y) from -1 to 1; the tips move for one control period. Then
    it has the velocity of each of the ``pushers``, and its turn rate in units of
    ``max_turn_rate_rad_per_s``; other obstacles follow their paths. An
    observation has the goal seen from the load (m, world), cosine and sine of the heading, the
    twist of the load (m/s, rad/s), the tips seen from the load (m, world), and the pulls on the
    tips over the sum of all slip limits (1). Then it has, for each pusher, its position seen from
    the load (m, world), cosine and sine of its heading, and its force on the load over the sum of
    all slip limits (1, world). The reward is the approach to the goal over the
    distance at the start (1). An episode ends within ``goal_radius_m`` of the goal, or at the
    duration of the scenario.

    :param scenario: the load, its ground and its springs; the drive is not used
    :param goal_m: position of the goal (m); by default a random direction in each episode
    :param goal_distance_m: distance of a random goal (m)
    :param pushers: obstacles that the actions steer, by their indices
    """

    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(
        self,
        scenario: Source | None = None,
        backend: str = "quasi-static",
        *,
        goal_m: tuple[float, float] | None = None,
        goal_distance_m: float = 0.1,
        goal_radius_m: float = 0.01,
        max_speed_m_per_s: float = 0.05,
        step_s: float | None = None,
        pushers: Sequence[int] = (),
        max_turn_rate_rad_per_s: float = 1.0,
    ) -> None:
        self.scenario = Scenario(PAPER_LOAD if scenario is None else scenario)
        self.backend, self.step_s = backend, step_s
        self.goal_m, self.goal_distance_m, self.goal_radius_m = goal_m, goal_distance_m, goal_radius_m
        self.max_speed_m_per_s = max_speed_m_per_s
        self.max_turn_rate_rad_per_s = max_turn_rate_rad_per_s
        self.simulation = Simulation(self.scenario, backend, step_s=step_s)
        most = self.simulation.n_obstacles - 1
        self.pushers = [whole(f"pushers[{at}]", obstacle, 0, most) or 0 for at, obstacle in enumerate(pushers)]
        n, n_pushers = self.scenario.n_springs, len(self.pushers)
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (2 * n + 3 * n_pushers,), np.float32)
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (7 + 4 * n + 6 * n_pushers,), np.float64)
        self._rest = _undeformed(self.scenario)
        self._goal = np.zeros(2)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[np.ndarray, dict[str, Any]]:
        """Puts the load at its start and attaches all springs."""
        super().reset(seed=seed)
        self.simulation = Simulation(self.scenario, self.backend, step_s=self.step_s)
        for spring, tip in enumerate(self._rest):
            self.simulation.attach(spring, tip)
        start = np.array(self.simulation.pose[:2])
        angle = self.np_random.uniform(-math.pi, math.pi)
        away = self.goal_distance_m * np.array([math.cos(angle), math.sin(angle)])
        self._goal = start + away if self.goal_m is None else np.array(self.goal_m, dtype=float)
        self._start_distance = max(self._distance(), 1e-9)
        return self._observation(), self._info("converged")

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Moves tips and pushers for one control period."""
        sim, before = self.simulation, self._distance()
        period = sim.control_period_s
        of_tips, of_pushers = np.split(np.clip(np.asarray(action, dtype=float), -1.0, 1.0), [2 * sim.n_springs])
        velocity = of_tips.reshape(-1, 2) * self.max_speed_m_per_s
        fastest = np.array([self.max_speed_m_per_s, self.max_speed_m_per_s, self.max_turn_rate_rad_per_s])
        poses = sim.obstacles[self.pushers] + period * fastest * of_pushers.reshape(-1, 3)
        status = sim.advance(sim.tips + period * velocity, period, dict(zip(self.pushers, poses)))
        distance = self._distance()
        terminated = distance <= self.goal_radius_m
        truncated = sim.time_s >= self.scenario.duration_s - 0.5 * period
        reward = float((before - distance) / self._start_distance)
        return self._observation(), reward, bool(terminated), bool(truncated), self._info(status)

    def _distance(self) -> float:
        return float(np.hypot(*(self._goal - self.simulation.pose[:2])))

    def _observation(self) -> np.ndarray:
        sim = self.simulation
        x, y, heading = sim.pose
        place = np.array([x, y])
        pulls = sim.pulls / max(self.scenario.slip_limit_n, 1e-12)
        parts = [self._goal - place, [math.cos(heading), math.sin(heading)], sim.twist, (sim.tips - place).ravel(), pulls.ravel()]
        poses, forces = sim.obstacles, sim.contact_forces / max(self.scenario.slip_limit_n, 1e-12)
        for pusher in self.pushers:
            turn = poses[pusher, 2]
            parts += [poses[pusher, :2] - place, [math.cos(turn), math.sin(turn)], forces[pusher]]
        return np.concatenate(parts)

    def _info(self, status: str) -> dict[str, Any]:
        return {"status": status, "time_s": self.simulation.time_s, "distance_m": self._distance()}


def _undeformed(scenario: Scenario) -> np.ndarray:
    """Tip of each undeformed spring at the start (m, world)."""
    expanded = scenario.to_dict()
    load = expanded["load"]
    place, heading = np.array(load.get("position_m", [0.0, 0.0])), load.get("heading_rad", 0.0)
    tips = []
    for spring in expanded["springs"]:
        bearing = heading + spring["bearing_rad"]
        root, (cos, sin) = np.array(spring["root_m"]), (math.cos(heading), math.sin(heading))
        rotated = np.array([cos * root[0] - sin * root[1], sin * root[0] + cos * root[1]])
        tips.append(place + rotated + spring["rest_length_m"] * np.array([math.cos(bearing), math.sin(bearing)]))
    return np.array(tips).reshape(-1, 2)


if "cohaul/Transport-v0" not in gymnasium.registry:
    gymnasium.register(id="cohaul/Transport-v0", entry_point="cohaul.gym:TransportEnv")
