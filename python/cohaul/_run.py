"""One run and its trace."""

from __future__ import annotations

import html
import json
import os
from typing import Any, Callable, Iterator, Literal, Mapping, NamedTuple, Sequence, Union, cast, overload

import numpy as np

from . import _native
from ._kept import Kept, kept, kept_trace
from ._options import NoSkip, Progress, as_json, backend_options, progress_of, whole
from ._scenario import Source, as_scenario
from .results import (
    Account, Accuracy, BackendName, ContactCounts, Energy, Final, FloatArray, Format, InertiaEstimate, Integrator, PullForce, RapierOptions,
    RapierUsed, RunResults, RunSteps, TraceColumn, Transition, TransitionCounts,
)  # fmt: skip

Tips = Union[Sequence[Sequence[float]], FloatArray]
"""Positions (x, y) of all tips (m, world): a row for each spring."""
Controller = Callable[[_native.View], Union[Tips, None]]
"""A function that decides once in each control period: it returns the positions of all tips at its
end, or ``None`` to hold them."""


class Event(NamedTuple):
    """A grasp or a release."""

    time_s: float
    """Time of the event (s)."""
    kind: Literal["grasp", "release"]
    """``'grasp'`` or ``'release'``."""
    spring: int
    """Index of the spring."""
    ant: int | None
    """Number of the ant; ``None`` for a path or a controller."""
    tip_m: tuple[float, float]
    """Position of the tip at that instant (m, world)."""


class Table(Mapping[str, "np.ndarray[Any, Any]"]):
    """Columns by name."""

    __slots__ = ()

    def _ipython_key_completions_(self) -> list[str]:
        return list(self)

    def _flat(self) -> dict[str, np.ndarray[Any, Any]]:
        """Columns of one dimension."""
        return dict(self)

    def to_pandas(self) -> Any:
        """The table as a ``pandas.DataFrame``, with a column for each number of a row."""
        return library("pandas", "to_pandas").DataFrame(self._flat())

    def to_polars(self) -> Any:
        """The table as a ``polars.DataFrame``, with a column for each number of a row."""
        polars = library("polars", "to_polars")
        lists = {name: column.tolist() if column.dtype == object else np.ascontiguousarray(column) for name, column in self._flat().items()}
        return polars.DataFrame(lists)


class Trace(Table):
    """Columns of a run, as read-only arrays by name: a row at every control tick.

    ``time_s``, ``x_m``, ``y_m``, ``heading_rad``, ``vx_m_per_s``, ``vy_m_per_s``,
    ``turn_rate_rad_per_s``, ``elastic_j``, ``kinetic_j``, ``friction_j`` and ``tip_work_j`` lie
    where the run has put them and are not copied. ``dissipated_j``, ``defect_j``,
    ``interaction_n`` and ``n_transporting`` are computed once. ``tips_m`` and ``pulls_n`` have
    the shape (rows, springs, 2), in world axes, with NaN for a free spring. ``obstacles`` has x, y
    (m, world) and heading (rad) of each obstacle where it really was, steered or on its path:
    (rows, obstacles, 3); ``contact_forces_n`` the force of each on the load: (rows, obstacles, 2).
    """

    __slots__ = ("_data", "_columns")

    def __init__(self, data: _native.TraceData | Kept) -> None:
        self._data: Any = data
        self._columns: dict[str, FloatArray] = {}

    def __getitem__(self, name: TraceColumn) -> FloatArray:  # type: ignore[override]
        if not isinstance(name, str):
            raise TypeError(f"column: must be text, found {type(name).__name__}")
        if name not in self._columns:
            self._columns[name] = np.asarray(self._data.column(name))
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._data.names())

    def __len__(self) -> int:
        return len(self._data.names())

    @property
    def n_rows(self) -> int:
        """Number of rows (1)."""
        return len(self._data)

    def __reduce__(self) -> tuple[Any, ...]:
        return Trace, (kept_trace(self._data),)

    def _flat(self) -> dict[str, np.ndarray[Any, Any]]:
        """Columns of one dimension; those of springs are ``pull_x_0_n`` and so on."""
        found: Mapping[str, FloatArray] = self
        columns = {name: found[name] for name in found if found[name].ndim == 1}
        for name, stem, unit in [("tips_m", "tip", "m"), ("pulls_n", "pull", "n"), ("obstacles", "obstacle", "m"), ("contact_forces_n", "contact_force", "n")]:
            values = found[name]
            if values.ndim == 3:
                for spring in range(values.shape[1]):
                    columns[f"{stem}_x_{spring}_{unit}"] = values[:, spring, 0]
                    columns[f"{stem}_y_{spring}_{unit}"] = values[:, spring, 1]
        for obstacle in range(self["obstacles"].shape[1]):
            columns[f"obstacle_heading_{obstacle}_rad"] = self["obstacles"][:, obstacle, 2]
        return columns

    def __repr__(self) -> str:
        return f"<Trace: {self.n_rows} rows, {len(self)} columns>"


class Results(Mapping[str, Any]):
    """What the program computed: a mapping of what it prints with ``--json``."""

    _command: str
    _data: Any

    def __init__(self, data: Any) -> None:
        self._data = data
        self._results: dict[str, Any] = json.loads(data.json())

    def _kept(self) -> Kept:
        """The native part as plain data."""
        return kept(self._data, ("json",), ("page", self._command))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self._kept(),)

    @property
    def answer(self) -> str:
        """What was found, in one or two sentences."""
        answer: str = self._results["answer"]
        return answer

    def report(self, path: str | os.PathLike[str] | None = None) -> str:
        """The HTML page with its replay, which is also written to ``path`` unless that is ``None``."""
        page: str = self._data.page(self._command)
        if path is not None:
            with open(path, "w", encoding="utf-8") as file:
                file.write(page)
        return page

    def __getitem__(self, name: str) -> Any:
        return self._results[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._results)

    def __len__(self) -> int:
        return len(self._results)

    def _ipython_key_completions_(self) -> list[str]:
        return list(self._results)


class Run(Results):
    """A finished run. As a mapping it has what ``cohaul run --json`` prints, a :class:`RunResults`."""

    _command = "cohaul.run"
    _data: Any

    def __init__(self, data: _native.RunData | Kept, backend: BackendName) -> None:
        super().__init__(data)
        self.backend: BackendName = backend
        """Name of the backend."""
        self.trace: Trace = Trace(data.trace())
        """Columns over time; empty if no trace was kept."""

    def __reduce__(self) -> tuple[Any, ...]:
        if isinstance(self._data, Kept):
            return Run, (self._data, self.backend)
        pictures = [("overview",)] if self.trace.n_rows else []
        found = kept(self._data, ("json",), ("page", self._command), *pictures)
        found.answers["trace",] = kept_trace(self.trace._data)
        return Run, (found, self.backend)

    @overload  # type: ignore[override]
    def __getitem__(self, name: Literal["answer", "scenario"]) -> str: ...
    @overload
    def __getitem__(self, name: Literal["format"]) -> Format: ...
    @overload
    def __getitem__(self, name: Literal["backend"]) -> BackendName: ...
    @overload
    def __getitem__(self, name: Literal["step_s", "time_to_nest_s"]) -> float | None: ...
    @overload
    def __getitem__(self, name: Literal["mean_speed_m_per_s", "wall_s"]) -> float: ...
    @overload
    def __getitem__(self, name: Literal["seed"]) -> int: ...
    @overload
    def __getitem__(self, name: Literal["arrived"]) -> bool: ...
    @overload
    def __getitem__(self, name: Literal["integrator"]) -> Integrator: ...
    @overload
    def __getitem__(self, name: Literal["rapier"]) -> RapierUsed: ...
    @overload
    def __getitem__(self, name: Literal["account"]) -> Account: ...
    @overload
    def __getitem__(self, name: Literal["final"]) -> Final: ...
    @overload
    def __getitem__(self, name: Literal["pull_force_n"]) -> PullForce: ...
    @overload
    def __getitem__(self, name: Literal["energy"]) -> Energy: ...
    @overload
    def __getitem__(self, name: Literal["transitions"]) -> TransitionCounts: ...
    @overload
    def __getitem__(self, name: Literal["contacts"]) -> ContactCounts: ...
    @overload
    def __getitem__(self, name: Literal["accuracy"]) -> Accuracy: ...
    @overload
    def __getitem__(self, name: Literal["steps"]) -> RunSteps: ...
    @overload
    def __getitem__(self, name: Literal["inertia_estimate"]) -> InertiaEstimate: ...
    def __getitem__(self, name: str) -> Any:
        return self._results[name]

    @property
    def results(self) -> RunResults:
        """All results, as ``cohaul run --json`` prints them."""
        return cast(RunResults, self._results)

    @property
    def final(self) -> Final:
        """The load at the end."""
        return self["final"]

    @property
    def energy(self) -> Energy:
        """Energy ledger at the end (J)."""
        return self["energy"]

    @property
    def events(self) -> list[Event]:
        """Grasps and releases, in the order of time."""
        return [Event(*event) for event in self.trace._data.events()]

    @property
    def transitions(self) -> list[Transition]:
        """Instants at which the motion of the load is not smooth."""
        found: list[Transition] = json.loads(self.trace._data.transitions())
        return found

    def to_pandas(self) -> Any:
        """The trace as a ``pandas.DataFrame``."""
        return self.trace.to_pandas()

    def to_polars(self) -> Any:
        """The trace as a ``polars.DataFrame``."""
        return self.trace.to_polars()

    def overview(self) -> str:
        """Path, pulls, energy, heading and speed over time, as SVG."""
        picture: str = self._data.overview()
        return picture

    def __repr__(self) -> str:
        return f"<Run of {self['scenario']!r} on {self.backend}: {self.answer}>"

    def _repr_html_(self) -> str:
        picture = self.overview() if self.trace.n_rows else ""
        return f"<p>{html.escape(self.answer)}</p>{picture}"


def run(
    scenario: Source,
    backend: BackendName = "quasi-static",
    *,
    step_s: float | None = None,
    tolerance_m: float | None = None,
    tolerance_rad: float | None = None,
    seed: int | None = None,
    controller: Controller | None = None,
    trace: bool = True,
    progress: Progress = None,
    integrator: Integrator | None = None,
    second_order: bool = False,
    rate_independent: bool = False,
    no_skip: NoSkip = None,
    rapier: RapierOptions | None = None,
) -> Run:
    """Runs a scenario to its end, without the interpreter's lock. Ctrl-C ends it.

    :param backend: ``'quasi-static'``, ``'inertial'`` or ``'rapier'``
    :param step_s: longest step (s); the default is that of ``cohaul run``
    :param tolerance_m: error control instead: largest error of the position (m)
    :param tolerance_rad: and of the heading (rad), by default over the load's radius
    :param seed: seed of all random streams, in place of the scenario's
    :param controller: a function that moves the tips in place of the scenario's drive; see
        :class:`View` for what it is given
    :param trace: whether rows and events are kept
    :param progress: ``True`` for a bar, or a function of the fraction done (1)
    :param rate_independent: whether the quasi-static model leaves out the dashpots of the springs
    :param rapier: options of rapier: ``friction``, ``springs``, ``precision``, ``settings``

    >>> found = run("scenarios/analytic/qs-ref-1.json", step_s=1e-3)
    >>> len(found.trace["x_m"]), round(float(found.trace["x_m"][-1]), 4)
    (1001, 0.0313)
    """
    given = as_scenario(scenario)
    scene = given._scene if seed is None else given._scene.with_seed(whole("seed", seed))
    if controller is not None and not callable(controller):
        raise TypeError(f"controller: must be a function, found {type(controller).__name__}")
    options = backend_options(backend, step_s, tolerance_m, tolerance_rad, integrator, second_order, rate_independent, no_skip, rapier)
    with progress_of(progress, backend) as show:
        return Run(_native.run(scene, as_json(options), bool(trace), controller, show), backend)


def library(name: str, method: str) -> Any:
    """An optional library, or an error that says how to install it."""
    import importlib

    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ImportError(f"{method}() needs {name}: install it with `pip install {name}`") from error
