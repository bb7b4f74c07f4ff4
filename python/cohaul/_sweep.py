"""Many runs on all threads, as one table."""

from __future__ import annotations

import csv
import io
from typing import Any, Iterator, Mapping, Sequence, Union

import numpy as np

from . import _native
from ._options import Progress, as_json, backend_options, number, plain, progress_of, whole
from ._run import Table
from ._scenario import Source, as_scenario
from .results import BackendName, Integrator, RapierOptions

Values = Union[str, Sequence[Union[float, str]], "np.ndarray[Any, Any]"]
"""Values of a parameter: a list of them, or a text such as ``log:1e-4:1e-2:7``."""
Vary = Mapping[str, Values]
"""Values of parameters by their paths."""


class Sweep(Table):
    """Columns of a sweep by name, a row for each run; the table of ``cohaul sweep``.

    Numbers are floats with NaN where a run has none, or integers where every run has one. Words
    are objects, with an empty text where there is none.
    """

    def __init__(self, data: _native.SweepData) -> None:
        self.csv: str = data.csv
        """The table as text, as ``cohaul sweep`` writes it."""
        self.n_rows: int = data.n_rows
        """Number of runs (1)."""
        rows = list(csv.reader(io.StringIO(data.csv)))[1:]
        cells = list(zip(*rows)) if rows else [()] * len(data.columns)
        self._columns = {name: _column(kind, cells[at]) for at, (name, kind) in enumerate(data.columns)}

    def __getitem__(self, name: str) -> np.ndarray[Any, Any]:
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def __repr__(self) -> str:
        return f"<Sweep: {self.n_rows} runs, {len(self)} columns>"


def _column(kind: str, cells: Sequence[str]) -> np.ndarray[Any, Any]:
    if kind == "word":
        return np.array(cells, dtype=object)
    if kind == "truth":
        values: list[Any] = [None if cell == "" else cell == "true" for cell in cells]
        return np.array(values, dtype=bool if None not in values else object)
    if kind == "whole" and "" not in cells:
        whole_numbers = [int(cell) for cell in cells]
        return np.array(whole_numbers, dtype=np.int64 if max(whole_numbers, default=0) < 2**63 else np.uint64)
    return np.array([float(cell) if cell else np.nan for cell in cells])


def sweep(
    scenario: Source,
    vary: Vary | None = None,
    *,
    seeds: int = 1,
    seed: int | None = None,
    backend: BackendName | Sequence[BackendName] = "quasi-static",
    step_s: float | Sequence[float] | None = None,
    tolerance_m: float | None = None,
    sample: tuple[str, int] | tuple[str, int, int] | None = None,
    integrator: Integrator | None = None,
    rapier: RapierOptions | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> Sweep:
    """Runs a scenario over parameters, backends and seeds, on all threads. Ctrl-C ends it.

    :param vary: values of each parameter by its path, as ``{"load.mass_kg": [0.001, 0.002]}``,
        ``"log:1e-4:1e-2:7"`` or, with ``sample``, ``"1e-4..1e-2"``. ``speed``, ``size``
        and ``inertia`` are factors on the whole scene
    :param seeds: number of seeds at each point (1)
    :param seed: first seed, in place of the scenario's
    :param backend: one backend, or several
    :param step_s: longest step (s), or several
    :param sample: method (``'latin-hypercube'`` or ``'sobol'``), number of points, and a seed
    :param threads: number of threads; the default is one for each processor

    >>> table = sweep("scenarios/analytic/slide.json", {"load.mass_kg": [0.001, 0.002]}, backend="inertial")
    >>> table["load.mass_kg"].tolist(), table["status"].tolist()
    ([0.001, 0.002], ['finished', 'finished'])
    """
    given = as_scenario(scenario)
    steps: list[Any] = list(step_s) if isinstance(step_s, (list, tuple, np.ndarray)) else [step_s]
    backends: list[BackendName] = [backend] if isinstance(backend, str) else list(backend)
    if not backends or not steps:
        raise ValueError("backend, step_s: must name at least one backend and step, found none")
    axes = plain(dict(vary or {}), "vary")
    asked = {
        "vary": [[path, values] for path, values in axes.items()],
        "sample": None if sample is None else [*sample, None][:3],
        "variants": [_variant(name, step, tolerance_m, integrator, rapier) for name in backends for step in steps],
        "first_seed": whole("seed", seed),
        "n_seeds": whole("seeds", seeds, 1),
    }
    n_threads = whole("threads", threads, 1, 1024)
    with progress_of(progress, "sweep") as show:
        return Sweep(_native.sweep(given._scene, as_json(plain(asked, "sweep")), n_threads, show))


def _variant(
    backend: BackendName,
    step_s: float | None,
    tolerance_m: float | None,
    integrator: Integrator | None,
    rapier: RapierOptions | None,
) -> dict[str, Any]:
    """Options of one backend; those that it does not read are left out, as in a run of its own."""
    return backend_options(
        backend,
        step_s=number("step_s", step_s),
        tolerance_m=tolerance_m,
        integrator=integrator if backend == "inertial" else None,
        rapier=rapier if backend == "rapier" else None,
    )
