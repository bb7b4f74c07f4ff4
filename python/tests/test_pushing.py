"""Steered obstacles, what controllers see, and many rollouts in one call."""

from __future__ import annotations

import math
import runpy
from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT, SCENES

import cohaul
from cohaul import _native
from cohaul._options import as_json

PUSHER = SCENES / "contact/pusher.json"


@pytest.fixture(scope="module")
def example() -> dict:
    return runpy.run_path(str(ROOT / "examples/push_to_goal.py"))


@pytest.mark.parametrize("backend", cohaul.BACKENDS)
def test_the_example_has_the_numbers_of_rust_to_the_bit(backend: str, example: dict) -> None:
    run = cohaul.run(example["SCENE"], backend, controller=example["push"](1))
    columns = [run.trace[name].tolist() for name in ["time_s", "x_m", "y_m", "heading_rad"]]
    rust = _native.rust_push(example["SCENE"]._scene, as_json({"backend": backend}))
    assert list(zip(*columns)) == rust
    assert example["missed"](run.trace) < 1.1e-3
    # The trace has the pusher where it was steered, not on the path of the scenario.
    assert run.trace["obstacles"].shape == (len(rust), 1, 3)
    behind = np.hypot(run.trace["obstacles"][:, 0, 0] - run.trace["x_m"], run.trace["obstacles"][:, 0, 1] - run.trace["y_m"])
    assert (behind > 0.0172 - 1e-6).all() and behind[-1] < 0.0173
    assert run.trace["contact_forces_n"].max() > 0.01 and "obstacle_x_0_m" in run.trace._flat()


@pytest.mark.parametrize("backend", cohaul.BACKENDS)
def test_a_loop_of_steps_is_the_run_of_a_controller(backend: str) -> None:
    """The slip limit is the force of a pusher, and the friction of the supports balances it."""
    seen = []

    def control(view: cohaul.View) -> None:
        seen.append((view.pose, view.obstacles, view.contact_forces, view.friction_forces, view.contacts))
        view.steer(0, (view.obstacles[0, 0] + 2e-5, 1e-3, 0.1))

    run = cohaul.run(PUSHER, backend, controller=control)
    sim = cohaul.Simulation(PUSHER, backend)
    for pose, obstacles, forces, friction, contacts in seen:
        # The ticks of a run are rounded otherwise than a sum of periods.
        assert np.allclose(sim.pose, pose, atol=1e-9) and np.allclose(sim.obstacles, obstacles, atol=1e-12)
        assert np.allclose(sim.contact_forces, forces, atol=1e-6) and np.allclose(sim.friction_forces, friction, atol=1e-6)
        assert [contact[0] for contact in sim.contacts] == [contact[0] for contact in contacts]
        status = sim.advance([], 0.001, {0: (sim.obstacles[0, 0] + 2e-5, 1e-3, 0.1)})
        assert status == "converged"
    assert abs(sim.pose[0] - run.trace["x_m"][-1]) < 1e-9 and sim.pose[0] > 0.01
    assert np.allclose(sim.obstacles[0], run.trace["obstacles"][-1, 0], atol=1e-12)
    # The load of an engine in single precision may leave the pusher for a step.
    assert len(sim.contacts) == 1 or backend == "rapier"
    assert np.allclose(sum(np.array(force) for _, _, force in sim.contacts), sim.contact_forces[0])
    assert (np.hypot(*run.trace["contact_forces_n"][:, 0].T) > 0.5 * sim.scenario.slip_limit_n).mean() > 0.8
    if backend == "quasi-static":
        balance = sim.contact_forces.sum(axis=0) + sim.friction_forces.sum(axis=0)
        assert np.abs(balance).max() < 1e-9 and np.hypot(*sim.contact_forces[0]) > 0.5 * sim.scenario.slip_limit_n


@pytest.mark.parametrize("backend", cohaul.BACKENDS)
def test_a_state_is_restored(backend: str) -> None:
    scenario = SCENES / "robots/two-fingers.json"
    sim = cohaul.Simulation(scenario, backend)
    period = sim.control_period_s
    for _ in range(40):
        sim.advance(sim.tips, period)
    state = sim.state
    ends = []
    for again in (cohaul.Simulation(scenario, backend), cohaul.Simulation(scenario, backend)):
        again.state = state
        # Without inertia the twist is that of the last step, and not a part of the state.
        is_kept = np.ones(state.size, dtype=bool)
        is_kept[4:7] = backend != "quasi-static"
        assert (again.state == state)[is_kept].all() and again.time_s == sim.time_s
        # A saved state of it continues to the bit.
        other = cohaul.Simulation(scenario, backend)
        other.load(again.save())
        for each in (again, other):
            for _ in range(40):
                each.advance(each.tips, period)
        assert (again.state == other.state).all()
        ends.append(again.state)
    assert (ends[0] == ends[1]).all()
    for _ in range(40):
        sim.advance(sim.tips, period)
    # It goes on along the path of the scenario; the engine's contacts begin anew.
    assert np.abs(sim.state - ends[0])[[0, 1, 2, 3]].max() < (1e-4 if backend == "rapier" else 1e-7)


def test_a_pose_is_set(pulled: Path) -> None:
    sim = cohaul.Simulation(pulled, "inertial")
    sim.attach(0, (0.0, 0.0))
    for tick in range(1, 101):
        sim.advance([(5e-4 * tick, 0.0)], 1e-3)
    sim.set_pose((0.04, -0.01, 0.3))
    assert sim.pose == (0.04, -0.01, 0.3) and sim.twist == (0.0, 0.0, 0.0)
    assert sim.attached == [True] and sim.tips.tolist() == [[0.05, 0.0]] and abs(sim.time_s - 0.1) < 1e-12


def test_rollouts_are_the_loops_that_they_replace() -> None:
    scenario = cohaul.Scenario(PUSHER)
    n, periods = 7, 30
    headings = np.linspace(-0.5, 0.5, n)
    starts = np.array([0.002, 0.001, 0.0]) + np.zeros((n, 3))
    pushes = np.zeros((n, periods, 3))
    pushes[:, :, 0] = -0.0172 + 1e-4 * np.arange(1, periods + 1)
    pushes[:, :, 1] = 1e-4 * headings[:, None] * np.arange(1, periods + 1)
    for backend in cohaul.BACKENDS:
        found = cohaul.rollouts(scenario, backend, poses=starts, pushers={0: pushes}, threads=2)
        assert found.poses.shape == (n, periods + 1, 3) and found.twists.shape == found.poses.shape
        assert found.pulls.shape == (n, periods, 0, 2) and found.contact_forces.shape == (n, periods, 1, 2)
        assert (found.statuses == 0).all() and len(found) == n
        for which in range(n):
            sim = cohaul.Simulation(scenario, backend)
            sim.set_pose(starts[which])
            for period in range(periods):
                assert sim.pose == tuple(found.poses[which, period])
                sim.advance([], scenario.control_period_s, {0: pushes[which, period]})
                assert (sim.contact_forces == found.contact_forces[which, period]).all()
            assert (sim.state == found.states[which]).all() and sim.twist == tuple(found.twists[which, -1])
        # The rollouts differ, and go on from their ends.
        assert len({tuple(pose) for pose in found.poses[:, -1]}) == n
        on = cohaul.rollouts(scenario, backend, states=found.states, pushers={0: pushes[:, -1:]})
        assert on.poses.shape == (n, 2, 3) and (on.poses[:, 0] == found.poses[:, -1]).all()


def test_rollouts_move_and_release_tips(four_ants: Path) -> None:
    sim = cohaul.Simulation(SCENES / "paper/four-tips-held.json")
    for spring in range(sim.n_springs):
        sim.attach(spring, (0.0385 * math.cos(spring), 0.0385 * math.sin(spring)))
    tips = np.tile(sim.tips, (5, 1, 1)) + 1e-4 * np.arange(1, 6)[:, None, None]
    tips[3:, 0] = np.nan
    found = cohaul.rollouts(sim.scenario, states=sim.state, tips=np.stack([tips, tips]))
    for period in range(5):
        if period == 3:
            sim.release(0)
        sim.advance(np.nan_to_num(tips[period]), sim.control_period_s)
        assert (found.pulls[1, period] == sim.pulls).all() and tuple(found.poses[0, period + 1]) == sim.pose
    assert (found.pulls[:, 3:, 0] == 0.0).all() and (found.pulls[:, :3, 0] != 0.0).any()
    held = cohaul.rollouts(sim.scenario, states=found.states, n_periods=3)
    assert np.allclose(held.states[:, 7:], found.states[:, 7:])


def test_rollouts_of_seeds_are_runs(four_ants: Path) -> None:
    periods = 4000
    found = cohaul.rollouts(four_ants, seeds=[3, 4], n_periods=periods)
    scenario = cohaul.Scenario(four_ants, duration_s=periods * cohaul.Scenario(four_ants).control_period_s)
    for which, seed in enumerate([3, 4]):
        run = cohaul.run(scenario, seed=seed)
        assert (found.poses[which, :, 0] == run.trace["x_m"]).all()
    assert (found.poses[0] != found.poses[1]).any() and np.isnan(found.states).all()


@pytest.mark.parametrize(
    "arguments, error, words",
    [
        ({"pushers": {1: np.zeros((3, 3))}}, ValueError, "pushers: must be from 0 to 0, found 1"),
        ({"pushers": [np.zeros((3, 3))]}, TypeError, "pushers: must be a mapping"),
        ({"pushers": {0: np.zeros((3, 2))}}, ValueError, r"pushers\[0\]: must have the shape \(rollouts, periods, 3\)"),
        ({"pushers": {0: np.full((3, 3), np.nan)}}, ValueError, r"pushers\[0\]: must be finite"),
        ({"poses": np.zeros((2, 3)), "pushers": {0: np.zeros((4, 3, 3))}}, ValueError, r"poses, pushers\[0\]: must have one number of rollouts, found 2, 4"),
        ({"states": np.zeros(3)}, ValueError, r"states: must have the shape \(rollouts, 11\)"),
        ({"states": [0.0, -0.0172] + [0.0] * 9}, ValueError, r"states\[0\]: must have the load outside of the obstacle"),
        ({"states": [0.0] * 7 + [0.5, 9.0, 9.0, 0.0]}, ValueError, r"states\[0\]: must say 0 or 1 of springs and obstacles, found 0.5"),
        ({"tips": "x"}, TypeError, "tips: must be an array of numbers"),
        ({"seeds": [1], "poses": np.zeros(3)}, ValueError, "seeds: must come without"),
        ({"n_periods": 0}, ValueError, "n_periods: must be from 1"),
    ],
)
def test_wrong_arrays_are_named(arguments: dict, error: type, words: str) -> None:
    with pytest.raises(error, match=words):
        cohaul.rollouts(PUSHER, **arguments)


def test_wrong_poses_are_named() -> None:
    sim = cohaul.Simulation(PUSHER)
    for pushers, error in [({0: (0.0, 0.0)}, TypeError), ({0: (0.0, math.nan, 0.0)}, ValueError), ({2: (0.0, 0.0, 0.0)}, ValueError), ({"a": (0.0, 0.0, 0.0)}, TypeError)]:
        with pytest.raises(error, match="pushers|obstacle"):
            sim.advance([], 0.001, pushers)
    assert sim.time_s == 0.0
    with pytest.raises(ValueError, match="pose: must have the load outside of the obstacle 'pusher'|inside"):
        sim.set_pose((-0.0172, 0.0, 0.0))
    with pytest.raises(ValueError, match="state: must have 11 numbers, found 2"):
        sim.state = [1.0, 2.0]

    def twice(view: cohaul.View) -> None:
        view.steer(0, (0.0, 0.0, 0.0))
        view.steer(0, (0.0, 0.0, 0.0))

    with pytest.raises(ValueError, match="obstacle: must be steered once"):
        cohaul.run(PUSHER, controller=twice)


def test_the_verdict_under_feedback_has_a_measure_of_ones_own(example: dict) -> None:
    measure = cohaul.Measure("distance to the goal", "m", example["missed"], tolerance=1e-3)
    found = cohaul.compare_controller(example["SCENE"], example["push"], tiers="controlled", measure=measure, halvings=2)
    own = found.verdicts["measure"]
    assert list(found.tiers) == ["controlled"] and own["decided_by"] == "distance to the goal"
    assert own["verdict"] == "agree" and own["tolerance"] == 1e-3 and own["unit"] == "m"
    assert {"path", "heading", "pulls", "contacts", "measure"} <= set(found.verdicts)
    inertial = found.trace("inertial")
    assert own["measures"][0]["inertial"] == example["missed"](inertial)
    assert (inertial["obstacles"][-1] != found.trace("quasi-static")["obstacles"][-1]).any()
    assert "distance to the goal" in found.report()
    with pytest.raises(ValueError, match="measure: must return a finite number, found nan"):
        cohaul.compare_controller(example["SCENE"], example["push"], tiers="controlled", measure=cohaul.Measure("no number", "1", lambda _: math.nan))
    with pytest.raises(ValueError, match="tiers: must be replayed, closed-loop or controlled"):
        cohaul.compare_controller(example["SCENE"], example["push"], tiers="prescribed")


def test_gymnasium_steers_pushers() -> None:
    import gymnasium

    import cohaul.gym  # noqa: F401

    env = gymnasium.make("cohaul/Transport-v0", scenario=str(PUSHER), pushers=[0], goal_m=(0.02, 0.0), max_speed_m_per_s=0.05, is_normalised=False)
    observation, _ = env.reset(seed=1)
    assert observation.shape == (13,) and observation[7:9].tolist() == [-0.0172, 0.0] and observation[9:11].tolist() == [1.0, 0.0]
    terminated, n_steps = False, 0
    while not terminated and n_steps < 400:
        observation, reward, terminated, _, _ = env.step(np.array([1.0, 0.0, 0.0], dtype=np.float32))
        n_steps += 1
    # The goal's radius is 10 mm, and the pusher goes 0.05 mm in each period.
    assert terminated and abs(n_steps - 200) <= 2 and reward > 0.0
    assert abs(math.hypot(*observation[11:13]) - 1.0) < 1e-6


BOX = {
    "name": "a box before a hand", "duration_s": 1.2, "control_period_s": 0.005, "springs": [],
    "load": {"mass_kg": 1.0, "outline": {"rectangle": {"size_m": [0.2, 0.1]}}, "side_friction_coefficient": 0.2},
    "ground": {"friction_coefficient": 0.3, "supports": {"uniform": {"n": 4}}},
    "obstacles": [
        {"name": "hand", "outline": {"disc": {"radius_m": 0.02}}, "position_m": [-0.125, 0.0], "friction_coefficient": 0.2},
        {
            "name": "conveyor", "outline": {"disc": {"radius_m": 0.02}},
            "path": {"waypoints": [[0.0, 1.0, 1.0, 0.0], [1.0, 1.0, 1.0, 0.0], [2.0, 2.0, 1.0, 0.0]]},
        },
    ],
    "drive": {"kind": "tips", "paths": []},
}  # fmt: skip


@pytest.mark.parametrize("backend", cohaul.BACKENDS)
def test_a_hand_stays_behind_by_the_resistance_over_the_stiffness(backend: str) -> None:
    """With inertia the box swings about that: x = v t - (v / w) sin(w t) since the slip onset."""
    scenario = cohaul.Scenario(BOX | {"duration_s": 0.95})
    onset = 0.1 + scenario.slip_limit_n / 100.0 / 0.05

    def control(view: cohaul.View) -> None:
        until = view.time_s + view.control_period_s
        view.steer(0, cohaul.Hand((-0.125 + 0.05 * until, 7.0), (2.0, 0.0), 100.0))

    trace = cohaul.run(scenario, backend, controller=control).trace
    since = np.maximum(trace["time_s"] - onset, 0.0)
    swing = 0.0 if backend == "quasi-static" else 0.005 * np.sin(10.0 * since)
    missed = np.abs(trace["x_m"] - (0.05 * since - swing))
    # Of first order in the period with inertia.
    assert missed.max() < (1e-8 if backend == "quasi-static" else 3e-4)
    assert trace["x_m"][-1] > 5e-3 - (0.0 if backend == "quasi-static" else 4.5e-3)


def test_a_hand_that_cannot_push_changes_nothing() -> None:
    sim = cohaul.Simulation(BOX, "inertial")
    hand = cohaul.Hand((0.0, 0.0), stiffness_n_per_m=100.0)
    assert sim.advance([], 0.1, pushers={0: hand}) == "converged" and sim.pose[0] > 0.01
    sim.advance([], 0.9, pushers={0: sim.obstacles[0]})
    before = sim.save()
    with pytest.raises(ValueError, match="hand: must be the only obstacle that moves, found that obstacle 1 moves as well"):
        sim.advance([], 0.1, pushers={0: hand})
    assert sim.save() == before
    with pytest.raises(ValueError, match="hand: must be the only one at an instant, found obstacles 0 and 1"):
        sim.advance([], 0.1, pushers={0: hand, 1: hand})
    for wrong, error in [
        ({"axis": (0.0, 0.0)}, "axis: must have a length above 0"),
        ({"stiffness_n_per_m": 0.0}, "stiffness_n_per_m: must be above 0 and finite"),
        ({"force_limit_n": math.nan}, "force_limit_n: must be at least 0"),
    ]:
        with pytest.raises(ValueError, match=error):
            cohaul.Hand((0.0, 0.0), **wrong)
    for wrong in [(0.0, 0.0, 0.0), "12", {1: 2, 3: 4}, 5.0]:
        with pytest.raises(TypeError, match="target_m: must be two numbers"):
            cohaul.Hand(wrong)  # type: ignore[arg-type]
    assert cohaul.Hand((0.0, 0.0), stiffness_n_per_m=np.float32(100)) == cohaul.Hand((0.0, 0.0))
    with pytest.raises(ValueError, match="stiffness_n_per_m: must be a number of double precision"):
        cohaul.Hand((0.0, 0.0), stiffness_n_per_m=10**400)
    with pytest.raises(ValueError, match="found that obstacle 1 moves as well"):
        moving = {**BOX["obstacles"][1], "path": {"waypoints": [[0.0, 1.0, 1.0, 0.0], [1.0, 2.0, 1.0, 0.0]]}}
        cohaul.run(BOX | {"obstacles": [BOX["obstacles"][0], moving]}, controller=lambda view: view.steer(0, hand))
