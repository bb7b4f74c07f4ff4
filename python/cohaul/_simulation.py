"""A load that is moved step by step."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Mapping, Sequence

from . import _native
from ._options import as_json, backend_options
from ._scenario import Scenario, Source, as_scenario

if TYPE_CHECKING:
    from typing_extensions import Self


class Simulation(_native.Stepper):
    """The load of a scenario on a backend, for a loop of your own.

    The scenario's drive and duration are not used. Springs are named by their index. ``pose`` is
    (x, y, heading) in m and rad, ``twist`` is (vx, vy, turn rate) in m/s and rad/s. ``tips`` (m)
    and ``pulls`` (N) have a row (x, y) for each spring, in world axes.

    >>> sim = Simulation("scenarios/analytic/centre-pull.json", "quasi-static", step_s=1e-3)
    >>> sim.attach(0, (0.0, 0.0))
    >>> for tick in range(1, 401):
    ...     status = sim.advance([(1e-4 * tick, 0.0)], 1e-3)
    >>> status, round(sim.time_s, 6)
    ('converged', 0.4)
    >>> x, y, heading = sim.pose
    >>> round(x, 6)
    0.006906
    >>> bool(abs(sim.pulls[0, 0] - sim.scenario.slip_limit_n) < 1e-12)
    True
    """

    scenario: Scenario
    """The scenario, whose load is moved."""
    backend: str
    """Name of the backend."""

    def __new__(
        cls,
        scenario: Source,
        backend: str = "quasi-static",
        *,
        step_s: float | None = None,
        tolerance_m: float | None = None,
        integrator: str | None = None,
        second_order: bool = False,
        rate_independent: bool = False,
        no_skip: str | Sequence[str] | None = None,
        rapier: Mapping[str, str] | None = None,
    ) -> Self:
        given = as_scenario(scenario)
        options = backend_options(backend, step_s, tolerance_m, None, integrator, second_order, rate_independent, no_skip, rapier)
        made = super().__new__(cls, given._scene, as_json(options))
        made.scenario = given
        made.backend = backend
        return made

    @property
    def control_period_s(self) -> float:
        """Control period of the scenario (s), the usual time of an advance."""
        return self.scenario.control_period_s

    @property
    def n_springs(self) -> int:
        """Number of springs (1)."""
        return self.scenario.n_springs

    @property
    def energy(self) -> dict[str, float]:
        """Energy ledger so far (J)."""
        return json.loads(self.facts())["energy"]

    @property
    def steps(self) -> dict[str, Any]:
        """Counts and worst status of the steps so far."""
        return json.loads(self.facts())["steps"]

    def __repr__(self) -> str:
        return f"<Simulation of {self.scenario.name!r} on {self.backend} at {self.time_s:g} s>"
