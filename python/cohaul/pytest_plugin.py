"""Tests of engines with pytest: the fixture ``engine_verdict``.

pytest finds it wherever cohaul is installed::

    def test_a_box_slides_and_stops(engine_verdict):
        engine_verdict("scenes/box.json", MyEngine, path=0.02, heading=0.05, step_s=1e-3)

The test fails if the engine error exceeds a tolerance that is named, or may do so. It fails with
the answer of the comparison and the numbers that decide it.
"""

from __future__ import annotations

from typing import Any, Callable, Protocol

import pytest

from ._compare import Comparison, compare
from ._scenario import Source

TOLERANCES = {
    "path": "tolerance_share",
    "heading": "tolerance_heading_rad",
    "pulls": "tolerance_pull_share",
    "contacts": "tolerance_pull_share",
    "speed": "tolerance_speed_share",
    "energy": "tolerance_energy_share",
}
"""Quantities, and the option of :func:`cohaul.compare` that has the tolerance of each."""


class EngineVerdict(Protocol):
    """What the fixture is: a call that fails the test, or returns the comparison."""

    def __call__(
        self,
        scenario: Source,
        engine: Callable[[], Any] | None = None,
        *,
        path: float | None = None,
        heading: float | None = None,
        pulls: float | None = None,
        contacts: float | None = None,
        speed: float | None = None,
        energy: float | None = None,
        **options: Any,
    ) -> Comparison: ...


@pytest.fixture
def engine_verdict() -> EngineVerdict:
    """Fails the test if the error of an engine on a scenario exceeds a tolerance.

    ``path`` is the tolerance over the path length (1), ``heading`` in rad, the others over the
    larger value (1). Quantities without a tolerance are not judged; without any, the path is, with
    that of ``cohaul compare``. ``options`` are those of :func:`cohaul.compare`. Without an engine,
    rapier is judged.
    """
    return _judge


def _judge(scenario: Source, engine: Callable[[], Any] | None = None, **options: Any) -> Comparison:
    __tracebackhide__ = True
    asked = {quantity: options.pop(quantity) for quantity in TOLERANCES if options.get(quantity) is not None}
    options = {key: value for key, value in options.items() if key not in TOLERANCES}
    for quantity, tolerance in asked.items():
        if options.setdefault(TOLERANCES[quantity], tolerance) != tolerance:
            raise ValueError(f"{quantity}: must have the tolerance of {TOLERANCES[quantity]}, found another one, {tolerance}")
    found = compare(scenario, engine=engine, **options)
    faults = [fault for quantity in asked or ["path"] if (fault := _fault(quantity, found.verdicts.get(quantity)))]
    if faults:
        pytest.fail("\n".join([found.answer, *faults]), pytrace=False)
    return found


def _fault(quantity: str, verdict: dict[str, Any] | None) -> str | None:
    """What is wrong with the verdict on a quantity, if anything is."""
    if verdict is None or quantity not in ("path", "heading") and not verdict.get("measures"):
        return f"{quantity}: not compared; the engine does not compute it, or the scene does not have it"
    if verdict["engine"] == "within":
        return None
    unit, decided = verdict.get("unit", ""), f"the {quantity}"
    if verdict.get("measures"):
        # The number that is worst for the engine need not be the one that decides on inertia.
        verdict = {**verdict, **max(verdict["measures"], key=lambda of: of["engine_error"] / of["tolerance"])}
        decided = verdict["name"]
    numbers = [f"{name.replace('_', ' ')} {_shown(verdict, name, unit)}" for name in ("engine_error", "tolerance", "reference_error")]
    parts = verdict.get("parts", {})
    split = [f"{name.replace('_', ' ')} {_shown(parts, name, unit)}" for name in ("time_step", "engine_model") if name in parts]
    is_open = ", and it is open which is larger" if verdict["engine"] == "open" else ""
    return f"{quantity}: {', '.join(numbers)}{is_open} ({decided}; {', '.join(split)})"


def _shown(numbers: dict[str, Any], name: str, unit: str) -> str:
    value = numbers.get(name)
    return "unknown" if value is None else f"{value:.4g} {unit}".strip()
