"""Exceptions of the package."""

from __future__ import annotations

from typing import Iterable, NamedTuple


class Fault(NamedTuple):
    """One broken rule of a scenario."""

    path: str
    """Place of the fault: keys joined by points, as in ``springs[2].rest_length_m``."""
    rule: str
    """Rule that is broken."""
    value: str
    """Value or thing that was found."""


class ScenarioError(ValueError):
    """A scenario breaks rules. ``faults`` lists all of them, each with path, rule and value.

    >>> import cohaul
    >>> try:
    ...     cohaul.Scenario("scenarios/analytic/slide.json", duration_s=-1.0)
    ... except cohaul.ScenarioError as error:
    ...     for fault in error.faults:
    ...         print(fault.path, fault.rule, fault.value, sep=" | ")
    duration_s | must be positive | -1.0
    """

    def __init__(self, message: str, faults: Iterable[tuple[str, str, str]] = ()) -> None:
        super().__init__(message)
        self.faults: list[Fault] = [Fault(*fault) for fault in faults]

    def __reduce__(self) -> tuple[type, tuple[str, list[Fault]]]:
        return type(self), (str(self), self.faults)


class InternalError(RuntimeError):
    """A defect of the library. The message says what to report."""
