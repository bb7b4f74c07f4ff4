"""Maps of comparisons over parameters of a scene, and thresholds of one."""

from __future__ import annotations

import csv
import io
import os
from typing import Any, Iterator, Literal, Sequence, cast, overload

import numpy as np

from . import _native
from ._compare import _settings
from ._kept import Kept, kept
from ._options import NoSkip, Progress, as_json, number, plain, progress_of, text, whole
from ._run import Results, Table
from ._scenario import Source, as_scenario
from ._sweep import Vary
from .results import (
    Axis, BackendName, Band, ComparisonSettings, FloatArray, Format, MapCell, MapQuestion, MapResults, Quantity, QuantityBands, RapierOptions,
    ThresholdParameter, ThresholdPoint, ThresholdResults,
)  # fmt: skip

QUANTITIES: tuple[Quantity, ...] = ("path", "heading", "pulls", "contacts", "speed", "energy")
"""Quantities in the order of a map's and of a search's numbers."""


class Points(Table):
    """Columns of the points of a map or of a search by name, as the program writes them."""

    def __init__(self, text: str) -> None:
        head, *rows = csv.reader(io.StringIO(text))
        self._columns = {name: _column([row[at] for row in rows]) for at, name in enumerate(head)}

    def __getitem__(self, name: str) -> np.ndarray[Any, Any]:
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)


def _column(cells: Sequence[str]) -> np.ndarray[Any, Any]:
    try:
        return np.array([float(cell) if cell else np.nan for cell in cells])
    except ValueError:
        return np.array(cells, dtype=object)


class _Study(Results):
    """What a map and a search share: a table, a figure and files."""

    _data: Any

    def _kept(self) -> Kept:
        return kept(self._data, ("json",), ("text",), ("csv",), ("figure",), ("page", self._command), command=self._command)

    @property
    def text(self) -> str:
        """The answer and its table as text, as the program prints them."""
        text: str = self._data.text()
        return text

    @property
    def points(self) -> Points:
        """All numbers of all points as columns by name."""
        return Points(self._data.csv())

    def to_pandas(self) -> Any:
        """The points as a ``pandas.DataFrame``."""
        return self.points.to_pandas()

    def to_polars(self) -> Any:
        """The points as a ``polars.DataFrame``."""
        return self.points.to_polars()

    def figure(self) -> str:
        """Inertia effect over the tolerance of each quantity, as SVG."""
        picture: str = self._data.figure()
        return picture

    def save(self, folder: str | os.PathLike[str]) -> None:
        """Writes the files that the program writes with ``--out`` to a folder."""
        self._data.write(os.fspath(folder), self._command)

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {self.answer}>"

    def _repr_html_(self) -> str:
        return f"<p>{self.answer}</p>{self.figure()}"


class Map(_Study):
    """A finished map. As a mapping it has what ``cohaul compare --vary --json`` prints, a
    :class:`MapResults`."""

    _command = "cohaul.compare_map"

    @overload  # type: ignore[override]
    def __getitem__(self, name: Literal["answer", "scenario"]) -> str: ...
    @overload
    def __getitem__(self, name: Literal["format"]) -> Format: ...
    @overload
    def __getitem__(self, name: Literal["seed", "n_compared", "n_by_estimate", "n_failed"]) -> int: ...
    @overload
    def __getitem__(self, name: Literal["question"]) -> MapQuestion: ...
    @overload
    def __getitem__(self, name: Literal["axes"]) -> list[Axis]: ...
    @overload
    def __getitem__(self, name: Literal["cells"]) -> list[MapCell]: ...
    @overload
    def __getitem__(self, name: Literal["wall_s"]) -> float: ...
    def __getitem__(self, name: str) -> Any:
        return self._results[name]

    @property
    def results(self) -> MapResults:
        """All results, as ``cohaul compare --vary --json`` prints them."""
        return cast(MapResults, self._results)

    @property
    def axes(self) -> list[FloatArray]:
        """Values of each parameter."""
        n_axes, cells = len(self["axes"]), self["cells"]
        each = [list(dict.fromkeys(cell["values"][axis] for cell in cells)) for axis in range(n_axes)]
        return [np.array(values, dtype=float) for values in each]

    def shares(self, quantity: Quantity = "path") -> FloatArray:
        """Inertia effect over its tolerance at each point (1), with the shape of the grid.

        Up to 1 the quasi-static model is valid. Where the estimate decided, it is that of the
        estimate for the path, and NaN for other quantities.
        """
        if quantity not in QUANTITIES:
            raise ValueError(f"quantity: must be one of {', '.join(QUANTITIES)}, found {quantity!r}")
        found = [_share(cell, QUANTITIES.index(quantity)) for cell in self["cells"]]
        return np.array(found).reshape([len(values) for values in self.axes])


def _share(cell: MapCell, quantity: int) -> float:
    if cell["compared"] is not None:
        of = cell["compared"][quantity]
        return of["inertia_effect"] / of["tolerance"] if of["tolerance"] > 0.0 else np.nan
    estimate = cell["estimate"]
    return np.nan if estimate is None or quantity > 0 else estimate["inertia_effect_m"] / estimate["tolerance_m"]


class Threshold(_Study):
    """A finished search. As a mapping it has what ``cohaul compare --threshold --json`` prints, a
    :class:`ThresholdResults`."""

    _command = "cohaul.threshold"

    @overload  # type: ignore[override]
    def __getitem__(self, name: Literal["answer", "scenario"]) -> str: ...
    @overload
    def __getitem__(self, name: Literal["format"]) -> Format: ...
    @overload
    def __getitem__(self, name: Literal["seed", "n_failed"]) -> int: ...
    @overload
    def __getitem__(self, name: Literal["settings"]) -> ComparisonSettings: ...
    @overload
    def __getitem__(self, name: Literal["parameter"]) -> ThresholdParameter: ...
    @overload
    def __getitem__(self, name: Literal["quantities"]) -> list[QuantityBands]: ...
    @overload
    def __getitem__(self, name: Literal["points"]) -> list[ThresholdPoint]: ...
    @overload
    def __getitem__(self, name: Literal["wall_s"]) -> float: ...
    def __getitem__(self, name: str) -> Any:
        return self._results[name]

    @property
    def results(self) -> ThresholdResults:
        """All results, as ``cohaul compare --threshold --json`` prints them."""
        return cast(ThresholdResults, self._results)

    def bands(self, quantity: Quantity = "path") -> list[Band]:
        """Ranges of the parameter with one answer on a quantity, in the order of its values."""
        for found in self["quantities"]:
            if found["quantity"] == quantity:
                return found["bands"]
        names = [found["quantity"] for found in self["quantities"]]
        raise ValueError(f"quantity: must be one of {', '.join(names)}, found {quantity!r}")


def compare_map(
    scenario: Source,
    vary: Vary,
    *,
    everywhere: bool = False,
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
    threads: int | None = None,
    progress: Progress = None,
) -> Map:
    """Compares the backends on a scenario over one parameter or two. Ctrl-C ends it.

    At each point a quasi-static run with its inertia estimate comes first. All three backends are
    compared where that is not clearly on one side of the tolerance, and at the corners of the map.

    :param vary: values of each parameter by its path, as :func:`sweep` has them
    :param everywhere: compare all three backends at every point, whatever the estimate says

    Other options are those of :func:`compare`.

    >>> found = compare_map("scenarios/analytic/release-jump.json", {"load.mass_kg": [1e-4, 1e-2]})
    >>> found.shares().shape, found.axes[0].tolist()
    ((2,), [0.0001, 0.01])
    """
    axes = plain(dict(vary), "vary")
    if not 1 <= len(axes) <= 2:
        raise ValueError(f"vary: must have one parameter or two, found {len(axes)}")
    asked = _asked(
        _settings(
            step_s, halvings, tolerance_m, recorded_from, rate_independent, tolerance_share, tolerance_heading_rad,
            tolerance_pull_share, tolerance_speed_share, tolerance_energy_share, no_skip, rapier,
        )
    )  # fmt: skip
    scene, n_threads = _scene(scenario, seed), whole("threads", threads, 1, 1024)
    with progress_of(progress, "compare_map") as show:
        pairs = as_json([[path, values] for path, values in axes.items()])
        return Map(_native.compare_map(scene, pairs, asked, bool(everywhere), n_threads, show))


def threshold(
    scenario: Source,
    parameter: str,
    limits: tuple[float, float] | tuple[float, float, int] | None = None,
    *,
    seed: int | None = None,
    tolerance_m: float | None = None,
    tolerance_share: float | None = None,
    tolerance_heading_rad: float | None = None,
    tolerance_pull_share: float | None = None,
    tolerance_speed_share: float | None = None,
    tolerance_energy_share: float | None = None,
    recorded_from: BackendName | None = None,
    rate_independent: bool = False,
    no_skip: NoSkip = None,
    threads: int | None = None,
    progress: Progress = None,
) -> Threshold:
    """Up to which value of a parameter the quasi-static model is valid. Ctrl-C ends the search.

    The two exact models are compared on a logarithmic grid, and between its points until each
    boundary is known to a percent.

    :param parameter: ``'speed'``, ``'size'`` or ``'inertia'``, factors on the whole scene, or a key
        of the scenario such as ``'load.mass_kg'``
    :param limits: ends of the search, and a number of points of its grid; the default is from 1/32
        to 32 times the present value, with four points for each factor of 2

    Other options are those of :func:`compare`.

    >>> found = threshold("scenarios/contact/pusher.json", "inertia", (0.5, 2.0, 3))
    >>> [band["class"] for band in found.bands("path")]
    ['valid']
    """
    word = text("parameter", parameter)
    if not word or "=" in word:
        raise ValueError(f"parameter: must be a factor or a key of the scenario, found {parameter!r}")
    asked = _asked(
        _settings(
            None, None, tolerance_m, recorded_from, rate_independent, tolerance_share, tolerance_heading_rad,
            tolerance_pull_share, tolerance_speed_share, tolerance_energy_share, no_skip, None,
        )
    )  # fmt: skip
    scene, n_threads = _scene(scenario, seed), whole("threads", threads, 1, 1024)
    with progress_of(progress, "threshold") as show:
        return Threshold(_native.threshold(scene, word + _limits(limits), asked, n_threads, show))


def _asked(settings: dict[str, Any]) -> str:
    return as_json({name: value for name, value in settings.items() if value is not None})


def _scene(scenario: Source, seed: int | None) -> _native.Scene:
    given = as_scenario(scenario)
    return given._scene if seed is None else given._scene.with_seed(whole("seed", seed))


def _limits(limits: Sequence[float] | None) -> str:
    """The range as the program has it."""
    if limits is None:
        return ""
    if not isinstance(limits, (tuple, list)) or not 2 <= len(limits) <= 3:
        raise ValueError(f"limits: must be two numbers and perhaps a number of points, found {limits!r}")
    ends = [number(f"limits[{at}]", limit) for at, limit in enumerate(limits[:2])]
    n = [str(whole("limits[2]", n, 2, 10**6)) for n in limits[2:]]
    return "=" + ":".join([*map(repr, ends), *n])
