"""A comparison of the three backends."""

from __future__ import annotations

import html
import math
import os
from contextlib import suppress
from pathlib import Path
from typing import Any, Callable, Iterator, Literal, Mapping, Sequence, SupportsFloat, Union, cast, overload

from . import _native
from ._kept import Kept, kept, kept_trace
from ._options import NoSkip, Progress, as_json, number, progress_of, rapier_options, text, texts, whole
from ._run import Controller, Results, Trace
from ._scenario import Source, as_scenario
from .results import (
    BackendName, Beside, ClosedLoop, ComparisonResults, ComparisonSettings, Format, MeasureVerdict, Pathwise, PathTier, QuantityVerdict,
    RapierOptions, Refusal, TierName, Tiers, Verdicts, VerdictWord,
)  # fmt: skip

BACKENDS: tuple[BackendName, ...] = ("quasi-static", "inertial", "rapier")
"""Names of the backends of the package, the simplest first."""
PATH_TIERS: tuple[PathTier, ...] = ("prescribed", "replayed", "controlled")

EngineLike = Union[str, Callable[[], Any]]
"""A class of an engine, a command that starts one, or ``rapier``."""


class Replay:
    """The page of a comparison with its replay, which a notebook shows in a frame."""

    def __init__(self, page: str) -> None:
        self.page = page
        """The page as HTML."""

    def _repr_html_(self) -> str:
        style = "width: 100%; height: 46em; border: 1px solid #ccc"
        return f'<iframe srcdoc="{html.escape(self.page)}" style="{style}"></iframe>'


class Measure:
    """A measure of your own, which a comparison of paths judges beside its own quantities.

    :param name: such as ``distance to the goal``
    :param unit: such as ``m``; ``1`` for a number without a unit
    :param of: a function of the :class:`Trace` of a run that returns a number
    :param tolerance: largest difference that counts as agreement, in the unit; by default 5 % of the
        larger number without inertia or with it
    """

    def __init__(self, name: str, unit: str, of: Callable[[Trace], SupportsFloat], tolerance: float | None = None) -> None:
        if not callable(of):
            raise TypeError(f"measure.of: must be a function, found {type(of).__name__}")
        self.name: str = _word("measure.name", name)
        self.unit: str = _word("measure.unit", unit)
        self.of: Callable[[Trace], SupportsFloat] = of
        self.tolerance: float | None = number("measure.tolerance", tolerance)

    def _number(self, data: _native.TraceData) -> float:
        found = self.of(Trace(data))
        try:
            value = float(found)
        except (TypeError, ValueError) as error:
            raise TypeError(f"measure: must return a number, found {type(found).__name__}") from error
        if not math.isfinite(value):
            raise ValueError(f"measure: must return a finite number, found {value}")
        return value

    def _asked(self) -> dict[str, Any]:
        return {"name": self.name, "unit": self.unit, "of": self._number, "tolerance": self.tolerance}


def _word(path: str, value: Any) -> str:
    found = text(path, value)
    if not found or len(found) > 60 or not found.isprintable():
        raise ValueError(f"{path}: must have from 1 to 60 printable characters, found {found!r}")
    return found


class Comparison(Results):
    """A finished comparison. As a mapping it has what ``cohaul compare --json`` prints, a
    :class:`ComparisonResults`."""

    _command = "cohaul.compare"
    _data: Any

    def _kept(self) -> Kept:
        if isinstance(self._data, Kept):
            return self._data
        found = kept(self._data, ("json",), ("page", self._command), command=self._command)
        names = [path["engine"]["name"] for _, path in self._paths()]
        for tier in self.tiers:
            with suppress(ValueError):  # A tier of distributions has no paths.
                found.answers["overview", tier] = self._data.overview(tier)
            for backend in dict.fromkeys([*BACKENDS, *names]):
                with suppress(ValueError):  # Not each has all backends.
                    found.answers["trace", tier, backend] = kept_trace(self._data.trace(tier, backend))
        return found

    @overload  # type: ignore[override]
    def __getitem__(self, name: Literal["answer", "scenario"]) -> str: ...
    @overload
    def __getitem__(self, name: Literal["format"]) -> Format: ...
    @overload
    def __getitem__(self, name: Literal["seed"]) -> int: ...
    @overload
    def __getitem__(self, name: Literal["wall_s"]) -> float: ...
    @overload
    def __getitem__(self, name: Literal["settings"]) -> ComparisonSettings: ...
    @overload
    def __getitem__(self, name: Literal["tiers"]) -> Tiers: ...
    @overload
    def __getitem__(self, name: Literal["other_engines"]) -> list[Pathwise]: ...
    @overload
    def __getitem__(self, name: Literal["refused_by"]) -> list[Refusal]: ...
    @overload
    def __getitem__(self, name: Literal["beside"]) -> Beside: ...
    def __getitem__(self, name: str) -> Any:
        return self._results[name]

    @property
    def results(self) -> ComparisonResults:
        """All results, as ``cohaul compare --json`` prints them."""
        return cast(ComparisonResults, self._results)

    @property
    def tiers(self) -> Tiers:
        """Results by tier: ``prescribed``, ``replayed``, ``controlled`` and ``closed_loop``."""
        return self["tiers"]

    @property
    def paths(self) -> Pathwise:
        """The first tier that compares paths, with the first engine.

        Raises ``ValueError`` if there is none, as after a comparison of the closed loop alone.
        """
        for tier in PATH_TIERS:
            if tier in self.tiers:
                return self.tiers[tier]
        raise ValueError(f"tiers: must have one that compares paths, found {', '.join(self.tiers)}")

    @property
    def closed_loop(self) -> ClosedLoop | None:
        """The comparison of distributions over seeds, if there is one."""
        return self.tiers.get("closed_loop")

    @property
    def other_engines(self) -> list[Pathwise]:
        """Paths of the engines after the first, as those in ``tiers``."""
        return self.results.get("other_engines", [])

    @property
    def refused_by(self) -> list[Refusal]:
        """Engines that do not take the scene, where others do: ``engine`` and ``why``."""
        return self.results.get("refused_by", [])

    @property
    def verdicts(self) -> Verdicts:
        """Verdict on each quantity, of the first tier that compares paths: path, heading, pulls,
        contacts, speed, energy, and the measure of your own if there is one.

        Each has two answers. ``inertia`` is ``negligible``, ``not negligible``, ``open`` or
        ``nothing moved``, and ``engine`` is ``within``, ``not within`` or ``open``. ``verdict``
        follows from them, and ``causes`` are those of what exceeds the tolerance. The numbers
        ``inertia_effect``, ``engine_error``, ``reference_error`` and ``tolerance`` are in the
        ``unit``, and ``parts`` are what they consist of. Verdicts on distributions are in
        ``closed_loop``.
        """
        return self.paths["verdicts"]

    @property
    def verdict(self) -> VerdictWord:
        """Verdict of the first tier; that on the path, if it compares paths."""
        loop = self.closed_loop
        return self.paths["verdict"] if loop is None or len(self.tiers) > 1 else loop["verdict"]

    def _paths(self) -> Iterator[tuple[str, Pathwise]]:
        """All comparisons of paths, with their tiers: those of the first engine before the others."""
        yield from ((tier, self.tiers[tier]) for tier in PATH_TIERS if tier in self.tiers)
        yield from ((found["tier"], found) for found in self.other_engines)

    def trace(self, backend: str, tier: TierName | None = None) -> Trace:
        """Trace of a backend in a tier, by default the first one."""
        return Trace(self._data.trace(self._tier(tier), text("backend", backend) or ""))

    def overview(self, tier: TierName | None = None) -> str:
        """Paths, differences and pulls of the three backends over time, as SVG."""
        picture: str = self._data.overview(self._tier(tier))
        return picture

    def replay(self) -> Replay:
        """The page with its replay, for a notebook."""
        return Replay(self.report())

    def save(self, folder: str | os.PathLike[str]) -> None:
        """Writes the files of ``cohaul compare --out`` to a folder."""
        self._data.write(os.fspath(folder), self._command)

    def _tier(self, tier: TierName | None) -> str:
        return text("tier", tier) or next(iter(self.tiers))

    def __repr__(self) -> str:
        return f"<Comparison of {self['scenario']!r}: {self.answer}>"

    def _repr_html_(self) -> str:
        found = [(f"{tier}: {path['engine']['name']}", path["verdicts"].items()) for tier, path in self._paths()]
        if loop := self.closed_loop:
            found.append((f"closed loop: {loop['engine_name']['name']}, {loop['n_seeds']} seeds", loop["verdicts"].items()))
        head = "".join(f"<th>{name.replace('_', ' ')}</th>" for name in ["quantity", *DIFFERENCES, "verdict"])
        tables = []
        for title, verdicts in found:
            rows = "".join(_row(quantity, verdict) for quantity, verdict in verdicts)
            tables.append(f"<table><caption>{html.escape(title)}</caption><tr>{head}</tr>{rows}</table>")
        return f"<p>{html.escape(self.answer)}</p>{''.join(tables)}"


DIFFERENCES = ("inertia_effect", "engine_error", "reference_error", "tolerance")


def _engines(engine: EngineLike | Sequence[EngineLike] | None) -> list[EngineLike]:
    if engine is None:
        return []
    engines: list[EngineLike] = [engine] if isinstance(engine, str) or callable(engine) else []
    if not engines:
        if not isinstance(engine, Sequence):
            raise TypeError(f"engine: must be a class, a command or a list of them, found {type(engine).__name__}")
        engines = list(engine)
    for each in engines:
        if not (isinstance(each, str) or callable(each)):
            raise TypeError(f"engine: must be a class or a function that makes an engine, or a command, found {type(each).__name__}")
    return engines


def _row(quantity: str, verdict: Any) -> str:
    cells = [_quantity(verdict[name], verdict["unit"]) for name in DIFFERENCES]
    words = ", ".join(verdict.get("causes", [])) or verdict["verdict"]
    return "<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in [quantity, *cells, words]) + "</tr>"


def _quantity(value: float | None, unit: str) -> str:
    return "" if value is None else f"{value:.3g} {unit}".strip()


def compare(
    scenario: Source,
    *,
    tiers: TierName | Sequence[TierName] | None = None,
    seeds: int = 8,
    seed: int | None = None,
    step_s: float | None = None,
    halvings: int | None = None,
    tolerance_m: float | None = None,
    tolerance_share: float | None = None,
    tolerance_heading_rad: float | None = None,
    tolerance_pull_share: float | None = None,
    tolerance_speed_share: float | None = None,
    tolerance_energy_share: float | None = None,
    recorded_from: BackendName | None = None,
    rate_independent: bool = False,
    no_skip: NoSkip = None,
    rapier: RapierOptions | None = None,
    engine: EngineLike | Sequence[EngineLike] | None = None,
    beside: Any = None,
    threads: int | None = None,
    progress: Progress = None,
) -> Comparison:
    """Compares the two exact backends with an engine on a scenario. Ctrl-C ends it.

    :param tiers: ``'prescribed'`` for given paths, ``'replayed'`` and ``'closed-loop'`` for ants;
        the default is all that the scenario has
    :param seeds: number of paired seeds of the closed loop (1)
    :param seed: first seed, in place of the scenario's
    :param engine: class of an engine in the place of rapier, as :mod:`cohaul.engines` describes it,
        or the command of a program; ``'rapier'`` is rapier itself. Several are compared side by
        side, the first of them in ``tiers`` and the others in ``other_engines``. Engines have no
        closed loop
    :param step_s: longest step of the engine and of the closed loop (s)
    :param halvings: number of halvings of the engine's step, whose last three runs tell time step
        from model; 2 by default
    :param tolerance_m: tolerance of error control in the reference runs (m); the default is as
        small as the verdict needs
    :param tolerance_share: largest edge displacement that counts as agreement, over the path
        length (1)
    :param rate_independent: whether the quasi-static model leaves out the dashpots of the springs,
        which are then part of the inertia effect
    :param beside: a path that was recorded elsewhere, whose distances from those of the first tier
        are in ``results["beside"]``: a CSV file, a :class:`Trace` or a data frame with the columns
        ``time_s``, ``x_m``, ``y_m`` and ``heading_rad``
    :param threads: number of threads; the default is one for each processor

    >>> found = compare("scenarios/analytic/release-jump.json")
    >>> found.verdict
    'inertia and engine'
    >>> sorted(found.verdicts)
    ['contacts', 'energy', 'heading', 'path', 'pulls', 'speed']
    """
    settings = _settings(
        step_s, halvings, tolerance_m, recorded_from, rate_independent, tolerance_share, tolerance_heading_rad,
        tolerance_pull_share, tolerance_speed_share, tolerance_energy_share, no_skip, rapier,
    )  # fmt: skip
    engines = _engines(engine)
    if engines and "rapier" not in engines and rapier is not None:
        raise ValueError("rapier: must be left out without rapier among the engines, found both")
    return _compared(scenario, settings, tiers, seeds, seed, None, engines, threads, progress, beside=_recorded(beside))


def compare_controller(
    scenario: Source,
    make_controller: Callable[[int], Controller],
    *,
    tiers: TierName | Sequence[TierName] | None = None,
    measure: Measure | None = None,
    seeds: int = 8,
    seed: int | None = None,
    step_s: float | None = None,
    halvings: int | None = None,
    tolerance_m: float | None = None,
    tolerance_share: float | None = None,
    tolerance_heading_rad: float | None = None,
    tolerance_pull_share: float | None = None,
    tolerance_speed_share: float | None = None,
    tolerance_energy_share: float | None = None,
    recorded_from: BackendName | None = None,
    rate_independent: bool = False,
    no_skip: NoSkip = None,
    rapier: RapierOptions | None = None,
    engine: EngineLike | Sequence[EngineLike] | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> Comparison:
    """Compares the three backends under a controller of your own.

    ``make_controller(seed)`` returns a controller for one run; each run gets one of its own. A
    controller is called once in each control period with a :class:`View`, may attach and release
    springs and steer obstacles there, and returns the positions of all tips at the end of the
    period, or ``None`` to hold them. The scenario's drive is not used. Options are those of
    :func:`compare`; obstacles stay on their paths on an engine in the place of rapier.

    The tier ``controlled`` runs the controller on each backend, where it answers to what it sees
    there, and gives a verdict on path, heading, pulls, contact forces, speed, energy and your
    measure. The reference error contains what an error of the path makes of the commands. A run
    that ends early ends the comparison of all. ``replayed`` records one run of the controller and
    replays its motions on all backends. ``closed-loop`` compares distributions over seeds. The
    default is ``replayed`` and ``closed-loop``, and with a measure ``replayed`` and ``controlled``.

    :param measure: a measure of your own, for the tiers ``controlled`` and ``replayed``; it is no
        part of ``closed-loop``, which is refused with one

    >>> def tow(seed):
    ...     def control(view):
    ...         if view.time_s == 0.0:
    ...             view.attach(0, (0.0, 0.0))
    ...         return [(0.005 * (view.time_s + view.control_period_s), 0.0)]
    ...     return control
    >>> scenario = "scenarios/analytic/centre-pull.json"
    >>> compare_controller(scenario, tow, tiers="replayed").verdicts["path"]["verdict"]
    'agree'
    >>> reach = Measure("final x", "m", lambda trace: trace["x_m"][-1])
    >>> found = compare_controller(scenario, tow, tiers="controlled", measure=reach)
    >>> found.verdicts["measure"]["verdict"], found.verdicts["measure"]["decided_by"]
    ('agree', 'final x')
    """
    if not callable(make_controller):
        raise TypeError(f"make_controller: must be a function, found {type(make_controller).__name__}")
    if measure is not None and not isinstance(measure, Measure):
        raise TypeError(f"measure: must be a Measure, found {type(measure).__name__}")
    if measure is not None and tiers is None:
        tiers = ["replayed", "controlled"]
    if measure is not None and any(tier in ("closed-loop", "closed_loop") for tier in texts("tiers", tiers)):
        raise ValueError("measure: must come with the tiers replayed and controlled, found closed-loop")
    settings = _settings(
        step_s, halvings, tolerance_m, recorded_from, rate_independent, tolerance_share, tolerance_heading_rad,
        tolerance_pull_share, tolerance_speed_share, tolerance_energy_share, no_skip, rapier,
    )  # fmt: skip
    engines = _engines(engine)
    if engines and "rapier" not in engines and rapier is not None:
        raise ValueError("rapier: must be left out without rapier among the engines, found both")
    return _compared(scenario, settings, tiers, seeds, seed, make_controller, engines, threads, progress, measure)


def _recorded(path: Any) -> tuple[str, str] | None:
    """Name and text of a table with a path."""
    if path is None:
        return None
    if isinstance(path, (str, os.PathLike)):
        return os.fspath(path), Path(path).read_text(encoding="utf-8")
    if isinstance(path, Trace):
        columns = [path[name].tolist() for name in ("time_s", "x_m", "y_m", "heading_rad")]
        rows = [",".join(map(repr, row)) for row in zip(*columns)]
        return "trace", "\n".join(["time_s,x_m,y_m,heading_rad", *rows, ""])
    if hasattr(path, "to_csv"):
        return "data frame", str(path.to_csv(index=False))
    if hasattr(path, "write_csv"):
        return "data frame", str(path.write_csv())
    raise TypeError(f"beside: must be a CSV file, a trace or a data frame, found {type(path).__name__}")


def _settings(
    step_s: float | None,
    halvings: int | None,
    tolerance_m: float | None,
    recorded_from: BackendName | None,
    rate_independent: bool,
    tolerance_share: float | None,
    tolerance_heading_rad: float | None,
    tolerance_pull_share: float | None,
    tolerance_speed_share: float | None,
    tolerance_energy_share: float | None,
    no_skip: NoSkip,
    rapier: RapierOptions | None,
) -> dict[str, Any]:
    return {
        "step_s": number("step_s", step_s),
        "halvings": whole("halvings", halvings, 2, 10),
        "reference_tolerance_m": number("tolerance_m", tolerance_m),
        "recorded_from": text("recorded_from", recorded_from),
        "rate_independent": bool(rate_independent),
        "tolerance_share": number("tolerance_share", tolerance_share),
        "tolerance_heading_rad": number("tolerance_heading_rad", tolerance_heading_rad),
        "tolerance_pull_share": number("tolerance_pull_share", tolerance_pull_share),
        "tolerance_speed_share": number("tolerance_speed_share", tolerance_speed_share),
        "tolerance_energy_share": number("tolerance_energy_share", tolerance_energy_share),
        "no_skip": texts("no_skip", no_skip),
        "rapier": rapier_options(rapier),
    }


def _compared(
    scenario: Source,
    settings: dict[str, Any],
    tiers: TierName | Sequence[TierName] | None,
    seeds: int,
    seed: int | None,
    controller: Callable[[int], Controller] | None,
    engines: list[EngineLike],
    threads: int | None,
    progress: Progress,
    measure: Measure | None = None,
    beside: tuple[str, str] | None = None,
) -> Comparison:
    given = as_scenario(scenario)
    scene = given._scene if seed is None else given._scene.with_seed(whole("seed", seed))
    asked = as_json({name: value for name, value in settings.items() if value is not None})
    n_seeds, n_threads = whole("seeds", seeds, 1, 10**6), whole("threads", threads, 1, 1024)
    names = texts("tiers", tiers)
    asked_measure = None if measure is None else measure._asked()
    with progress_of(progress, "compare") as show:
        return Comparison(_native.compare(scene, asked, names, n_seeds, controller, asked_measure, engines, beside, n_threads, show))
