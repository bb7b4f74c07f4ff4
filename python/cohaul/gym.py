"""Gymnasium environments: tips of springs and pushers move, so that the load reaches a goal.

``cohaul/Transport-v0`` is the paper's load on four springs, ``cohaul/PushT-v0`` a T block that a
disc pushes to a pose among posts, and ``cohaul/Doorway-v0`` a crate that two robots tow through a
doorway.

>>> import gymnasium, cohaul.gym
>>> env = gymnasium.make("cohaul/Transport-v0", backend="inertial")
>>> observation, info = env.reset(seed=1)
>>> observation.shape, env.action_space.shape
((23,), (8,))
>>> environments = gymnasium.make_vec("cohaul/Transport-v0", num_envs=3)
>>> environments.reset(seed=1)[0].shape
(3, 23)

Any scene can be used, here one with a disc that pushes the load:

>>> env = gymnasium.make("cohaul/Transport-v0", scenario="scenarios/contact/pusher.json", pushers=[0])
>>> env.reset(seed=1)[0].shape, env.action_space.shape
((13,), (3,))
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Callable, Literal, Mapping, Sequence

import numpy as np
import numpy.typing as npt

from ._draw import Painter, reach
from ._options import number, whole
from ._native import View
from ._run import Controller, library
from ._scenario import Scenario, Source
from ._simulation import Simulation
from ._tasks import DOORWAY, PAPER_LOAD, T_BLOCK
from .results import BackendName, FloatArray

if TYPE_CHECKING:
    import gymnasium
else:
    gymnasium = library("gymnasium", "cohaul.gym")

Action = npt.NDArray[np.float32]
"""Velocities in units of the largest one, from -1 to 1."""


class TransportEnv(gymnasium.Env[FloatArray, Action]):
    """A load that springs drag and obstacles push to a goal, on any backend.

    All springs are attached, undeformed, at the start. An action has a velocity for each tip in
    units of ``max_speed_m_per_s``, (x, y) from -1 to 1; the tips move for one control period. Then
    it has the velocity of each of the ``pushers``, and its turn rate in units of
    ``max_turn_rate_rad_per_s``; other obstacles follow their paths.

    An observation has the goal seen from the load (world), cosine and sine of the heading, and the
    twist of the load. The tips seen from the load (world) follow, and the pulls on them over the sum
    of all slip limits. Then it has, for each pusher, its position seen from the load (world), cosine
    and sine of its heading, and its force on the load over the sum of all slip limits (world). With
    ``goal_heading_rad`` cosine and sine of the turn that is left are the last two. All numbers are
    near 1: the goal is in units of ``goal_distance_m``, other places in units of the reach of load
    and springs, velocities in units of ``max_speed_m_per_s``, and the turn rate in units of that
    speed at the reach. With ``is_normalised=False`` they are in m, m/s and rad/s.

    The reward is the approach to the goal over the distance at the start; a turn counts as the
    distance that it moves the reach. With ``reward="sparse"`` it is 1 at the goal and 0 before. An
    episode ends at the goal, or at the duration of the scenario.

    :param scenario: the load, its ground, its springs and obstacles; the drive is not used
    :param goal_m: position of the goal (m); by default a random direction in each episode
    :param goal_heading_rad: heading at the goal (rad); by default any
    :param goal_distance_m: distance of a random goal (m)
    :param goal_radius_m: distance within which the load is at the goal (m)
    :param goal_angle_rad: turn within which the load is at the goal (rad)
    :param start_spread_m: largest shift of the load at the start along each axis (m), at random
    :param start_spread_rad: largest turn of the load at the start (rad), at random
    :param pushers: obstacles that the actions steer, by their indices
    :param render_mode: ``"rgb_array"`` or ``"human"``, which need pygame
    """

    metadata: dict[str, Any] = {"render_modes": ["human", "rgb_array"], "render_fps": 20}

    def __init__(
        self,
        scenario: Source | None = None,
        backend: BackendName = "quasi-static",
        *,
        goal_m: Sequence[float] | None = None,
        goal_heading_rad: float | None = None,
        goal_distance_m: float = 0.1,
        goal_radius_m: float = 0.01,
        goal_angle_rad: float = 0.1,
        start_spread_m: float = 0.0,
        start_spread_rad: float = 0.0,
        max_speed_m_per_s: float = 0.05,
        max_turn_rate_rad_per_s: float = 1.0,
        step_s: float | None = None,
        pushers: Sequence[int] = (),
        reward: Literal["dense", "sparse"] = "dense",
        is_normalised: bool = True,
        render_mode: Literal["rgb_array", "human"] | None = None,
    ) -> None:
        if reward not in ("dense", "sparse"):
            raise ValueError(f"reward: must be 'dense' or 'sparse', found {reward!r}")
        if render_mode is not None and render_mode not in self.metadata["render_modes"]:
            raise ValueError(f"render_mode: must be 'human', 'rgb_array' or None, found {render_mode!r}")
        self.scenario: Scenario = Scenario(PAPER_LOAD if scenario is None else scenario)
        self.backend: BackendName = backend
        self.step_s: float | None = step_s
        self.goal_m: FloatArray | None = None if goal_m is None else _place("goal_m", goal_m)
        self.goal_heading_rad: float | None = number("goal_heading_rad", goal_heading_rad, positive=False)
        self.goal_distance_m: float = _positive("goal_distance_m", goal_distance_m)
        self.goal_radius_m: float = _positive("goal_radius_m", goal_radius_m)
        self.goal_angle_rad: float = _positive("goal_angle_rad", goal_angle_rad)
        self.start_spread: FloatArray = np.array([start_spread_m, start_spread_m, start_spread_rad], dtype=float)
        if not (np.isfinite(self.start_spread).all() and (self.start_spread >= 0.0).all()):
            raise ValueError(f"start_spread_m, start_spread_rad: must be numbers from 0, found {start_spread_m}, {start_spread_rad}")
        self.max_speed_m_per_s: float = _positive("max_speed_m_per_s", max_speed_m_per_s)
        self.max_turn_rate_rad_per_s: float = _positive("max_turn_rate_rad_per_s", max_turn_rate_rad_per_s)
        self.reward: Literal["dense", "sparse"] = reward
        self.is_normalised: bool = bool(is_normalised)
        self.render_mode: str | None = render_mode
        self.simulation: Simulation = Simulation(self.scenario, backend, step_s=step_s)
        most = self.simulation.n_obstacles - 1
        self.pushers: list[int] = [whole(f"pushers[{at}]", obstacle, 0, most) or 0 for at, obstacle in enumerate(pushers)]
        n, n_pushers = self.scenario.n_springs, len(self.pushers)
        n_goal = 0 if self.goal_heading_rad is None else 2
        self.action_space: gymnasium.spaces.Space[Action] = gymnasium.spaces.Box(-1.0, 1.0, (2 * n + 3 * n_pushers,), np.float32)
        self._n_seen = 7 + 4 * n + 6 * n_pushers + n_goal
        self.observation_space: gymnasium.spaces.Space[FloatArray] = gymnasium.spaces.Box(-np.inf, np.inf, (self._n_seen,), np.float64)
        self._data = self.scenario.to_dict()
        self._reach = reach(self._data)
        self._period = self.scenario.control_period_s
        self._last_time_s = self.scenario.duration_s - 0.5 * self._period
        turned = [self.max_speed_m_per_s, self.max_speed_m_per_s, self.max_turn_rate_rad_per_s]
        self._moves = self._period * np.array([self.max_speed_m_per_s] * (2 * n) + turned * n_pushers)
        self._slip_limit = max(self.scenario.slip_limit_n, 1e-12)
        self._units = (self.goal_distance_m, self._reach, self.max_speed_m_per_s) if self.is_normalised else (1.0, 1.0, 1.0)
        self._goal, self._goal_heading = np.zeros(2), self.goal_heading_rad
        self._start_distance, self._left = 1.0, 1.0
        self._painter: Painter | None = None

    def reset(self, *, seed: int | None = None, options: Mapping[str, Any] | None = None) -> tuple[FloatArray, dict[str, Any]]:
        """Puts the load at its start and attaches all springs.

        :param options: for this episode: ``goal_m``, ``goal_heading_rad``, and ``pose``, where the
            load starts (x, y in m, heading in rad, world)
        """
        super().reset(seed=seed)
        asked = dict(options or {})
        goal, heading, pose = asked.pop("goal_m", self.goal_m), asked.pop("goal_heading_rad", self.goal_heading_rad), asked.pop("pose", None)
        if asked:
            raise ValueError(f"options: must have the keys goal_m, goal_heading_rad and pose, found {', '.join(map(str, asked))}")
        if (heading is None) != (self.goal_heading_rad is None):
            raise ValueError(f"options.goal_heading_rad: must be a number where the environment has one, found {heading!r}")
        self._goal_heading = number("options.goal_heading_rad", heading, positive=False)
        self.simulation = Simulation(self.scenario, self.backend, step_s=self.step_s)
        self._start(None if pose is None else _place("options.pose", pose, 3))
        self._attach(self.simulation)
        place = np.array(self.simulation.pose[:2])
        angle = self.np_random.uniform(-math.pi, math.pi)
        away = self.goal_distance_m * np.array([math.cos(angle), math.sin(angle)])
        self._goal = place + away if goal is None else _place("options.goal_m", goal)
        observation, info = self._seen_now("converged")
        self._start_distance = max(self._left, 1e-9)
        if self._painter is not None:
            self._painter.see(self._seen())
        if self.render_mode == "human":
            self.render()
        return observation, info

    def step(self, action: Action | FloatArray) -> tuple[FloatArray, float, bool, bool, dict[str, Any]]:
        """Moves tips and pushers for one control period."""
        sim, before = self.simulation, self._left
        tips, pushers = self._commands(sim, action)
        observation, info = self._seen_now(sim.advance(tips, self._period, pushers))
        terminated = self._is_there(info)
        truncated = info["time_s"] >= self._last_time_s
        reward = (before - self._left) / self._start_distance if self.reward == "dense" else float(terminated)
        if self.render_mode == "human":
            self.render()
        return observation, reward, terminated, truncated, info

    def episode(self, policy: Callable[[FloatArray], Action | FloatArray], seed: int) -> tuple[Scenario, Callable[[int], Controller]]:
        """An episode as a scenario and a maker of controllers, for :func:`cohaul.compare_controller`.

        Start and goal are those of ``reset(seed=seed)``. The controller shows the policy what
        :meth:`step` shows, and does what that does with its actions; it finishes at the goal. The
        environment itself stays at that start.

        :param policy: a function of an observation that returns an action

        >>> env = TransportEnv(goal_m=(0.05, 0.0))
        >>> scenario, make = env.episode(lambda seen: np.tile(seen[:2] / np.hypot(*seen[:2]), 4), seed=1)
        >>> cohaul.run(scenario, "inertial", controller=make(1))["arrived"]
        True
        """
        self.reset(seed=seed)
        scene, start = self.scenario.to_dict(), self.simulation.pose
        scene["load"]["position_m"], scene["load"]["heading_rad"] = list(start[:2]), start[2]
        goal, heading = self._goal, self._goal_heading

        def make(_: int) -> Controller:
            def control(view: View) -> FloatArray:
                if view.time_s == 0.0:
                    self._attach(view)
                observation, info = self._observed(view, goal, heading)
                if self._is_there(info):
                    view.finish()
                    return view.tips
                tips, pushers = self._commands(view, policy(observation))
                for obstacle, pose in pushers.items():
                    view.steer(obstacle, pose)
                return tips

            return control

        return Scenario(scene), make

    @property
    def goal_now(self) -> FloatArray:
        """Goal of this episode: x, y (m, world)."""
        return self._goal.copy()

    def render(self) -> npt.NDArray[np.uint8] | None:  # type: ignore[override, unused-ignore]
        """The picture as an array (height, width, 3) of bytes, or in a window."""
        if self.render_mode is None:
            return None
        if self._painter is None:
            self._painter = Painter(self._data, self.render_mode == "human", self.metadata["render_fps"])
            self._painter.see(self._seen())
        goal = self._goal if self._goal_heading is None else np.append(self._goal, self._goal_heading)
        return self._painter.draw(self.simulation, goal, self.goal_radius_m)

    def close(self) -> None:
        """Closes the window."""
        if self._painter is not None:
            self._painter.close()
            self._painter = None

    def __getstate__(self) -> dict[str, Any]:
        # A window stays where it is.
        return {**self.__dict__, "_painter": None}

    def _start(self, pose: FloatArray | None) -> None:
        """Puts the load where the episode starts, free of all obstacles."""
        given = np.array(self.simulation.pose)
        if pose is not None:
            self.simulation.set_pose(pose)
        elif self.start_spread.any():
            for _ in range(100):
                try:
                    self.simulation.set_pose(given + self.start_spread * self.np_random.uniform(-1.0, 1.0, 3))
                    return
                except ValueError:  # In an obstacle.
                    continue
            raise ValueError("start_spread_m, start_spread_rad: must leave a start free of obstacles, found none in 100 draws")

    def _attach(self, sim: Simulation | View) -> None:
        """Attaches all springs undeformed."""
        for spring, tip in enumerate(_undeformed(self._data, sim.pose)):
            sim.attach(spring, tip)

    def _commands(self, sim: Simulation | View, action: Action | FloatArray) -> tuple[FloatArray, dict[int, FloatArray]]:
        """Where an action sends all tips (m, world) and the pushers (m, m, rad)."""
        n, moved = 2 * sim.n_springs, self._moves * np.minimum(np.maximum(action, -1.0), 1.0)
        poses = sim.obstacles[self.pushers] + moved[n:].reshape(-1, 3) if self.pushers else ()
        return sim.tips + moved[:n].reshape(-1, 2), dict(zip(self.pushers, poses))

    def _is_there(self, info: Mapping[str, float]) -> bool:
        return info["distance_m"] <= self.goal_radius_m and abs(info["turn_rad"]) <= self.goal_angle_rad

    def _seen_now(self, status: str) -> tuple[FloatArray, dict[str, Any]]:
        """The observation, and what else is known; notes the distance that is left."""
        observation, info = self._observed(self.simulation, self._goal, self._goal_heading)
        self._left = info["distance_m"] + self._reach * abs(info["turn_rad"])
        return observation, {"status": status, **info}

    def _observed(self, sim: Simulation | View, goal: FloatArray, goal_heading: float | None) -> tuple[FloatArray, dict[str, float]]:
        """The observation, and time, distance and turn that is left."""
        x, y, heading = sim.pose
        u, v, w = sim.twist
        far_x, far_y = float(goal[0]) - x, float(goal[1]) - y
        turn = 0.0 if goal_heading is None else math.remainder(goal_heading - heading, 2.0 * math.pi)
        far, length, speed = self._units
        n, place = sim.n_springs, (x, y)
        seen = np.empty(self._n_seen)
        seen[:7] = far_x / far, far_y / far, math.cos(heading), math.sin(heading), u / speed, v / speed, w * length / speed
        seen[7 : 7 + 2 * n] = ((sim.tips - place) / length).ravel()
        seen[7 + 2 * n : 7 + 4 * n] = sim.pulls.ravel() / self._slip_limit
        if self.pushers:
            poses, forces = sim.obstacles[self.pushers], sim.contact_forces[self.pushers]
            directions = np.stack([np.cos(poses[:, 2]), np.sin(poses[:, 2])], axis=1)
            of_pushers = np.hstack([(poses[:, :2] - place) / length, directions, forces / self._slip_limit])
            seen[7 + 4 * n : 7 + 4 * n + of_pushers.size] = of_pushers.ravel()
        if goal_heading is not None:
            seen[-2:] = math.cos(turn), math.sin(turn)
        return seen, {"time_s": sim.time_s, "distance_m": math.hypot(far_x, far_y), "turn_rad": turn}

    def _seen(self) -> FloatArray:
        """Places that a picture shows (m, world)."""
        sim = self.simulation
        corners = self._reach * np.array([[-1.0, -1.0], [1.0, 1.0]])
        seen = [np.array(sim.pose[:2]) + corners, self._goal + corners]
        return np.concatenate([*seen, sim.obstacles[:, :2]])


def _positive(path: str, value: float) -> float:
    found = number(path, value)
    if found is None:
        raise TypeError(f"{path}: must be a number, found None")
    return found


def _place(path: str, value: Any, n: int = 2) -> FloatArray:
    try:
        found = np.array(value, dtype=float)
    except (TypeError, ValueError):
        found = np.empty(0)
    if found.shape != (n,) or not np.isfinite(found).all():
        raise ValueError(f"{path}: must be {n} finite numbers, found {value!r}")
    return found


def _undeformed(scenario: Mapping[str, Any], pose: Sequence[float]) -> FloatArray:
    """Tip of each undeformed spring of a load at a pose (m, world)."""
    (x, y, heading), tips = pose, []
    cos, sin = math.cos(heading), math.sin(heading)
    for spring in scenario["springs"]:
        (a, b), bearing = spring["root_m"], heading + spring["bearing_rad"]
        root = np.array([x + cos * a - sin * b, y + sin * a + cos * b])
        tips.append(root + spring["rest_length_m"] * np.array([math.cos(bearing), math.sin(bearing)]))
    return np.array(tips).reshape(-1, 2)


PUSH_T: dict[str, Any] = {
    "scenario": T_BLOCK,
    "pushers": [0],
    "goal_m": (0.1, 0.05),
    "goal_heading_rad": 0.5,
    "goal_radius_m": 0.01,
    "start_spread_m": 0.03,
    "start_spread_rad": 0.5,
    "max_speed_m_per_s": 0.1,
}
"""Arguments of ``cohaul/PushT-v0``."""

TOW: dict[str, Any] = {
    "scenario": DOORWAY,
    "goal_m": (1.4, 0.0),
    "goal_distance_m": 1.4,
    "goal_radius_m": 0.1,
    "start_spread_m": 0.05,
    "start_spread_rad": 0.3,
    "max_speed_m_per_s": 0.1,
}
"""Arguments of ``cohaul/Doorway-v0``."""

for _name, _arguments in {"Transport": {}, "PushT": PUSH_T, "Doorway": TOW}.items():
    if f"cohaul/{_name}-v0" not in gymnasium.registry:
        gymnasium.register(id=f"cohaul/{_name}-v0", entry_point="cohaul.gym:TransportEnv", kwargs=_arguments)
