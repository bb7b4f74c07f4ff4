"""Stored runs, and how those of another build, engine or scenario differ from them."""

from __future__ import annotations

import html
import os
from pathlib import Path
from typing import Any, Literal, Sequence, cast, overload

from . import _native
from ._kept import Kept, kept
from ._options import Progress, as_json, backend_options, progress_of, text, texts, whole
from ._run import Results
from ._scenario import Source, as_scenario
from .results import BackendName, CheckedBaseline, CheckResults, Format, Integrator, RapierOptions


class Check(Results):
    """A finished check. As a mapping it has what ``cohaul check --json`` prints, a
    :class:`CheckResults`. It is true if every baseline agrees or was replaced."""

    _command = "cohaul.check"
    _data: Any

    def _kept(self) -> Kept:
        return kept(self._data, ("json",), ("text",), command=self._command)

    @overload  # type: ignore[override]
    def __getitem__(self, name: Literal["format"]) -> Format: ...
    @overload
    def __getitem__(self, name: Literal["n_agree", "n_differ", "n_not_computed"]) -> int: ...
    @overload
    def __getitem__(self, name: Literal["exact"]) -> bool: ...
    @overload
    def __getitem__(self, name: Literal["build"]) -> dict[str, str]: ...
    @overload
    def __getitem__(self, name: Literal["accepted"]) -> list[str]: ...
    @overload
    def __getitem__(self, name: Literal["wall_s"]) -> float: ...
    @overload
    def __getitem__(self, name: Literal["baselines"]) -> list[CheckedBaseline]: ...
    def __getitem__(self, name: str) -> Any:
        return self._results[name]

    @property
    def results(self) -> CheckResults:
        """All results, as ``cohaul check --json`` prints them."""
        return cast(CheckResults, self._results)

    @property
    def answer(self) -> str:
        """How many baselines agree, in one sentence."""
        return self.text.splitlines()[0].removeprefix("check: ").capitalize() + "."

    @property
    def text(self) -> str:
        """The report as text, as the program prints it."""
        text: str = self._data.text()
        return text

    @property
    def baselines(self) -> list[CheckedBaseline]:
        """What was found of each baseline."""
        return self["baselines"]

    def report(self, path: str | os.PathLike[str] | None = None) -> str:
        """The report as text, which is also written to ``path`` unless that is ``None``."""
        if path is not None:
            Path(path).write_text(self.text, encoding="utf-8")
        return self.text

    def save(self, folder: str | os.PathLike[str]) -> None:
        """Writes the files of ``cohaul check --out`` to a folder."""
        self._data.write(os.fspath(folder), self._command)

    def __bool__(self) -> bool:
        accepted = self["accepted"]
        return all(found["verdict"] == "agrees" or found["name"] in accepted for found in self.baselines)

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return f"<Check: {self.answer}>"

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(self.text)}</pre>"


def check(
    baselines: str | os.PathLike[str],
    names: str | Sequence[str] | None = None,
    *,
    scenario: Source | None = None,
    exact: bool = False,
    accept: bool = False,
    threads: int | None = None,
    progress: Progress = None,
) -> Check:
    """Runs stored baselines again, and says what differs. Ctrl-C ends it.

    :param baselines: folder of baselines, as :func:`store_baseline` or ``cohaul check store`` makes it
    :param names: baselines to check, by the names of their files; the default is all in the folder
    :param scenario: a scenario to run in place of the stored one
    :param exact: set all tolerances to zero, so that every digit counts
    :param accept: store the new result in place of each baseline that differs, with its tolerances

    >>> bool(check("tests/baselines", "release-jump-quasi-static"))
    True
    """
    if scenario is not None and names is None:
        raise ValueError("scenario: must come with names, found it alone")
    scene = None if scenario is None else as_scenario(scenario)._scene
    chosen = None if names is None else [name.removesuffix(".json") for name in texts("names", names)]
    n_threads = whole("threads", threads, 1, 1024)
    with progress_of(progress, "check") as show:
        return Check(_native.check(os.fspath(baselines), chosen, scene, bool(exact), bool(accept), n_threads, show))


def store_baseline(
    scenario: Source,
    baselines: str | os.PathLike[str],
    backend: BackendName = "quasi-static",
    *,
    name: str | None = None,
    step_s: float | None = None,
    integrator: Integrator | None = None,
    rapier: RapierOptions | None = None,
    seed: int | None = None,
    rows: int = 200,
    replace: bool = False,
    progress: Progress = None,
) -> Path:
    """Runs a scenario and stores the result as a baseline in a folder. Returns its file.

    :param name: name of the file; the default has those of the scenario, the backend and the options
    :param rows: largest number of stored rows of the path
    :param replace: whether a baseline of this name is replaced, with new tolerances

    Raises ``FileExistsError`` if there is one, and ``ArithmeticError`` if the run failed.
    """
    given = as_scenario(scenario)
    stem = Path(given._file).stem if given._file.endswith(".json") else "-".join(given.name.split()).replace("/", "-")
    scene = given._scene if seed is None else given._scene.with_seed(whole("seed", seed))
    options = backend_options(backend, step_s, None, None, integrator, False, False, None, rapier)
    with progress_of(progress, "store") as show:
        stem = stem if seed is None else f"{stem}-seed-{seed}"
        n_rows = whole("rows", rows, 2, 10**6)
        return Path(_native.store_baseline(scene, os.fspath(baselines), text("name", name), stem, as_json(options), n_rows, bool(replace), show))
