"""Environments: what they show, what they ask, and what they refuse."""

from __future__ import annotations

import math

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import cohaul.gym
from cohaul.gym import TransportEnv

NAMES = ("Transport", "PushT", "Doorway")


@pytest.mark.parametrize("name", NAMES)
def test_gymnasium_accepts_all_environments(name):
    check_env(gymnasium.make(f"cohaul/{name}-v0").unwrapped, skip_render_check=True)
    both = [gymnasium.make(f"cohaul/{name}-v0") for _ in range(2)]
    (one, _), (other, _) = (env.reset(seed=7) for env in both)
    assert one.tolist() == other.tolist() and np.abs(one).max() < 2.0
    assert one.tolist() != both[0].reset(seed=8)[0].tolist()
    action = both[0].action_space.sample()
    assert both[0].reset(seed=7)[0].tolist() == one.tolist()
    assert both[0].step(action)[0].tolist() == both[1].step(action)[0].tolist()


def test_numbers_are_those_of_si_units_but_for_their_scale():
    near, si = (TransportEnv(goal_m=(0.05, -0.02), is_normalised=one) for one in (True, False))
    for env in (near, si):
        env.reset(seed=1)
        for _ in range(20):
            found = env.step(np.linspace(1.0, -1.0, 8))
        env.found = found[0]
    # The spring's root is at the radius of the load, and its rest length is 26.3 mm.
    length, speed = 0.0122 + 0.0263, 0.05
    scales = [0.1, 0.1, 1, 1, speed, speed, speed / length, *[length] * 8, *[1] * 8]
    assert np.allclose(near.found * scales, si.found, rtol=1e-12, atol=0.0)
    assert np.abs(si.found[4:7]).max() > 0.0
    x, y, heading = si.simulation.pose
    assert si.found[:4].tolist() == [0.05 - x, -0.02 - y, math.cos(heading), math.sin(heading)]


def test_a_goal_is_a_place_and_a_heading():
    env = TransportEnv(cohaul.gym.T_BLOCK, pushers=[0], goal_m=(0.0, 0.0), goal_heading_rad=0.3, goal_angle_rad=0.1, reward="sparse")
    observation, info = env.reset(seed=1)
    assert abs(info["turn_rad"] - 0.3) < 1e-12 and info["distance_m"] == 0.0
    assert np.allclose(observation[-2:], [math.cos(0.3), math.sin(0.3)])
    still = np.zeros(3)
    assert env.step(still)[1:3] == (0.0, False)
    env.reset(options={"goal_heading_rad": 2.0 * math.pi - 0.05})
    assert env.step(still)[1:3] == (1.0, True)
    env.reset(options={"pose": (0.01, 0.0, 0.25)})
    assert env.simulation.pose == (0.01, 0.0, 0.25)


def test_dense_rewards_add_up_to_the_approach():
    env = TransportEnv(goal_m=(0.05, 0.0))
    observation, info = env.reset(seed=1)
    start, total = info["distance_m"], 0.0
    for _ in range(30):
        _, reward, _, _, info = env.step(np.tile([1.0, 0.0], 4))
        total += reward
    assert total > 0.1 and abs(total - (start - info["distance_m"]) / start) < 1e-12


def test_starts_are_spread_and_keep_out_of_obstacles():
    env = TransportEnv(cohaul.gym.DOORWAY, start_spread_m=0.6, start_spread_rad=1.0)
    poses = np.array([env.reset(seed=seed)[1] and env.simulation.pose for seed in range(30)])
    assert np.ptp(poses, axis=0).min() > 0.8
    corners = np.hypot(poses[:, 0] - 0.9, np.abs(poses[:, 1]) - 0.25)
    # No crate's inscribed circle overlaps a post.
    assert corners.min() > 0.15 + 0.06


def test_pictures_show_the_load_where_it_is():
    pytest.importorskip("pygame")
    from cohaul._draw import LOAD

    for name in NAMES:
        env = gymnasium.make(f"cohaul/{name}-v0", render_mode="rgb_array")
        env.reset(seed=1)
        first = env.render()
        assert first.shape == (480, 640, 3) and first.dtype == np.uint8
        share = (first == LOAD).all(axis=2).mean()
        assert 0.001 < share < 0.5, (name, share)
        env.close()
    env = TransportEnv(goal_m=(0.3, 0.0), render_mode="rgb_array")
    centres = []
    for x in (0.0, 0.2):
        env.reset(options={"pose": (x, 0.0, 0.0)})
        env._painter = None if x == 0.0 else env._painter
        if x == 0.0:
            env.render()
        env._painter.see(np.array([[-0.1, -0.1], [0.4, 0.1]]))
        centres.append(np.argwhere((env.render() == LOAD).all(axis=2)).mean(axis=0)[1])
    # 0.5 m are 560 pixels.
    assert abs(centres[1] - centres[0] - 0.2 / 0.5 * 560) < 2.0


@pytest.mark.parametrize(
    ("arguments", "error", "rule"),
    [
        ({"reward": "shaped"}, ValueError, "reward: must be 'dense' or 'sparse', found 'shaped'"),
        ({"render_mode": "ansi"}, ValueError, "render_mode: must be"),
        ({"goal_m": (0.1,)}, ValueError, "goal_m: must be 2 finite numbers"),
        ({"goal_m": (0.1, math.nan)}, ValueError, "goal_m: must be 2 finite numbers"),
        ({"goal_distance_m": 0.0}, ValueError, "goal_distance_m: must be a positive finite number"),
        ({"max_speed_m_per_s": None}, TypeError, "max_speed_m_per_s: must be a number"),
        ({"start_spread_m": -1.0}, ValueError, "start_spread_m, start_spread_rad: must be numbers from 0"),
        ({"pushers": [0]}, ValueError, "pushers"),
    ],
)
def test_wrong_arguments_are_refused(arguments, error, rule):
    with pytest.raises(error, match=rule.replace("(", r"\(")):
        TransportEnv(**arguments)


@pytest.mark.parametrize(
    ("options", "rule"),
    [
        ({"goal": (0.1, 0.0)}, "options: must have the keys goal_m, goal_heading_rad and pose, found goal"),
        ({"pose": (0.1, 0.0)}, "options.pose: must be 3 finite numbers"),
        ({"goal_m": "there"}, "options.goal_m: must be 2 finite numbers"),
        ({"goal_heading_rad": 0.1}, "options.goal_heading_rad: must be a number where the environment has one"),
    ],
)
def test_wrong_options_are_refused(options, rule):
    with pytest.raises(ValueError, match=rule):
        TransportEnv().reset(options=options)


@pytest.mark.parametrize("name", NAMES)
def test_an_episode_is_a_scenario_and_a_controller(name):
    """The same motion in the environment and under a run's controller, but for the rounding of times."""
    for backend in cohaul.BACKENDS:
        env = gymnasium.make(f"cohaul/{name}-v0", backend=backend).unwrapped
        weights = np.random.default_rng(5).normal(0.0, 0.4, (env.action_space.shape[0], env.observation_space.shape[0]))
        policy = lambda seen: np.tanh(weights @ seen)  # noqa: E731, B023
        scenario, make = env.episode(policy, seed=3)
        short = scenario.replace(duration_s=30 * scenario.control_period_s)
        run = cohaul.run(short, backend, controller=make(3))
        observation, _ = env.reset(seed=3)
        for row in range(run.trace.n_rows - 1):
            pose = [run.trace[column][row] for column in ("x_m", "y_m", "heading_rad")]
            assert np.allclose(env.simulation.pose, pose, rtol=0.0, atol=1e-9), (backend, row)
            observation, *_ = env.step(policy(observation))
        assert run.trace.n_rows > 20 and (name == "PushT" or pose[0] != run.trace["x_m"][0])
