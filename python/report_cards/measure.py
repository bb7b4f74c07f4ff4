"""Conformance, errors on scenes, and run times of the report cards."""

from __future__ import annotations

import json
import math
import time
from pathlib import Path
from typing import Any

import cohaul
from subjects import PRECISION, SCENES, STEPS_S, Advice, Card

ROOT = Path(__file__).parents[2]
STEP_S = 1e-3
ROUNDS = 3
"""Alternating rounds of the run times; the least time counts."""
REFERENCE_M = 1e-9
"""Tolerance of the reference at several steps (m)."""


def conformance(card: Card) -> dict[str, Any] | None:
    """Answers of an engine to the tests, or ``None`` where they cannot be put to it."""
    if card.rapier:
        return None
    found = cohaul.conformance(card.engine)
    keep = ("key", "name", "outcome", "why", "grade", "measures")
    return {"line": found.line, "tests": [{key: test[key] for key in keep if test.get(key) is not None} for test in found["tests"]]}


def on_scenes(card: Card, step_s: float = STEP_S, scenes: tuple[str, ...] = SCENES) -> dict[str, Any]:
    """Errors and verdicts of an engine on each scene."""
    return {name: on_scene(card, scene(name), step_s) for name in scenes}


def scene(name: str) -> cohaul.Scenario:
    return cohaul.Scenario(str(ROOT / "scenarios" / f"{name}.json"))


def on_scene(card: Card, given: cohaul.Scenario, step_s: float) -> dict[str, Any]:
    """Errors and verdicts of an engine on a scene, or why it refuses or fails."""
    if card.engine == "inertial":
        return {"outcome": "reference"}
    try:
        found = cohaul.compare(given, engine=card.engine, step_s=step_s, rapier=card.rapier or None, tiers="prescribed")
    except Exception as error:  # Whatever an engine does wrong is a row of the table.
        outcome = "refused" if isinstance(error, NotImplementedError) else "failed"
        return {"outcome": outcome, "why": (str(error) or type(error).__name__).splitlines()[-1][:300]}
    tier = found.tiers["prescribed"]
    path = found.verdicts["path"]
    return {
        "outcome": "measured",
        "path_length_m": tier["path_length_m"],
        "error_m": path["engine_error"],
        "time_step_error_m": path["parts"]["time_step"],
        "model_error_m": path["parts"]["engine_model"],
        "limit_error_m": path["parts"]["limit_error"],
        "reference_error_m": path["reference_error"],
        "time_step_order": tier["time_step_order"],
        "heading_error_rad": found.verdicts["heading"]["engine_error"],
        "verdicts": {quantity: verdict["engine"] for quantity, verdict in found.verdicts.items()},
        "causes": path["causes"],
    }


def coarse(name: str) -> cohaul.Scenario:
    """A scene whose control period is the longest step."""
    return scene(name).replace(control_period_s=max(STEPS_S))


def errors_at_steps(card: Card, name: str) -> list[dict[str, Any]]:
    """Errors of an engine on a scene at several steps (m)."""
    given = coarse(name)
    rows = []
    for step_s in STEPS_S:
        if card.engine == "inertial":
            rows.append({"step_s": step_s, "outcome": "measured", "error_m": error_of_inertial(given, step_s)})
            continue
        found = on_scene(card, given, step_s)
        rows.append({"step_s": step_s, **{key: found[key] for key in ("outcome", "error_m", "why", "path_length_m") if key in found}})
    return rows


def error_of_inertial(given: cohaul.Scenario, step_s: float) -> float:
    """Largest edge displacement between a run at a fixed step and one under error control (m)."""
    one = cohaul.run(given, "inertial", step_s=step_s).trace
    other = cohaul.run(given, "inertial", tolerance_m=REFERENCE_M).trace
    apart = [abs(one[key] - other[key]) for key in ("x_m", "y_m", "heading_rad")]
    return float(((apart[0] ** 2 + apart[1] ** 2) ** 0.5 + given.radius_m * apart[2]).max())


def timed(make: Any, runs: list[dict[str, float]]) -> Any:
    """An adapter that adds the CPU time of each run to a list, without that of the springs."""

    class Timed(make):  # type: ignore[misc]
        def start(self, scene: Any, longest_step_s: float) -> None:
            super().start(scene, longest_step_s)
            self._run = {"step_s": longest_step_s, "cpu_s": 0.0}
            self._is_inside = False
            runs.append(self._run)

        def step(self, h: float, share: float) -> None:
            self._is_inside, began = True, time.thread_time()
            super().step(h, share)
            self._run["cpu_s"] += time.thread_time() - began
            self._is_inside = False

        def wrench(self, pose: Any, twist: Any, share: float) -> Any:
            began = time.thread_time()
            found = super().wrench(pose, twist, share)
            if self._is_inside:
                self._run["cpu_s"] -= time.thread_time() - began
            return found

    return Timed


def run_times(cards: list[Card]) -> dict[str, dict[str, list[dict[str, float]]]]:
    """Least CPU time of one run (s) of each engine on each scene at each step."""
    runs: dict[tuple[str, str], list[dict[str, float]]] = {}
    for at in range(ROUNDS):
        for card in cards if at % 2 == 0 else reversed(cards):
            for name in PRECISION:
                runs.setdefault((name, card.name), []).extend(run_time(card, coarse(name)))
    found: dict[str, dict[str, list[dict[str, float]]]] = {name: {} for name in PRECISION}
    for (name, engine), times in runs.items():
        least = {step: [run["cpu_s"] for run in times if abs(run["step_s"] / step - 1.0) < 1e-6] for step in STEPS_S}
        found[name][engine] = [{"step_s": step, "cpu_s": min(all_of), "n_runs": len(all_of)} for step, all_of in least.items() if all_of]
    return found


def run_time(card: Card, given: cohaul.Scenario) -> list[dict[str, float]]:
    """CPU times (s) of runs of an engine on a scene at all steps."""
    runs: list[dict[str, float]] = []
    if isinstance(card.engine, str):
        for step_s in STEPS_S:
            # The run has a thread of its own.
            began = time.process_time()
            cohaul.run(given, card.engine, step_s=step_s, trace=False, rapier=card.rapier or None)
            runs.append({"step_s": step_s, "cpu_s": time.process_time() - began})
        return runs
    try:
        # The comparison halves the longest step down to the shortest.
        cohaul.compare(given, engine=timed(card.engine, runs), step_s=max(STEPS_S), halvings=len(STEPS_S) - 1, tiers="prescribed", threads=1)
    except Exception:
        return []
    return [run for run in runs if run["cpu_s"] > 0.0]  # One is started for its name alone.


def friction_direction(card: Card) -> float | None:
    """Direction of friction at one support off the centre that slips along 45 degrees (degrees).

    As in the test C4, with friction so weak that the slip does not turn meanwhile.
    """
    if isinstance(card.engine, str):
        return None
    mass, radius, speed = 0.0016, 0.0122, math.sqrt(0.5)
    engine: Any = card.engine()
    engine._ask = lambda pose, twist, share: (0.0, 0.0, 0.0)
    support = {"offset_m": [0.0, 2.0 * radius / 3.0], "slip_limit_n": 0.1 * mass}
    outline = [{"kind": "disc", "centre_m": [0.0, 0.0], "radius_m": radius}]
    body = {"mass_kg": mass, "inertia_kg_m2": 0.5 * mass * radius**2, "radius_m": radius, "outline": outline}
    start = {"pose": [0.0, 0.0, 0.0], "twist": [speed, speed, 0.0], "supports": [support], "springs": [], "obstacles": []}
    engine.start({**body, **start}, STEP_S)
    u, v, _ = engine.advance([], [], 10.0 * STEP_S, 10)["twist"]
    return math.degrees(math.atan2(speed - v, speed - u))


def effect(change: Advice) -> dict[str, Any]:
    """The number that a change of settings changes, before and after."""
    sides: tuple[tuple[Any, Any], ...] = ((change.before, change.rapier_before), (change.after, {}))
    values = [_measured(Card("", "", make, "", rapier), change.measured) for make, rapier in sides]
    return {"engine": change.engine, "change": change.change, "measured": list(change.measured), "before": values[0], "after": values[1]}


def _measured(card: Card, measured: tuple[str, str]) -> dict[str, Any]:
    what, name = measured
    if what == "path":
        found = on_scene(card, scene(name), STEP_S)
        return {"value": found["error_m"], "unit": "m", "share": found["error_m"] / found["path_length_m"]}
    test = next(test for test in (conformance(card) or {})["tests"] if test["key"] == what)
    answer = next(answer for answer in test["measures"] if answer["name"] == name)
    return {"value": answer["found"], "unit": answer["unit"], "known": answer["known"], "share": answer["relative_error"]}


def rounded(value: Any) -> Any:
    """Numbers with six digits, beyond which machines differ."""
    if isinstance(value, float):
        return float(f"{value:.6g}") if abs(value) > 1e-15 else 0.0
    if isinstance(value, dict):
        return {key: rounded(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [rounded(each) for each in value]
    return value


def write_json(path: Path, value: Any) -> None:
    path.write_text(json.dumps(rounded(value), indent=1, allow_nan=False) + "\n")
