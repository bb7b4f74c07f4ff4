"""Scenarios, traces, controllers and the environment."""

from __future__ import annotations

import pickle
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import SCENES

import cohaul


def tow(seed: int):
    """Tows the load along x at 5 mm/s, and releases it at 10 mm."""

    def control(view: cohaul.View):
        if view.time_s == 0.0:
            view.attach(0, (0.0, 0.0))
        elif view.attached[0] and view.pose[0] >= 0.01:
            view.release(0)
            view.finish()
        return [(0.005 * (view.time_s + view.control_period_s), 0.0)]

    return control


def test_all_faults_come_in_one_exception() -> None:
    with pytest.raises(cohaul.ScenarioError) as caught:
        cohaul.Scenario(SCENES / "analytic/slide.json", duration_s=-1.0, load={"mass_kg": -2.0, "radius_m": 0.01}, extra=1)
    faults = {fault.path: fault for fault in caught.value.faults}
    assert faults["duration_s"] == ("duration_s", "must be positive", "-1.0")
    assert faults["load.mass_kg"].value == "-2.0" and "unknown key" in faults["extra"].rule
    assert pickle.loads(pickle.dumps(caught.value)).faults == caught.value.faults
    with pytest.raises(cohaul.ScenarioError) as caught:
        cohaul.Scenario(SCENES / "analytic/slide.json", duration_s=float("nan"))
    assert caught.value.faults == [("duration_s", "must be a finite number", "nan")]


def test_scenarios_from_dicts_files_and_keywords_are_equal(four_ants: Path, tmp_path: Path) -> None:
    from_file = cohaul.Scenario(four_ants)
    assert cohaul.Scenario(from_file.to_dict()).to_dict() == from_file.to_dict()
    assert cohaul.Scenario(from_file.to_dict(expanded=False)) == from_file == pickle.loads(pickle.dumps(from_file))
    from_file.save(tmp_path / "copy.json")
    assert cohaul.Scenario(tmp_path / "copy.json").sha256 == from_file.sha256
    damped = from_file.replace({"springs[2].damping_ratio": 0.5})
    assert [spring.get("damping_ratio", 0.0) for spring in damped.to_dict()["springs"]] == [0.0, 0.0, 0.5, 0.0]
    arrays = cohaul.Scenario(from_file, load={"mass_kg": np.float64(0.0016), "radius_m": np.array(0.0122)})
    assert arrays == from_file
    with pytest.raises(KeyError):
        from_file.replace({"springs[9].damping_ratio": 0.5})


def test_all_scenes_of_the_project_come_with_the_package() -> None:
    files = {path.relative_to(SCENES).with_suffix("").as_posix() for path in SCENES.glob("*/*.json")}
    assert files == set(cohaul.SCENES) and len(cohaul.SCENES) == len(files)
    for name in cohaul.SCENES:
        assert cohaul.Scenario.shipped(name) == cohaul.Scenario(SCENES / f"{name}.json"), name
    with pytest.raises(KeyError, match="found 'contact/pushr'; 'contact/pusher' is near"):
        cohaul.Scenario.shipped("contact/pushr")


def test_columns_are_read_in_place_and_outlive_the_run(pulled: Path) -> None:
    run = cohaul.run(pulled, step_s=1e-3)
    x, again = run.trace["x_m"], run.trace._data.column("x_m")
    assert not x.flags.owndata and not x.flags.writeable
    # The same memory: no copy was made.
    assert np.asarray(again).ctypes.data == x.ctypes.data
    with pytest.raises(ValueError):
        x.setflags(write=True)
    expected = x.copy()
    assert run.trace["pulls_n"].shape == (len(x), 1, 2)
    del run, again
    assert np.array_equal(x, expected) and x[-1] == pytest.approx(0.0669, abs=1e-4)


def test_tables_and_pages(pulled: Path, tmp_path: Path) -> None:
    run = cohaul.run(pulled)
    for frame in [run.to_pandas(), run.to_polars()]:
        assert frame["x_m"].to_numpy().tolist() == run.trace["x_m"].tolist()
        assert frame["pull_x_0_n"].to_numpy()[-1] == run.trace["pulls_n"][-1, 0, 0]
    assert "<svg" in run._repr_html_()
    assert run.report(tmp_path / "run.html").startswith("<!DOCTYPE html>") and (tmp_path / "run.html").stat().st_size > 10_000
    compared = cohaul.compare(SCENES / "analytic/release-jump.json")
    assert "<svg" in compared.report() and "<table>" in compared._repr_html_() and "<iframe" in compared.replay()._repr_html_()
    compared.save(tmp_path / "out")
    assert (tmp_path / "out/summary.json").exists()
    assert compared.trace("rapier")["x_m"][-1] != compared.trace("inertial")["x_m"][-1]
    sweep = cohaul.sweep(pulled, {"load.mass_kg": [0.001, 0.002]}, seeds=1)
    assert sweep.to_pandas().shape == sweep.to_polars().shape == (2, len(sweep))


def test_a_missing_library_is_named(pulled: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run = cohaul.run(pulled, trace=False)
    for name in ["pandas", "polars"]:
        monkeypatch.setitem(sys.modules, name, None)
        with pytest.raises(ImportError, match=f"pip install {name}"):
            getattr(run, f"to_{name}")()


def test_a_controller_runs_on_all_backends(pulled: Path) -> None:
    for backend in cohaul.BACKENDS:
        run = cohaul.run(pulled, backend, step_s=1e-3, controller=tow(1))
        # The tip is mu m g / k = 33 mm ahead of the load, so that it moves 43 mm, in 8.6 s.
        assert [event.kind for event in run.events] == ["grasp", "release"]
        assert run.events[1].time_s == pytest.approx(8.62, abs=0.02) and run["arrived"] is True
    compared = cohaul.compare_controller(pulled, tow, seeds=2, step_s=1e-3)
    assert compared.tiers["replayed"]["verdicts"]["heading"]["verdict"] == "agree"
    assert set(compared.tiers) == {"replayed", "closed_loop"} and compared["seed"] == 1


def test_the_step_loop_equals_the_run_of_a_controller(pulled: Path) -> None:
    scenario = cohaul.Scenario(pulled, duration_s=2.0)
    for backend in cohaul.BACKENDS:
        run = cohaul.run(scenario, backend, step_s=1e-3, controller=lambda view: circle(view))
        sim = cohaul.Simulation(scenario, backend, step_s=1e-3)
        for row in range(run.trace.n_rows - 1):
            assert sim.pose == tuple(run.trace[name][row] for name in ["x_m", "y_m", "heading_rad"]), (backend, row)
            time = float(run.trace["time_s"][row])
            sim.advance(circle(sim, time), float(run.trace["time_s"][row + 1]) - time)


def circle(sim, time: float | None = None) -> list[tuple[float, float]]:
    """Tips on a circle, by the same function in the loop and in a controller."""
    time = sim.time_s if time is None else time
    if time == 0.0:
        sim.attach(0, (0.0, 0.0))
    return [(0.05 * np.sin(2.0 * (time + 0.001)), 0.05 - 0.05 * np.cos(2.0 * (time + 0.001)))]


def test_a_saved_state_continues_to_the_bit(pulled: Path) -> None:
    for backend in cohaul.BACKENDS:
        sim, other = (cohaul.Simulation(pulled, backend, step_s=1e-3) for _ in range(2))
        sim.attach(0, (0.0, 0.0))
        for tick in range(1, 500):
            if tick == 300:
                other.load(sim.save())
            for one in (sim, other) if tick >= 300 else (sim,):
                assert one.advance([(2e-4 * tick, 1e-5 * tick)], 1e-3) == "converged"
        assert (sim.pose, sim.twist, sim.time_s, sim.steps) == (other.pose, other.twist, other.time_s, other.steps)
        assert sim.pose[0] > 0.01 and np.array_equal(sim.pulls, other.pulls)


def test_gymnasium_accepts_the_environment() -> None:
    gymnasium = pytest.importorskip("gymnasium")
    from gymnasium.utils.env_checker import check_env

    import cohaul.gym

    for backend in cohaul.BACKENDS:
        check_env(gymnasium.make("cohaul/Transport-v0", backend=backend).unwrapped, skip_render_check=True)
    environments = gymnasium.make_vec("cohaul/Transport-v0", num_envs=4, backend="inertial", goal_m=(0.05, 0.0))
    observations, _ = environments.reset(seed=3)
    # All tips move towards the goal: the load arrives, which ends the episode.
    action, total, ended = np.tile([1.0, 0.0], (4, 4)).astype(np.float32), np.zeros(4), np.zeros(4, bool)
    for _ in range(100):
        observations, rewards, terminated, _, info = environments.step(action)
        total += np.where(ended, 0.0, rewards)
        ended |= terminated
    assert ended.all() and (total > 0.75).all() and np.isfinite(observations).all()
