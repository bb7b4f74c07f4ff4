"""Wrong calls raise exceptions with a message. Nothing aborts, hangs or grows."""

from __future__ import annotations

import gc
import json
import os
import pickle
import random
import signal
import subprocess
import sys
import textwrap
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT, SCENES

import cohaul

WRONG: list[Any] = [
    None, True, -1, 0, 3, 10**30, -0.0, 1e300, float("nan"), float("inf"), 1j, "", "x", "rapier", b"x", (), [], {}, [[1]], [1, 2],
    [(1, 2)], [("a", 2)], [(float("nan"), 0)], [(1e70, 0)], {"a": 1}, {1: 2}, object(), int, np.zeros(2), np.zeros((1, 2)),
    np.zeros((2, 2, 2)), np.array(["a"]), np.array([object()]), [[1.0, 2.0], [3.0]], lambda *_: None, lambda *_: 1 / 0, range(3),
]  # fmt: skip


def test_a_thousand_wrong_calls_raise_exceptions_with_a_message(pulled: Path) -> None:
    luck = random.Random(1)
    scenario = cohaul.Scenario(pulled, duration_s=0.02)
    sim = cohaul.Simulation(scenario, "inertial", step_s=1e-3)
    state = sim.save()
    pick = lambda: luck.choice(WRONG)  # noqa: E731
    options = ["step_s", "tolerance_m", "seed", "backend", "rapier", "no_skip", "controller", "progress", "integrator", "second_order"]
    calls = [
        lambda: sim.attach(pick(), pick()),
        lambda: sim.release(pick()),
        lambda: sim.advance(pick(), pick()),
        lambda: sim.advance(pick(), 1e-3),
        lambda: sim.load(luck.choice([pick(), state[: luck.randrange(len(state))], state.replace("0.0", str(pick()))])),
        lambda: cohaul.Scenario(pick()),
        lambda: cohaul.Scenario(scenario, **{luck.choice(["load", "springs", "drive", "duration_s", "seed", "name", "more"]): pick()}),
        lambda: scenario.replace({luck.choice(["load.mass_kg", "springs[0]", "a[b]", "", pick()]): pick()}),
        lambda: cohaul.Simulation(scenario, pick(), step_s=pick()),
        lambda: cohaul.run(scenario, **{luck.choice(options): pick()}),
        lambda: cohaul.run(pick(), pick()),
        lambda: cohaul.run(scenario, controller=lambda view: pick()),
        lambda: cohaul.run(scenario, controller=lambda view: view.attach(pick(), pick())),
        lambda: cohaul.run(scenario, controller=lambda view: view.release(pick())),
        lambda: cohaul.compare(scenario, **{luck.choice(["tiers", "seeds", "step_s", "threads", "recorded_from", "rapier"]): pick()}),
        lambda: cohaul.compare_controller(scenario, pick(), tiers="replayed"),
        lambda: cohaul.sweep(scenario, {luck.choice(["load.mass_kg", "no.such", pick()]): pick()}, seeds=2, threads=1),
        lambda: cohaul.sweep(scenario, **{luck.choice(["vary", "seeds", "backend", "step_s", "sample", "threads"]): pick()}),
    ]
    raised = []
    while len(raised) < 1000:
        try:
            luck.choice(calls)()
        except Exception as error:
            # A few classes of Python itself carry a bare value.
            assert str(error) and not isinstance(error, cohaul.InternalError), repr(error)
            raised.append(type(error).__name__)
    assert {"ScenarioError", "ValueError", "TypeError"} <= set(raised)
    assert cohaul.run(scenario)["steps"]["status"] == "converged"


def test_calls_in_the_wrong_order_name_the_spring(pulled: Path) -> None:
    sim = cohaul.Simulation(pulled)
    with pytest.raises(ValueError, match="spring: must be attached, found 0, which is free"):
        sim.release(0)
    sim.attach(0, (0.0, 0.0))
    for call, message in [
        (lambda: sim.attach(0, (0.0, 0.0)), "must be free, found 0"),
        (lambda: sim.attach(1, (0.0, 0.0)), "must be from 0 to 0, found 1"),
        (lambda: sim.advance([(0.0, float("nan"))], 1e-3), r"tips\[0\]: must be finite"),
        (lambda: sim.advance([], 1e-3), "one point .* for each of the 1 springs, found 0"),
        (lambda: sim.advance([(0.0, 0.0)], 0.0), "duration_s: must be above 0"),
    ]:
        with pytest.raises(ValueError, match=message):
            call()
    assert sim.advance([(0.0, 0.0)], 1e-3) == "converged"


def test_threads_share_a_simulation_without_harm(pulled: Path) -> None:
    sim = cohaul.Simulation(pulled, "rapier", step_s=1e-4)
    sim.attach(0, (0.0, 0.0))
    refused, other = [], []

    def work() -> None:
        for tick in range(200):
            try:
                sim.advance([(1e-5 * tick, 0.0)], 1e-2)
            except RuntimeError as error:
                refused.append(str(error))
            except Exception as error:
                other.append(error)

    threads = [threading.Thread(target=work) for _ in range(4)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert not other and all("one thread at a time" in message for message in refused)
    assert np.isfinite(sim.pose).all()


def test_what_a_controller_raises_comes_out(pulled: Path) -> None:
    def fail(view: cohaul.View) -> None:
        if view.time_s > 0.01:
            raise ZeroDivisionError("in the controller")

    with pytest.raises(ZeroDivisionError, match="in the controller"):
        cohaul.run(pulled, controller=fail)
    with pytest.raises(ZeroDivisionError, match="in the controller"):
        cohaul.compare_controller(pulled, lambda seed: fail)
    with pytest.raises(LookupError, match="no controller"):
        cohaul.compare_controller(pulled, lambda seed: (_ for _ in ()).throw(LookupError("no controller")))


def test_memory_does_not_grow_with_the_calls(pulled: Path, request: pytest.FixtureRequest) -> None:
    sim = cohaul.Simulation(pulled, "quasi-static", step_s=1e-3)
    sim.attach(0, (0.0, 0.0))

    def calls(n: int) -> None:
        for tick in range(n):
            sim.advance([(0.1 * (tick % 2), 0.0)], 1e-3)
            sim.pose, sim.pulls, sim.tips

    def resident() -> int:
        gc.collect()
        return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGESIZE")

    n = request.config.getoption("--calls")
    calls(n // 10)
    before = resident()
    calls(n)
    # 100 bytes a call would be 10 MB.
    assert resident() - before < max(2e6, 10.0 * n)


def test_the_lock_is_released(pulled: Path) -> None:
    """Another thread goes on while one computes, and two need less than twice the time of one."""
    counted = [0]
    is_done = threading.Event()

    def count() -> None:
        while not is_done.is_set():
            counted[0] += 1
            time.sleep(1e-3)

    counter = threading.Thread(target=count)
    counter.start()
    started = time.perf_counter()
    cohaul.run(pulled, "rapier", step_s=2e-5)
    alone = time.perf_counter() - started
    is_done.set()
    counter.join()
    # With the lock held there would be one count, and another for each signal check.
    assert counted[0] > 100 * alone


@pytest.mark.parametrize("call", ["cohaul.run(s, 'rapier', step_s=1e-6)", "cohaul.compare(s, step_s=1e-6)", "cohaul.sweep(s, seeds=10**5)"])
def test_ctrl_c_ends_a_long_call(call: str, four_ants: Path) -> None:
    # A shell starts what runs in the background with the signal ignored, and children inherit that.
    code = f"""
        import signal, time, cohaul
        signal.signal(signal.SIGINT, signal.default_int_handler)
        s = cohaul.Scenario({str(four_ants)!r})
        print("ready", flush=True)
        try:
            {call}
        except KeyboardInterrupt:
            print("interrupted", flush=True)
    """
    process = subprocess.Popen([sys.executable, "-c", textwrap.dedent(code)], stdout=subprocess.PIPE, text=True, cwd=ROOT)
    assert process.stdout is not None
    try:
        assert process.stdout.readline() == "ready\n"
        time.sleep(0.5)
        started = time.perf_counter()
        process.send_signal(signal.SIGINT)
        assert process.stdout.readline() == "interrupted\n"
        assert process.wait(timeout=10) == 0 and time.perf_counter() - started < 3.0
    finally:
        process.kill()


def test_a_forked_process_computes_too(pulled: Path) -> None:
    cohaul.sweep(pulled, seeds=1)
    child = os.fork()
    if child == 0:
        os._exit(0 if cohaul.sweep(pulled, {"load.mass_kg": [0.001, 0.002]}).n_rows == 2 else 1)
    deadline = time.monotonic() + 30.0
    while (ended := os.waitpid(child, os.WNOHANG)) == (0, 0) and time.monotonic() < deadline:
        time.sleep(0.05)
    if ended == (0, 0):
        os.kill(child, signal.SIGKILL)
    assert ended[1] == 0


@pytest.mark.parametrize("index", [-1, 1, 10**30, np.int64(-1)])
def test_indices_that_are_none_are_named(pulled: Path, index: Any) -> None:
    sim = cohaul.Simulation(pulled)
    pusher = cohaul.Simulation(SCENES / "contact/pusher.json")
    with pytest.raises(ValueError, match=f"spring: must be from 0 to 0, found {int(index)}"):
        sim.attach(index, (0.0, 0.0))
    with pytest.raises(ValueError, match=f"spring: must be from 0 to 0, found {int(index)}"):
        sim.release(index)
    with pytest.raises(ValueError, match=f"pushers: obstacle: must be from 0 to 0, found {int(index)}"):
        pusher.advance([], 0.01, {int(index): (0.0, 0.0, 0.0)})
    with pytest.raises(ValueError, match=f"obstacle: must be from 0 to 0, found {int(index)}"):
        cohaul.run(SCENES / "contact/pusher.json", controller=lambda view: view.steer(index, (0.0, 0.0, 0.0)))
    with pytest.raises(TypeError, match="spring: must be a whole number, found str"):
        sim.attach("0", (0.0, 0.0))  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="spring: must be one of the scenario, which has none, found 0"):
        pusher.attach(0, (0.0, 0.0))


def test_numbers_that_are_not_finite_are_named_by_their_place(pulled: Path) -> None:
    sim = cohaul.Simulation(pulled)
    with pytest.raises(ValueError, match=r"pose\[2\]: must be finite, found nan"):
        sim.set_pose([0.0, 0.0, float("nan")])
    state = sim.state.copy()
    state[5] = float("inf")
    with pytest.raises(ValueError, match=r"state\[5\]: must be finite and at most 1e60 in size, found inf"):
        sim.state = state
    with pytest.raises(ValueError, match=r"poses: must be finite .* found nan at \(1, 2\)"):
        cohaul.rollouts(pulled, poses=[[0.0, 0.0, 0.0], [0.0, 0.0, float("nan")]])


def test_lists_of_nothing_and_unknown_tiers_are_refused(pulled: Path) -> None:
    with pytest.raises(ValueError, match="seeds: must have at least one seed, found none"):
        cohaul.rollouts(SCENES / "paper/four-ants-four-springs.json", seeds=[])
    with pytest.raises(ValueError, match='tiers: must be prescribed, replayed, controlled or closed-loop, found "x"'):
        cohaul.compare(pulled, tiers="x")  # type: ignore[arg-type]
    measure = cohaul.Measure("final x", "m", lambda trace: trace["x_m"][-1])
    with pytest.raises(ValueError, match="measure: must come with the tiers replayed and controlled, found closed-loop"):
        cohaul.compare_controller(pulled, lambda seed: lambda view: None, tiers=["replayed", "closed-loop"], measure=measure)
    found = cohaul.compare_controller(pulled, lambda seed: lambda view: None, measure=measure, step_s=1e-2)
    assert set(found.tiers) == {"replayed", "controlled"}
    assert all("measure" in found.tiers[tier]["verdicts"] for tier in ("replayed", "controlled"))


@pytest.mark.parametrize("backend", cohaul.BACKENDS)
def test_an_interrupt_ends_a_long_advance_and_leaves_all_as_it_was(four_ants: Path, backend: Any, request: pytest.FixtureRequest) -> None:
    # Tests that a shell has started in the background ignore it.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    request.addfinalizer(lambda: signal.signal(signal.SIGINT, before))
    options: dict[str, Any] = {} if backend == "rapier" else {"no_skip": ["still-tips", "stick-certificate"]}
    sim = cohaul.Simulation(four_ants, backend, step_s=1e-6, **options)
    starts = 0.0385 * np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    for spring, tip in enumerate(starts):
        sim.attach(spring, tip)
    sim.advance(starts + [1e-3, 0.0], 4e-4)
    # Such an advance takes some tenths of a second.
    saved, moved = sim.save(), starts + [0.05, 0.02]
    for _ in range(5):
        threading.Timer(0.1, lambda: signal.raise_signal(signal.SIGINT)).start()
        with pytest.raises(KeyboardInterrupt):
            sim.advance(moved, 0.09)
            for _ in range(1000):
                time.sleep(0.01)
        if sim.time_s < 0.01:
            break
        # It was over before the interrupt.
        sim.load(saved)
    assert sim.save() == saved and sim.time_s == 4e-4
    # It goes on as one that was never interrupted.
    other = cohaul.Simulation(four_ants, backend, step_s=1e-6, **options)
    other.load(saved)
    for one in (sim, other):
        assert one.advance(starts + [2e-3, 0.0], 4e-4) == "converged"
    assert sim.save() == other.save()


def test_hearing_interrupts_changes_no_number(pulled: Path) -> None:
    """The same steps, in one advance that hears interrupts and in two that do not."""
    heard, unheard = (cohaul.Simulation(pulled, "inertial", step_s=1e-4) for _ in range(2))
    for sim in (heard, unheard):
        sim.attach(0, (0.0, 0.0))
        sim.advance([(0.05, 0.0)], 0.04)
    heard.advance([(0.05, 0.01)], 0.08)
    for tick in (1, 2):
        unheard.advance([(0.05, 0.005 * tick)], 0.04)
    assert np.allclose(heard.pose, unheard.pose, rtol=0.0, atol=1e-12) and heard.pose[0] > 0.001
    assert heard.steps["n_steps"] == unheard.steps["n_steps"] == 1200


def test_progress_rises_to_its_end(pulled: Path) -> None:
    scenario = cohaul.Scenario(pulled, duration_s=0.5)
    calls = {
        "sweep": lambda show: cohaul.sweep(scenario, {"load.mass_kg": [1e-3, 2e-3]}, seeds=4, progress=show),
        "run": lambda show: cohaul.run(scenario, progress=show),
        "compare": lambda show: cohaul.compare_controller(scenario, lambda seed: lambda view: None, tiers="replayed", progress=show),
        "rollouts": lambda show: cohaul.rollouts(scenario, n_periods=3, progress=show),
        "conformance": lambda show: cohaul.conformance("quasi-static", progress=show),
    }
    for name, call in calls.items():
        shares: list[float] = []
        call(shares.append)
        assert shares and shares[-1] == 1.0 and shares == sorted(shares), (name, shares)
    failing: list[float] = []
    with pytest.raises(ZeroDivisionError):
        cohaul.run(scenario, controller=lambda view: 1 / 0, progress=failing.append)  # type: ignore[arg-type, return-value]
    assert 1.0 not in failing


def test_a_comparison_with_a_closed_loop_is_shown_and_travels() -> None:
    scenario = cohaul.Scenario(SCENES / "paper/four-ants-four-springs.json", duration_s=1.0)
    found = cohaul.compare(scenario, seeds=2)
    assert set(found.tiers) == {"replayed", "closed_loop"} and found.closed_loop is not None
    assert found.closed_loop["engine_name"]["name"] == "rapier" and found.closed_loop["engine"] in ("within", "not within", "open")
    assert "closed loop: rapier, 2 seeds" in found._repr_html_()
    again = pickle.loads(pickle.dumps(found))
    assert again.results == found.results and again.overview("closed_loop") == found.overview("closed_loop")
    # No key of an object stands there twice.
    json.loads(found._data.json(), object_pairs_hook=no_key_twice)
    alone = cohaul.compare(scenario, tiers="closed-loop", seeds=2)
    assert alone.verdict == alone.tiers["closed_loop"]["verdict"]
    with pytest.raises(ValueError, match="tiers: must have one that compares paths, found closed_loop"):
        alone.verdicts


def no_key_twice(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    assert len(found) == len(pairs), [name for name, _ in pairs]
    return found
