"""A load that is moved step by step."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from . import _native
from ._options import NoSkip, as_json, backend_options
from ._scenario import Scenario, Source, as_scenario
from .results import BackendName, FloatArray, Integrator, RapierOptions, SimulationEnergy, StepTotals

if TYPE_CHECKING:
    from typing_extensions import Self


class Simulation(_native.Stepper):
    """The load of a scenario on a backend, for a loop of your own.

    The scenario's drive and duration are not used. Springs are named by their index. ``pose`` is
    (x, y, heading) in m and rad, ``twist`` is (vx, vy, turn rate) in m/s and rad/s. ``tips`` (m)
    and ``pulls`` (N) have a row (x, y) for each spring, in world axes.

    Obstacles are named by their index too. They follow their paths until ``advance`` steers them:
    its argument ``pushers`` maps obstacles to the poses that they shall have at the end, where they
    go straight in time. ``obstacles`` has a row (x, y, heading) for each, ``contact_forces`` a row
    (x, y) with the force on the load in the last step (N), and ``contacts`` a tuple (obstacle,
    point, force) for each contact. ``friction_forces`` has a row (x, y) for each support (N).

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

    >>> sim = Simulation("scenarios/contact/pusher.json", "inertial")
    >>> sim.advance([], 0.5, pushers={0: (0.0028, 0.0, 0.0)}), round(sim.pose[0], 4)
    ('converged', 0.02)
    >>> again = Simulation(sim.scenario, "inertial")
    >>> again.state = sim.state
    >>> bool((again.state == sim.state).all()), again.state.shape
    (True, (11,))
    """

    _options: dict[str, Any]
    scenario: Scenario
    """The scenario, whose load is moved."""
    backend: BackendName
    """Name of the backend."""

    def __new__(
        cls,
        scenario: Source,
        backend: BackendName = "quasi-static",
        *,
        step_s: float | None = None,
        tolerance_m: float | None = None,
        integrator: Integrator | None = None,
        second_order: bool = False,
        rate_independent: bool = False,
        no_skip: NoSkip = None,
        rapier: RapierOptions | None = None,
    ) -> Self:
        given = as_scenario(scenario)
        options = backend_options(backend, step_s, tolerance_m, None, integrator, second_order, rate_independent, no_skip, rapier)
        made = super().__new__(cls, given._scene, as_json(options))
        made.scenario = given
        made.backend = backend
        made._options = options
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
    def n_obstacles(self) -> int:
        """Number of obstacles (1)."""
        return int(self.obstacles.shape[0])

    @property
    def state(self) -> FloatArray:
        """The state as numbers, with the shape (7 + 3 springs + 4 obstacles,).

        Number 0 is the time (s). Numbers 1 to 3 are x, y (m, world) and heading (rad) of the load, 4
        to 6 its velocity (m/s, world) and turn rate (rad/s). Each spring has three numbers: 1 if it
        is attached or 0, and x and y of its tip (m, world). Each obstacle has four: 1 if it was
        steered or 0, and x, y (m, world) and heading (rad).

        Setting it continues from there, also from numbers that were changed. The energy ledger then
        begins anew, and so does what a solver keeps from step to step. Two runs from one state are
        equal to the bit. They differ from the run that went through it by rounding, and in forces on
        a load at rest where these are not unique. :meth:`save` keeps all of it. An obstacle
        that was not steered follows its path from the time of the state on. A spring that was wound
        by more than half a turn is attached unwound. Without inertia the twist is that of the last
        step, and is not read.
        """
        state: FloatArray = self.numbers()[0]
        return state

    @state.setter
    def state(self, state: npt.ArrayLike) -> None:
        self.set_numbers("state", _bytes("state", state))

    def set_pose(self, pose: npt.ArrayLike) -> None:
        """Puts the load at rest at a pose (x, y in m, heading in rad, world).

        Tips and obstacles stay where they are. Otherwise it is as if :attr:`state` was set.
        """
        place = np.frombuffer(_bytes("pose", pose))
        if place.shape != (3,):
            raise ValueError(f"pose: must be three numbers (x, y, heading), found {place.size}")
        if not np.isfinite(place).all():
            at = int(np.argmin(np.isfinite(place)))
            raise ValueError(f"pose[{at}]: must be finite, found {place[at]}")
        state = self.state.copy()
        state[1:4], state[4:7] = place, 0.0
        self.set_numbers("pose", state.tobytes())

    def __reduce__(self) -> tuple[Any, ...]:
        return _restored, (self.scenario, self.backend, self._options, self.save())

    @property
    def energy(self) -> SimulationEnergy:
        """Energy ledger so far (J)."""
        found: SimulationEnergy = json.loads(self.facts())["energy"]
        return found

    @property
    def steps(self) -> StepTotals:
        """Counts and worst status of the steps so far."""
        found: StepTotals = json.loads(self.facts())["steps"]
        return found

    def __repr__(self) -> str:
        return f"<Simulation of {self.scenario.name!r} on {self.backend} at {self.time_s:g} s>"


def _restored(scenario: Scenario, backend: BackendName, options: dict[str, Any], saved: str) -> Simulation:
    """A simulation that goes on from a saved state."""
    made = _native.Stepper.__new__(Simulation, scenario._scene, as_json(options))
    made.scenario, made.backend, made._options = scenario, backend, options
    made.load(saved)
    return made


def _bytes(path: str, values: Any) -> bytes:
    """Numbers in memory."""
    try:
        return np.ascontiguousarray(values, dtype=np.float64).tobytes()
    except (TypeError, ValueError) as error:
        raise TypeError(f"{path}: must be an array of numbers, found {type(values).__name__}") from error
