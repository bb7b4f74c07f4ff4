"""Many short runs in one call, on all threads."""

from __future__ import annotations

from functools import cached_property
from typing import Any, Mapping, Sequence

import numpy as np
import numpy.typing as npt

from . import _native
from ._kept import Kept
from ._options import NoSkip, Progress, as_json, backend_options, number, progress_of, whole
from ._scenario import Scenario, Source, as_scenario
from ._simulation import Simulation
from .results import BackendName, FloatArray, Integrator, RapierOptions

LARGEST = 1e60
"""Largest coordinate (m)."""
MOST_NUMBERS = 2**31
"""Most numbers of all arrays of a call (1)."""


class Rollouts:
    """Results of many short runs, as arrays of float64 whose first axis counts the rollouts.

    ``poses`` has x, y (m, world) and heading (rad) of the load, ``twists`` its velocity (m/s, world)
    and turn rate (rad/s), from the start on: both have the shape (rollouts, periods + 1, 3).
    ``pulls`` (rollouts, periods, springs, 2) and ``contact_forces`` (rollouts, periods, obstacles,
    2) are forces at the end of each period (N, world): on the tips, and of the obstacles on the
    load. ``statuses`` (rollouts, periods) says how the steps ended: 0 for converged, 1 for not
    converged, 2 for failed. ``states`` (rollouts, numbers) is the state at the end, as
    :attr:`Simulation.state` has it. A rollout that ends early, as when the load arrives, has NaN
    from there on.
    """

    def __init__(self, data: _native.RolloutData | Kept) -> None:
        self._data: Any = data

    @cached_property
    def poses(self) -> FloatArray:
        """x, y (m, world) and heading (rad) of the load: (rollouts, periods + 1, 3)."""
        return np.asarray(self._data.column("poses"))

    @cached_property
    def twists(self) -> FloatArray:
        """Velocity (m/s, world) and turn rate (rad/s) of the load: (rollouts, periods + 1, 3)."""
        return np.asarray(self._data.column("twists"))

    @cached_property
    def pulls(self) -> FloatArray:
        """Pulls on the tips (N, world): (rollouts, periods, springs, 2)."""
        return np.asarray(self._data.column("pulls"))

    @cached_property
    def contact_forces(self) -> FloatArray:
        """Forces of the obstacles on the load (N, world): (rollouts, periods, obstacles, 2)."""
        return np.asarray(self._data.column("contact_forces"))

    @cached_property
    def statuses(self) -> FloatArray:
        """How the steps ended, 0, 1 or 2: (rollouts, periods)."""
        return np.asarray(self._data.column("statuses"))

    @cached_property
    def states(self) -> FloatArray:
        """States at the end: (rollouts, numbers)."""
        return np.asarray(self._data.column("states"))

    def __reduce__(self) -> tuple[Any, ...]:
        names = ("poses", "twists", "pulls", "contact_forces", "statuses", "states")
        return Rollouts, (Kept({("column", name): getattr(self, name) for name in names}),)

    def __len__(self) -> int:
        return int(self.poses.shape[0])

    def __repr__(self) -> str:
        return f"<Rollouts: {len(self)} of {self.statuses.shape[1]} periods>"


def rollouts(
    scenario: Source,
    backend: BackendName = "quasi-static",
    *,
    states: npt.ArrayLike | None = None,
    poses: npt.ArrayLike | None = None,
    tips: npt.ArrayLike | None = None,
    pushers: Mapping[int, npt.ArrayLike] | None = None,
    n_periods: int | None = None,
    period_s: float | None = None,
    seeds: Sequence[int] | npt.NDArray[np.integer[Any]] | None = None,
    threads: int | None = None,
    progress: Progress = None,
    step_s: float | None = None,
    tolerance_m: float | None = None,
    integrator: Integrator | None = None,
    second_order: bool = False,
    rate_independent: bool = False,
    no_skip: NoSkip = None,
    rapier: RapierOptions | None = None,
) -> Rollouts:
    """Runs many rollouts of a scene on all threads, without the interpreter's lock. Ctrl-C ends it.

    Commands hold for one control period each. All arrays may leave out the axis of rollouts, and
    are then those of every rollout; what is left out of ``states``, ``tips`` and ``pushers`` stays
    as it is at the start.

    :param states: states to start from, as :attr:`Simulation.state` has them: (rollouts, numbers);
        the default is the start of the scenario, with free springs
    :param poses: poses of the load in place of those of the states, at rest: x, y (m, world) and
        heading (rad), (rollouts, 3)
    :param tips: tips at the end of each period (m, world): (rollouts, periods, springs, 2). NaN
        releases a spring. Entries of free springs are not read
    :param pushers: poses of obstacles that are steered at the end of each period, by the index of
        the obstacle: (rollouts, periods, 3)
    :param n_periods: number of control periods (1), where neither tips nor pushers say it
    :param period_s: control period (s), in place of the scenario's
    :param seeds: seeds of rollouts under the scenario's own drive, in place of states and commands

    >>> sim = Simulation("scenarios/analytic/centre-pull.json", step_s=1e-3)
    >>> sim.attach(0, (0.0, 0.0))
    >>> goals = np.array([0.04, 0.05])
    >>> shares = np.linspace(0.0, 1.0, 101)[1:]
    >>> tips = np.zeros((2, 100, 1, 2))
    >>> tips[:, :, 0, 0] = goals[:, None] * shares
    >>> found = rollouts(sim.scenario, states=sim.state, tips=tips, step_s=1e-3)
    >>> found.poses.shape, found.poses[:, -1, 0].round(4).tolist()
    ((2, 101, 3), [0.0069, 0.0169])
    """
    given = as_scenario(scenario)
    options = as_json(backend_options(backend, step_s, tolerance_m, None, integrator, second_order, rate_independent, no_skip, rapier))
    n_threads = whole("threads", threads, 1, 1024)
    if seeds is not None:
        others = {"states": states, "poses": poses, "tips": tips, "pushers": pushers, "period_s": period_s}
        if found := [name for name, value in others.items() if value is not None]:
            raise ValueError(f"seeds: must come without {', '.join(others)}, found {', '.join(found)}")
        asked_seeds = [whole(f"seeds[{at}]", seed) for at, seed in enumerate(np.asarray(seeds).ravel().tolist())]
        if not asked_seeds:
            raise ValueError("seeds: must have at least one seed, found none")
        periods = whole("n_periods", n_periods, 1) or max(1, round(given.duration_s / given.control_period_s))
        with progress_of(progress, "rollouts") as show:
            return Rollouts(_native.seeded_rollouts(given._scene, options, asked_seeds, periods, n_threads, show))
    call = _Call(given, Simulation(given, backend, step_s=step_s, tolerance_m=tolerance_m, rapier=rapier), states, poses, tips, pushers, n_periods)
    period = number("period_s", period_s) or given.control_period_s
    with progress_of(progress, "rollouts") as show:
        data = _native.rollouts(
            given._scene, options, call.states.tobytes(), call.tips.tobytes(), call.steered, call.pushers.tobytes(),
            (call.n, call.n_periods), period, n_threads, show,
        )  # fmt: skip
    return Rollouts(data)


class _Call:
    """The arrays of a call, all with the axis of rollouts."""

    def __init__(
        self, scenario: Scenario, at_start: Simulation, states: Any, poses: Any, tips: Any, pushers: Mapping[int, Any] | None, n_periods: int | None
    ) -> None:
        if pushers is not None and not isinstance(pushers, Mapping):
            raise TypeError(f"pushers: must be a mapping from indices of obstacles, found {type(pushers).__name__}")
        n_springs, n_obstacles, start = scenario.n_springs, at_start.n_obstacles, at_start.state
        self.steered = [whole("pushers", obstacle, 0, max(n_obstacles - 1, 0)) or 0 for obstacle in pushers or {}]
        if self.steered and n_obstacles == 0:
            raise ValueError("pushers: must be obstacles of the scenario, found one in a scenario without")
        states = start if states is None else states
        given: dict[str, tuple[FloatArray, tuple[int | None, ...]]] = {"states": (_array("states", states), (start.size,))}
        if poses is not None:
            given["poses"] = (_array("poses", poses), (3,))
        if tips is not None:
            given["tips"] = (_array("tips", tips, may_be_nan=True), (None, n_springs, 2))
        for obstacle, values in (pushers or {}).items():
            given[f"pushers[{obstacle}]"] = (_array(f"pushers[{obstacle}]", values), (None, 3))
        for path, (array, shape) in given.items():
            _check_shape(path, array, shape)
        counts = {path: array.shape[0] for path, (array, shape) in given.items() if array.ndim > len(shape)}
        periods = {path: int(array.shape[-len(shape)]) for path, (array, shape) in given.items() if shape[0] is None}
        if n_periods is not None or not periods:
            periods["n_periods"] = whole("n_periods", 1 if n_periods is None else n_periods, 1) or 1
        self.n, self.n_periods = _one("rollouts", counts, 1), _one("periods", periods, 1)
        n_numbers = self.n * (start.size + self.n_periods * (8 + 4 * n_springs + 5 * n_obstacles))
        if n_numbers > MOST_NUMBERS:
            raise ValueError(f"rollouts: must have at most {MOST_NUMBERS} numbers, found {n_numbers}")

        def full(path: str, *shape: int) -> FloatArray:
            return np.ascontiguousarray(np.broadcast_to(given[path][0], (self.n, *shape)))

        self.states = full("states", start.size)
        if poses is not None:
            self.states = self.states.copy()
            self.states[:, 1:4], self.states[:, 4:7] = full("poses", 3), 0.0
        held = self.states[:, 7 : 7 + 3 * n_springs].reshape(self.n, 1, n_springs, 3)[..., 1:]
        shape = (self.n_periods, n_springs, 2)
        self.tips = np.array(np.broadcast_to(held, (self.n, *shape))) if tips is None else full("tips", *shape)
        each = [full(f"pushers[{obstacle}]", self.n_periods, 3) for obstacle in pushers or {}]
        self.pushers: FloatArray = np.stack(each, axis=2) if each else np.zeros(0)


def _array(path: str, values: Any, *, may_be_nan: bool = False) -> FloatArray:
    try:
        array = np.ascontiguousarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise TypeError(f"{path}: must be an array of numbers, found {type(values).__name__}") from error
    wrong = np.abs(array) > LARGEST if may_be_nan else ~(np.abs(array) <= LARGEST)
    if wrong.any():
        at = tuple(int(index) for index in np.argwhere(wrong)[0])
        raise ValueError(f"{path}: must be finite and at most {LARGEST:g} in size, found {array[at]} at {at}")
    if may_be_nan and array.ndim and array.shape[-1] == 2 and (np.isnan(array[..., 0]) != np.isnan(array[..., 1])).any():
        raise ValueError(f"{path}: must have both coordinates of a tip or neither, found one of them NaN")
    return array


def _check_shape(path: str, array: FloatArray, shape: tuple[int | None, ...]) -> None:
    known = array.shape[-len(shape) :]
    fits = array.ndim in (len(shape), len(shape) + 1) and all(want in (None, size) for want, size in zip(shape, known))
    if not fits or 0 in array.shape[: array.ndim - len(shape) + (shape[0] is None)]:
        want = ", ".join(["rollouts", *("periods" if size is None else str(size) for size in shape)])
        raise ValueError(f"{path}: must have the shape ({want}), or that without rollouts, found {array.shape}")


def _one(what: str, found: dict[str, int], default: int) -> int:
    """The number that all arrays agree on."""
    if len(set(found.values())) > 1:
        raise ValueError(f"{', '.join(found)}: must have one number of {what}, found {', '.join(map(str, found.values()))}")
    return next(iter(found.values()), default)
