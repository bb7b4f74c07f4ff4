"""Measured runs beside simulated ones."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Literal, Mapping, Sequence, cast, overload

from . import _native
from ._kept import Kept, kept
from ._options import Progress, as_json, number, progress_of, texts, whole
from ._run import Results
from ._scenario import Source, as_scenario
from .results import Bias, Fit, Format, MeasuredQuestion, MeasuredResults, MeasuredRun, OverRuns, OwnLimit


class Measured(Results):
    """Measured runs that were compared. As a mapping it has what ``cohaul measured --json`` prints,
    a :class:`MeasuredResults`."""

    _command = "cohaul.measured"
    _data: Any

    def _kept(self) -> Kept:
        return kept(self._data, ("json",), ("text", False), ("page", self._command), command=self._command)

    @overload  # type: ignore[override]
    def __getitem__(self, name: Literal["answer", "scenario"]) -> str: ...
    @overload
    def __getitem__(self, name: Literal["format"]) -> Format: ...
    @overload
    def __getitem__(self, name: Literal["recording", "worst", "notes"]) -> list[str]: ...
    @overload
    def __getitem__(self, name: Literal["question"]) -> MeasuredQuestion: ...
    @overload
    def __getitem__(self, name: Literal["n_runs", "n_left_out", "n_doubtful"]) -> int: ...
    @overload
    def __getitem__(self, name: Literal["over_runs"]) -> OverRuns | None: ...
    @overload
    def __getitem__(self, name: Literal["own_limit"]) -> OwnLimit | None: ...
    @overload
    def __getitem__(self, name: Literal["bias"]) -> Bias | None: ...
    @overload
    def __getitem__(self, name: Literal["fit"]) -> Fit: ...
    @overload
    def __getitem__(self, name: Literal["wall_s"]) -> float: ...
    @overload
    def __getitem__(self, name: Literal["runs"]) -> list[MeasuredRun]: ...
    def __getitem__(self, name: str) -> Any:
        return self._results[name]

    @property
    def results(self) -> MeasuredResults:
        """All results, as ``cohaul measured --json`` prints them."""
        return cast(MeasuredResults, self._results)

    @property
    def text(self) -> str:
        """The report as text, as the program prints it."""
        text: str = self._data.text(False)
        return text

    @property
    def runs(self) -> list[MeasuredRun]:
        """What was found of each run, with ``left_out`` in place of ``found`` where there is nothing."""
        return self["runs"]

    def save(self, folder: str | os.PathLike[str]) -> None:
        """Writes the files of ``cohaul measured --out`` to a folder."""
        self._data.write(os.fspath(folder), self._command)

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return f"<Measured: {self.answer}>"


def measured(
    recording: Any,
    scenario: Source,
    *,
    columns: Mapping[str, str] | None = None,
    least_confidence: float = 0.0,
    start: Literal["touching", "recorded"] = "touching",
    smooth_m: float | None = None,
    largest_shift_m: float | None = None,
    longest_gap_s: float | None = None,
    uncertainty: tuple[float, float] | None = None,
    fit: str | Sequence[str] | None = None,
    fit_runs: int | None = None,
    engine: Literal["rapier"] | None = "rapier",
    tolerance_m: float | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> Measured:
    """Compares measured runs with simulated ones. Ctrl-C ends it.

    :param recording: a CSV file, a list of such files, a folder of them, or a data frame with
        ``to_csv``. Columns are ``time_s``, ``load_x_m``, ``load_y_m``, ``load_heading_rad``, and for
        each recorded obstacle ``NAME_x_m``, ``NAME_y_m`` and ``NAME_heading_rad``; ``run`` is
        optional, and fields may be empty
    :param scenario: load, ground and the recorded obstacles
    :param columns: columns that have one of these names in the table, by that name
    :param start: ``'touching'`` moves obstacles that overlap the load at the start out of it;
        ``'recorded'`` leaves such runs out
    :param smooth_m: largest deviation of a smooth path from a recorded place (m); the default
        follows from rounding and noise of the recording
    :param uncertainty: standard deviation of positions of the load on each axis (m) and of headings
        (rad)
    :param fit: numbers that are fitted to the first half of the runs, or to the first ``fit_runs``:
        ``'ground-friction'``, ``'side-friction'`` or keys of the expanded scenario. The report is on
        the other runs
    :param engine: ``'rapier'``, or ``None`` for the exact backends alone
    :param tolerance_m: largest error of the exact paths (m)
    :param threads: number of threads; the default is one for each processor

    >>> found = measured("data/measured/pushes.csv", "data/measured/block.json", engine=None)
    >>> found["n_runs"], found["n_left_out"]
    (12, 0)
    """
    if engine not in ("rapier", None):
        raise ValueError(f"engine: must be 'rapier' or None, found {engine!r}")
    if start not in ("touching", "recorded"):
        raise ValueError(f"start: must be 'touching' or 'recorded', found {start!r}")
    settings = {
        "columns": list((columns or {}).items()),
        "least_confidence": float(least_confidence),
        "start": start,
        "smooth_m": number("smooth_m", smooth_m),
        "largest_shift_m": number("largest_shift_m", largest_shift_m),
        "longest_gap_s": number("longest_gap_s", longest_gap_s),
        "uncertainty": None if uncertainty is None else [float(one) for one in uncertainty],
        "fit": texts("fit", fit) or [],
        "fit_runs": whole("fit_runs", fit_runs, 1, 10**6),
        "tolerance_m": number("tolerance_m", tolerance_m),
        "with_rapier": engine is not None,
    }
    asked = as_json({name: value for name, value in settings.items() if value is not None})
    scene, tables = as_scenario(scenario)._scene, _tables(recording)
    n_threads = whole("threads", threads, 1, 1024)
    with progress_of(progress, "measured") as show:
        return Measured(_native.measured(scene, tables, asked, n_threads, show))


def _tables(recording: Any) -> list[tuple[str, str, str]]:
    """Name, stem and text of each table."""
    if hasattr(recording, "to_csv"):
        return [("data frame", "recording", recording.to_csv(index=False))]
    if isinstance(recording, (str, os.PathLike)):
        path = Path(recording)
        files = sorted(path.glob("*.csv")) if path.is_dir() else [path]
    else:
        files = [Path(file) for file in recording]
    if not files:
        raise ValueError(f"recording: must have tables (.csv), found none in {recording}")
    return [(str(file), file.stem, file.read_text(encoding="utf-8")) for file in files]
