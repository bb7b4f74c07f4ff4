"""Results in other processes and files: the same to the bit."""

from __future__ import annotations

import copy
import multiprocessing
import pickle
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest
from conftest import ROOT, SCENES

import cohaul

PULL = SCENES / "analytic/centre-pull.json"


def same_trace(one: cohaul.Trace, other: cohaul.Trace) -> None:
    assert list(one) == list(other) and one.n_rows == other.n_rows
    for name in one:
        a, b = one[name], other[name]
        assert a.shape == b.shape and a.tobytes() == b.tobytes() and not b.flags.writeable, name


def test_a_run_travels(tmp_path) -> None:
    found = cohaul.run(SCENES / "analytic/release-jump.json", "inertial")
    again = pickle.loads(pickle.dumps(found))
    assert again.results == found.results and again.report() == found.report() and again.overview() == found.overview()
    assert again.events == found.events and again.transitions == found.transitions and repr(again) == repr(found)
    same_trace(found.trace, again.trace)
    # Once more, and copies.
    for third in (pickle.loads(pickle.dumps(again)), copy.copy(found), copy.deepcopy(again)):
        same_trace(found.trace, third.trace)
        assert third.report() == found.report()
    same_trace(found.trace, pickle.loads(pickle.dumps(found.trace)))
    brief = cohaul.run(PULL, trace=False)
    assert pickle.loads(pickle.dumps(brief)).results == brief.results


def test_a_comparison_travels_with_its_files(tmp_path) -> None:
    found = cohaul.compare(PULL)
    again = pickle.loads(pickle.dumps(found))
    assert again.results == found.results and again.verdicts == found.verdicts
    for backend in cohaul.BACKENDS:
        same_trace(found.trace(backend), again.trace(backend))
    assert again.overview() == found.overview() and again.replay().page == found.replay().page
    found.save(tmp_path / "one")
    again.save(tmp_path / "other")
    names = sorted(path.name for path in (tmp_path / "one").iterdir())
    assert names == sorted(path.name for path in (tmp_path / "other").iterdir()) and "report.html" in names
    for name in names:
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "other" / name).read_bytes(), name
    with pytest.raises(ValueError, match="trace: must be of prescribed, quasi-static or of .*, found prescribed, bullet"):
        again.trace("bullet")
    (tmp_path / "else").mkdir()
    (tmp_path / "else" / "thesis.txt").write_text("mine")
    with pytest.raises(OSError, match="must have no files but those of an earlier output, found thesis.txt"):
        again.save(tmp_path / "else")
    assert [path.name for path in (tmp_path / "else").iterdir()] == ["thesis.txt"]


def test_other_results_travel(tmp_path) -> None:
    table = cohaul.conformance("quasi-static")
    again = pickle.loads(pickle.dumps(table))
    assert (again.text, again.markdown, again.html, again.grades) == (table.text, table.markdown, table.html, table.grades)
    measured = cohaul.measured(str(ROOT / "data/measured/pushes.csv"), ROOT / "data/measured/block.json", engine=None)
    again = pickle.loads(pickle.dumps(measured))
    assert again.runs == measured.runs and again.text == measured.text and again.report() == measured.report()
    rows = cohaul.sweep(PULL, {"load.mass_kg": [1e-3, 2e-3]})
    again = pickle.loads(pickle.dumps(rows))
    assert again.csv == rows.csv and all(again[name].tolist() == rows[name].tolist() for name in ("x_m", "load.mass_kg"))
    many = cohaul.rollouts(PULL, "inertial", tips=np.zeros((3, 5, 1, 2)))
    again = pickle.loads(pickle.dumps(many))
    assert all(getattr(again, name).tobytes() == getattr(many, name).tobytes() for name in ("poses", "twists", "pulls", "statuses", "states"))


@pytest.mark.parametrize("backend", cohaul.BACKENDS)
def test_a_simulation_goes_on_elsewhere_to_the_bit(backend) -> None:
    sim = cohaul.Simulation(PULL, backend, step_s=5e-4)
    sim.attach(0, (0.0, 0.0))
    for tick in range(1, 301):
        sim.advance([(1e-4 * tick, 2e-5 * tick)], 1e-3)
    others = [pickle.loads(pickle.dumps(sim)), copy.copy(sim), copy.deepcopy(sim)]
    for one in [sim, *others]:
        for tick in range(301, 401):
            one.advance([(1e-4 * tick, 2e-5 * tick)], 1e-3)
    assert all(one.pose == sim.pose and one.twist == sim.twist and one.energy == sim.energy for one in others)
    assert others[0].scenario == sim.scenario and others[0].backend == backend and sim.pose[0] > 0.001


def test_an_environment_goes_on_elsewhere_to_the_bit() -> None:
    pytest.importorskip("gymnasium")
    from cohaul.gym import PUSH_T, TransportEnv

    env = TransportEnv(**PUSH_T)
    env.reset(seed=4)
    for _ in range(10):
        env.step(np.array([0.0, -1.0, 0.0]))
    other = pickle.loads(pickle.dumps(env))
    for _ in range(20):
        a, b = env.step(np.array([0.2, -1.0, 0.5])), other.step(np.array([0.2, -1.0, 0.5]))
        assert a[0].tolist() == b[0].tolist() and a[1:] == b[1:]
    assert env.reset()[0].tolist() == other.reset()[0].tolist()


def far(step_s: float) -> cohaul.Run:
    return cohaul.run(PULL, "inertial", step_s=step_s)


def test_workers_return_runs() -> None:
    steps = [1e-3, 5e-4]
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as pool:
        for found, step_s in zip(pool.map(far, steps), steps):
            same_trace(found.trace, far(step_s).trace)
    joblib = pytest.importorskip("joblib")
    for found, step_s in zip(joblib.Parallel(n_jobs=2)(joblib.delayed(far)(step_s) for step_s in steps), steps):
        same_trace(found.trace, far(step_s).trace)


def test_another_version_is_refused(tmp_path) -> None:
    from cohaul._kept import Kept

    with pytest.raises(ValueError, match="version: must be 1, that of this package, found 2"):
        Kept({}).__setstate__({"version": 2})
    # A file of another process, which has computed nothing.
    path = tmp_path / "run.pickle"
    path.write_bytes(pickle.dumps(far(1e-3)))
    script = f"import pickle; print(repr(pickle.load(open({str(path)!r}, 'rb'))['final']))"
    printed = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout
    assert printed.strip() == repr(far(1e-3)["final"])
