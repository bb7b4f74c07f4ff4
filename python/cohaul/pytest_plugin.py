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
from .results import QuantityVerdict

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
    verdicts: dict[str, Any] = {**found.verdicts}
    faults = [fault for quantity in asked or ["path"] if (fault := _fault(quantity, verdicts.get(quantity)))]
    if faults:
        pytest.fail("\n".join([found.answer, *faults]), pytrace=False)
    return found


def _fault(quantity: str, verdict: QuantityVerdict | None) -> str | None:
    """What is wrong with the verdict on a quantity, if anything is."""
    if verdict is None or quantity not in ("path", "heading") and not verdict.get("measures"):
        return f"{quantity}: not compared; the engine does not compute it, or the scene does not have it"
    if verdict["engine"] == "within":
        return None
    unit, decided, numbers = verdict["unit"], f"the {quantity}", {**verdict}
    if verdict.get("measures"):
        # The number that is worst for the engine need not be the one that decides on inertia.
        worst = max(verdict["measures"], key=lambda of: of["engine_error"] / of["tolerance"])
        numbers, decided = {**worst}, worst["name"]
    shown = [f"{name.replace('_', ' ')} {_shown(numbers, name, unit)}" for name in ("engine_error", "tolerance", "reference_error")]
    split = [f"{name.replace('_', ' ')} {_shown(numbers['parts'], name, unit)}" for name in ("time_step", "engine_model")]
    is_open = ", and it is open which is larger" if verdict["engine"] == "open" else ""
    return f"{quantity}: {', '.join(shown)}{is_open} ({decided}; {', '.join(split)})"


def _shown(numbers: Any, name: str, unit: str) -> str:
    return f"{numbers[name]:.4g} {unit}".strip()
